"""Paths per second of `etendue render` and of Mitsuba 3, with the same scenes, films, depths and Russian roulette.

usage: paths_per_second.py PROGRAM [ROUNDS] [THREADS] [SCENE.xml ...]      e.g. paths_per_second.py target/release/etendue 7 1

Needs numpy and mitsuba, and LLVM (DRJIT_LIBLLVM_PATH). Scenes are `cbox.xml`, `room.xml` and `hall_obj.xml` in the folder `scenes` beside
this script, unless files are given. Both count in one number (llvm_ad_mono), with a box for a filter. Seconds are those of the processor, and rounds alternate.
The time of a path is the difference of two pictures with few and with many paths, so that neither reading and building of scenes nor
compilation of kernels counts. PROGRAM may be several programs with commas between them, which take turns.
"""
import pathlib, resource, statistics, subprocess, sys, tempfile, time

import mitsuba as mi

mi.set_variant("llvm_ad_mono")
import drjit as dr

SIDE = 256
DEPTH = 8  # surfaces of a path, as `--bounces` counts them
ROULETTE = 6  # `paths::ROULETTE`
FEW, MANY = 16, 80  # paths a pixel
SCENES = pathlib.Path(__file__).parent / "scenes"


class Mitsuba:
    def __init__(self, path):
        self.scene = mi.load_file(str(path))
        w, h = self.scene.sensors()[0].film().size()
        self.size = [SIDE, max(1, round(SIDE * h / w))]
        params = mi.traverse(self.scene.sensors()[0])
        params["film.size"] = mi.ScalarVector2u(self.size)
        params.update()
        self.integrator = None

    def seconds(self, depth, samples, seed):
        if self.integrator is None:
            self.integrator = mi.load_dict({"type": "path", "max_depth": depth + 1, "rr_depth": ROULETTE})
        start = time.process_time()
        dr.eval(mi.render(self.scene, integrator=self.integrator, spp=samples, seed=seed))
        dr.sync_thread()
        return time.process_time() - start


def render(program, path, size, samples, folder, threads):
    w, h = size
    command = [program, "render", path, "--size", f"{w}x{h}", "--samples", str(samples), "--bounces", str(DEPTH), "--out", folder, "--force", "--quiet"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([*command, "--threads", str(threads)], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def case(programs, path, rounds, threads, folder):
    theirs = Mitsuba(path)
    paths = theirs.size[0] * theirs.size[1] * (MANY - FEW)
    for samples in (FEW, MANY):
        theirs.seconds(DEPTH, samples, 0)  # compiles
    rows = []
    for round in range(rounds):
        mitsuba = [theirs.seconds(DEPTH, samples, round) for samples in (FEW, MANY)]
        ours = [[render(program, path, theirs.size, samples, folder / "out", threads) for samples in (FEW, MANY)] for program in programs]
        rows.append([many - few for few, many in (mitsuba, *ours)])
    medians = [statistics.median(column) for column in zip(*rows)]
    print(f"{path.stem:12} {threads} threads, {paths} paths: Mitsuba {paths / medians[0] / 1e6:.3f} M a second", end="")
    for i, program in enumerate(programs, 1):
        ratio = statistics.median(row[0] / row[i] for row in rows)
        print(f"; {program} {paths / medians[i] / 1e6:.3f}, ratio {ratio:.3f}", end="")
    print(flush=True)


def main(programs, rounds=7, threads=1, *scenes):
    dr.set_thread_count(int(threads))
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        paths = [pathlib.Path(scene) for scene in scenes] or [SCENES / name for name in ("cbox.xml", "room.xml", "hall_obj.xml")]
        for path in paths:
            case(programs.split(","), path, int(rounds), int(threads), folder)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
