"""The blocks of code in a page of Markdown."""

import re
from dataclasses import dataclass
from pathlib import Path


@dataclass
class Block:
    """A fenced block: its language, the file it is, the exit code it should end with."""

    line: int
    language: str
    file: str
    code: int
    text: str


def blocks(page: Path) -> list[Block]:
    """The fenced blocks of a page."""
    found, begun = [], None
    for number, line in enumerate(page.read_text().splitlines(), 1):
        fence = re.match(r"```(.*)", line)
        if fence and begun is None:
            words = fence[1].split()
            options = dict(word.partition("=")[::2] for word in words[1:])
            if "fragment" in options:
                # crates/scene/tests/book.rs reads those.
                words[0] = "fragment"
            code = int(options.get("code", 0))
            begun = Block(number, words[0] if words else "", options.get("file", ""), code, "")
        elif fence:
            found.append(begun)
            begun = None
        elif begun:
            begun.text += line + "\n"
    if begun:
        raise SystemExit(f"{page}:{begun.line}: a block without end")
    return found


def indented(page: Path) -> list[tuple[int, str]]:
    """The indented lines that begin with a command of Étendue, and where they stand."""
    lines = page.read_text().splitlines()
    begins = re.compile(r" {4}(etendue|cargo run --release -p etendue|cargo test .*-p )\S* ")
    return [(number, line.strip()) for number, line in enumerate(lines, 1) if begins.match(line)]
