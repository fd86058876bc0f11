"""The example scenes that the package contains."""

from __future__ import annotations

from pathlib import Path

_FOLDER = Path(__file__).parent / "scenes"

examples: dict[str, Path] = {
    path.relative_to(_FOLDER).with_suffix("").as_posix(): path for path in sorted(_FOLDER.rglob("*.ron"))
}
"""The path of each example scene by its name: `etendue.run(etendue.examples["fig9b"])`."""
