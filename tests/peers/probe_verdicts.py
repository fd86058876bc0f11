"""Counts the verdicts of `etendue probe` at random pixels of random worlds.

usage: probe_verdicts.py PROGRAM FOLDER [PIXELS]      FOLDER has the worlds of random_worlds.py

Probes PIXELS (by default 5) pixels of each world with the default effort.
"""

import json
import random
import subprocess
import sys
import time
from pathlib import Path

SIZE = (300, 190)


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    count = int((sys.argv + ["5"])[3])
    draw = random.Random(40)
    verdicts, seconds, empty = {}, [], 0
    for world in sorted(folder.glob("*.xml")):
        for x, y in [(draw.randrange(SIZE[0]), draw.randrange(SIZE[1])) for _ in range(count)]:
            out = folder / f"probe-{world.stem}-{x}-{y}"
            begin = time.time()
            line = [program, "probe", world, "--pixel", f"{x},{y}", "--quiet", "--force", "--out", out]
            done = subprocess.run(line, capture_output=True, text=True)
            if "meets nothing" in done.stderr:
                empty += 1
                continue
            if done.returncode not in (0, 1, 4):
                sys.exit(done.stderr)
            seconds.append(time.time() - begin)
            planes = json.loads((out / "probe.json").read_text())["planes"]
            for plane in planes:
                verdicts[plane["verdict"]] = verdicts.get(plane["verdict"], 0) + 1
            said = ", ".join(f"{plane['report']['name']} {plane['verdict']} ({plane['judge']})" for plane in planes)
            print(f"{world.stem} {x},{y}: {seconds[-1]:.0f} s, {said}", flush=True)
    seconds = sorted(seconds) or [0.0]
    print(f"{empty} pixels see nothing; planes: {verdicts}; median {seconds[len(seconds) // 2]:.0f} s, largest {seconds[-1]:.0f} s")


main()
