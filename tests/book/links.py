"""The links of the built book."""

import html
import shutil
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """Where a page of HTML leads, and what in it can be led to."""

    def __init__(self, path: Path):
        super().__init__()
        self.links: list[str] = []
        self.names: set[str] = set()
        self.feed(path.read_text())

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.names.update(given[key] for key in ("id", "name") if given.get(key))
        self.links += [given[key] for key in ("href", "src") if given.get(key)]


def broken_links(book: Path, top: Path) -> list[str]:
    """Links that lead nowhere. What they lead to outside of the book is copied beside it."""
    # The page for printing holds all others; the one for lost readers has no place of its own.
    paths = [
        path
        for path in book.glob("*.html")
        if path.name not in ("print.html", "404.html", "toc.html")
    ]
    pages = {path: Page(path) for path in paths}
    wrong, outside = [], 0
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                outside += 1
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.is_relative_to(book):
                target = copied(target, book, top)
            if not target.exists():
                wrong.append(f"{path.name}: {link} leads nowhere")
            elif (
                parts.fragment
                and target in pages
                and unquote(parts.fragment) not in pages[target].names
            ):
                wrong.append(f"{path.name}: {link} has no such place")
    print(
        f"links of {len(pages)} pages: {len(wrong)} broken; {outside} to other sites, not followed"
    )
    return wrong


def copied(target: Path, book: Path, top: Path) -> Path:
    """A file or a folder of the repository, copied to where a page of the book looks for it."""
    if not target.is_relative_to(book.parent):
        return target
    source = top / target.relative_to(book.parent)
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, target, dirs_exist_ok=True)
    elif source.exists():
        shutil.copy(source, target)
    elif source.with_suffix(".md").exists():
        # mdBook takes all pages for its own.
        text = html.escape(source.with_suffix(".md").read_text())
        target.write_text(
            f'<!doctype html><meta charset="utf-8"><pre style="white-space: pre-wrap">{text}</pre>'
        )
    return target
