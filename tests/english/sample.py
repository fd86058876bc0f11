"""Draw sentences of the project by a seed, to be read once by someone who has not seen them.

usage: python3 tests/english/sample.py [SEED [COUNT]]

As many are drawn from comments, from Markdown pages, from messages (strings of the program with several words) and from help texts.
Each line is a kind, a file and a sentence, with tabs between them.
"""

import random
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted(p for folder in ("crates", "python/src", "mpi/src", "tests") for p in (ROOT / folder).rglob("*.rs"))
HELP = ROOT / "crates/cli/src/args"
MIN_WORDS = 4


def sentences(text):
    """The sentences of a paragraph that have enough words to be read."""
    text = re.sub(r"\s+", " ", text).strip()
    each = re.split(r"(?<=[.!?:])\s+(?=[A-Z‖|Ω`*])", text)
    return [s for s in each if len(s.split()) >= MIN_WORDS and re.search(r"[a-z]{3}", s)]


def comments(path):
    """Paragraphs of the comments of a Rust file."""
    block = []
    for line in path.read_text().splitlines() + [""]:
        found = re.match(r"\s*(?:///|//!|//)\s?(.*)", line)
        if found and found[1].strip():
            block.append(found[1])
        elif block:
            yield " ".join(block)
            block = []


def messages(path):
    """Strings of a Rust file outside its tests."""
    text = path.read_text().split("#[cfg(test)]")[0]
    text = re.sub(r"^\s*//.*$", "", text, flags=re.M)
    for found in re.finditer(r'"((?:[^"\\\n]|\\.|\\\n)*)"', text):
        yield re.sub(r"\\\n\s*", "", found[1])


def pages():
    """Paragraphs of Markdown outside code and tables."""
    for path in sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *(ROOT / "scenes").glob("*.md")]):
        text = re.sub(r"```.*?```", "", path.read_text(), flags=re.S)
        for paragraph in re.split(r"\n\s*\n", text):
            if not paragraph.startswith(("    ", "|", "#", "![")):
                for item in re.split(r"\n\s*[*-] ", "\n" + paragraph):
                    yield path, item


def main():
    seed, count = (int(a) for a in (*sys.argv[1:], *("1", "200")[len(sys.argv) - 1 :]))
    library = [p for p in SOURCES if HELP not in p.parents]
    kinds = {
        "comment": [(p, s) for p in library for c in comments(p) for s in sentences(c)],
        "page": [(p, s) for p, c in pages() for s in sentences(c)],
        "message": [(p, s) for p in SOURCES if "/tests/" not in str(p) for c in messages(p) for s in sentences(c)],
        "help": [(p, s) for p in SOURCES if HELP in p.parents for c in comments(p) for s in sentences(c)],
    }
    draw = random.Random(seed)
    for kind, found in kinds.items():
        for path, sentence in draw.sample(found, count // len(kinds)):
            print(kind, path.relative_to(ROOT), sentence, sep="\t")


if __name__ == "__main__":
    main()
