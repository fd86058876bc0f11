"""Holds the book to what it says: its links, its commands and what they print, its files.

usage: check.py PROGRAM BOOK
PROGRAM is `etendue`, BOOK the folder of the built book. To be
started at the top of the repository.

Blocks of a chapter run in their order, in a folder of its own that has a copy of `scenes`.

    ron, yaml file=NAME   is written into the file; a workflow of GitHub is gone through as well
    ron fragment          is read by crates/scene/tests/book.rs
    sh [code=N]           runs, and must end with that exit code, 0 unless stated
    python                runs
    text                  must be in what the last block that ran has printed, lines in order;
                          `…` stands for anything

Scenes of the repository are run with few photons there, and scenes of a chapter as they are.
Indented commands, on all pages and in README.md, are not run: their options, scenes and tests
must exist.
"""

import os
import re
import shlex
import shutil
import stat
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from blocks import Block, blocks, indented
from links import broken_links
from workflow import go_through

TOP = Path.cwd()
# Kinds of evidence for statements of the paper.
KINDS = [
    "photons",
    "rays",
    "quadrature",
    "picture",
    "formula",
    "definition",
    "future work",
    "not shown",
]
FEW = "2^16"
# Their blocks need the Python package: python/tests/test_docs.py runs them.
ELSEWHERE = [
    "etendue-and-mtf.md",
    "grids.md",
    "operators-in-python.md",
    "own-theory.md",
    "package.md",
    "renderer-tests.md",
]
# What the commands of the book are when it is tested.
WORDS = {
    "etendue": """
few=()
if [[ "$1" =~ ^(run|measure|predict|sweep)$ && "$*" == *" scenes/"* && "$*" != *--photons* ]]; then
    few=(--photons FEW)
fi
PROGRAM "$@" "${few[@]}"
code=$?
# With few photons some planes are undecided.
[ "${#few[@]}" -gt 0 ] && [ $code = 4 ] && exit 0
exit $code
""",
    "cargo": """
case "$*" in
"install --locked --path "*) grep -q '^name = "etendue"$' "${!#}/Cargo.toml" ;;
"run --release -p etendue -- "*) shift 5; etendue "$@" ;;
*) echo "the book's test knows no cargo $*"; exit 1 ;;
esac
""",
}


def tools(folder: Path, program: Path) -> dict[str, str]:
    """Puts the words of the book on the path."""
    folder.mkdir()
    for name, text in WORDS.items():
        script = folder / name
        script.write_text(
            "#!/bin/bash\n" + text.replace("PROGRAM", str(program)).replace("FEW", FEW)
        )
        script.chmod(script.stat().st_mode | stat.S_IXUSR)
    path = os.pathsep.join([str(folder), str(Path(sys.executable).parent), os.environ["PATH"]])
    return os.environ | {"PATH": path, "MPLBACKEND": "Agg"}


def shows(text: str, printed: str) -> str | None:
    """The first line of a text that was not printed in its place."""
    lines = iter([" ".join(line.split()) for line in printed.splitlines()])
    for line in text.splitlines():
        words = " ".join(line.split())
        pattern = ".*".join(map(re.escape, words.split("…")))
        if words not in ("", "…") and not any(re.fullmatch(pattern, printed) for printed in lines):
            return line
    return None


def run(block: Block, folder: Path, environment: dict[str, str]) -> tuple[int, str]:
    """Runs commands or Python; their exit code, and what they printed."""
    command = ["bash", "-eo", "pipefail", "-c"] if block.language == "sh" else ["python", "-c"]
    done = subprocess.run(
        [*command, block.text],
        cwd=folder,
        env=environment,
        text=True,
        timeout=300,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
    )
    return done.returncode, done.stdout


def check_chapter(page: Path, folder: Path, environment: dict[str, str]) -> list[str]:
    """Goes through the blocks of a page; what is wrong."""
    if page.name in ELSEWHERE:
        return []
    shutil.copytree(TOP / "scenes", folder / "scenes")
    wrong, printed, count = [], "", 0
    began = time.monotonic()
    for block in blocks(page):
        where = f"{page}:{block.line}"
        count += 1
        if block.file:
            (folder / block.file).parent.mkdir(parents=True, exist_ok=True)
            (folder / block.file).write_text(block.text)
            if ".github/workflows" in block.file:
                wrong += [
                    f"{where}: {fault}"
                    for fault in go_through(block.text, folder, environment, TOP)
                ]
        elif block.language in ("sh", "python"):
            code, printed = run(block, folder, environment)
            if code != block.code:
                wrong.append(f"{where}: exit code {code}, not {block.code}\n{printed}")
        elif block.language == "text":
            missing = shows(block.text, printed)
            if missing is not None:
                wrong.append(f"{where}: not printed: {missing}\nprinted was\n{printed}")
        elif block.language != "fragment":
            wrong.append(f"{where}: a block of `{block.language}` that is not tested")
    if count:
        print(f"{page}: {count} blocks, {time.monotonic() - began:.1f} s")
    return wrong + kept_pictures(page, folder)


def kept_pictures(page: Path, folder: Path) -> list[str]:
    """Pictures of a chapter, pictures/NAME.svg, that have not the bytes of any that its commands make."""
    made = {file.read_bytes() for file in (folder / "out").glob("**/*.svg")}
    wrong = []
    for name in re.findall(r"\]\(pictures/(\w+)\.svg\)", page.read_text()):
        kept = page.parent / "pictures" / f"{name}.svg"
        if not kept.exists() or kept.read_bytes() not in made:
            copy = TOP / "target" / "book" / page.stem
            shutil.copytree(folder / "out", copy, dirs_exist_ok=True)
            wrong.append(f"{kept} is not what {page} makes; that is in {copy}")
    return wrong


def missing_tests(words: list[str]) -> list[str]:
    """The tests that a command names by `-p CRATE NAME` and that are not in that crate."""
    if "-p" not in words:
        return []
    crate, *names = words[words.index("-p") + 1 :]
    names = [
        name
        for name in names[: names.index("--") if "--" in names else None]
        if not name.startswith("-")
    ]
    folder = {"etendue": "crates/cli", "etendue-validation": "tests"}.get(
        crate, "crates/" + crate.removeprefix("etendue-")
    )
    texts = [file.read_text() for file in (TOP / folder).glob("**/*.rs")]
    texts += [f"fn {file.stem}(" for file in (TOP / folder / "tests").glob("*.rs")]
    return [
        f"no test {name} in {crate}"
        for name in names
        if not any(f"fn {name}(" in text for text in texts)
    ]


def check_commands(page: Path, program: Path) -> list[str]:
    """The commands that a page shows: whether their options and scenes are there."""
    wrong = []
    for line, text in indented(page):
        words = shlex.split(text, comments=True)
        if words[:2] == ["cargo", "test"]:
            wrong += [f"{page}:{line}: {fault}" for fault in missing_tests(words)]
        if words[:5] == "cargo run --release -p etendue".split():
            words = ["etendue", *words[6:]]
        elif words[:5] == "cargo run --release -p etendue-validation".split():
            words = [str(program) + "-validation", *words[6:]]
        if Path(words[0]).name not in ("etendue", "etendue-validation"):
            continue
        command = [str(program) if words[0] == "etendue" else words[0], *words[1:], "--help"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            wrong.append(f"{page}:{line}: {text}: {done.stderr.strip()}")
        scenes = [word for word in words if re.fullmatch(r"scenes/[\w/]+\.ron", word)]
        wrong += [f"{page}:{line}: no {scene}" for scene in scenes if not (TOP / scene).exists()]
    return wrong


def check_statements(page: Path) -> list[str]:
    """Each row of the page on the paper names its kind of evidence; the head counts the kinds."""
    text = page.read_text()
    rows = re.findall(r"^\| (?!statement).+$", text, flags=re.MULTILINE)
    wrong, found = [], Counter()
    for row in rows:
        cells = row.split(" |")
        kind = cells[2].partition(":")[0].strip() if len(cells) == 4 else ""
        found[kind] += 1
        if kind not in KINDS:
            wrong.append(f"{page}: a row without kind of evidence: {row}")
        if kind == "photons" and ":" not in cells[2]:
            wrong.append(f"{page}: a row without the smallest fault that photons see: {row}")
    head = text.partition("\n## ")[0]
    total = re.findall(r"Of (\d+) statements", head)
    stated = {kind: int(n) for n, kind in re.findall(r"(\d+)(?: [a-z]+)* \*([a-z ]+)\*", head)}
    if total != [str(len(rows))] or stated != found:
        wrong.append(f"{page}: states {total} {stated}, but has {len(rows)} {dict(found)}")
    return wrong


def check_schema(folder: Path, program: Path) -> list[str]:
    """All scenes of the repository fit the schema, and a few that are wrong do not."""
    import json

    import jsonschema

    schema = json.loads((TOP / "docs" / "scene.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    wrong, scene = [], {}
    for path in sorted((TOP / "scenes").glob("**/*.ron")):
        out = folder / "schema" / path.stem
        # One batch of one photon: it holds the scene as JSON.
        measure = [
            "measure",
            str(path),
            "--photons",
            "1024",
            "--batches",
            "0..1",
            "--quiet",
            "--out",
            str(out),
        ]
        subprocess.run([str(program), *measure], check=True)
        scene = json.loads((out / "measurement.json").read_text())["scene_file"]
        wrong += [
            f"scene.schema.json refuses {path}: {e.message}" for e in validator.iter_errors(scene)
        ]
    for field, value in [
        ("light", {"Rectangle": {}}),
        ("window", {"x": {"Hann": 0}}),
        ("plane", []),
        ("run", {"batches": 1}),
    ]:
        if validator.is_valid(scene | {field: value}):
            wrong.append(f"scene.schema.json takes {field}: {value}")
    return wrong


def main() -> int:
    program, book = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    pages = sorted((TOP / "docs").glob("*.md"))
    wrong = broken_links(book, TOP)
    for page in [*pages, TOP / "README.md", TOP / "scenes" / "README.md"]:
        wrong += check_commands(page, program)
    with tempfile.TemporaryDirectory() as folder:
        environment = tools(Path(folder) / "bin", program)
        wrong += check_schema(Path(folder), program)
        wrong += check_statements(TOP / "docs" / "paper.md")
        for page in pages:
            if blocks(page):
                chapter = Path(folder) / page.stem
                chapter.mkdir()
                wrong += check_chapter(page.relative_to(TOP), chapter, environment)
    for fault in wrong:
        print(fault)
    print(f"the book: {len(wrong)} faults")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
