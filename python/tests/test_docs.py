"""What the book says of the package happens; the notebook and the example run."""

import contextlib
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


PAGES = [
    ("README", 2),
    ("docs/package", 9),
    ("docs/operators-in-python", 6),
    ("docs/grids", 6),
    ("docs/renderer-tests", 4),
    ("docs/etendue-and-mtf", 4),
]


@pytest.mark.parametrize(("page", "least"), PAGES)
def test_what_pages_print(page, least, monkeypatch):
    monkeypatch.chdir(ROOT)
    blocks = re.findall(r"```(python|text)\n(.*?)```", (ROOT / f"{page}.md").read_text(), re.DOTALL)
    assert len(blocks) >= least
    names, said = {}, ""
    for kind, text in blocks:
        if kind == "python":
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(text, names)
            said = out.getvalue()
        else:
            pattern = re.escape(text.strip()).replace("…", ".*")
            assert re.fullmatch(pattern, said.strip()), said


def test_the_page_of_theories(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs/own-theory.md").read_text()
    scene, theory = (re.search(rf"```{kind}\n(.*?)```", page, re.DOTALL)[1] for kind in ("ron", "python"))
    (tmp_path / "lamp.ron").write_text(scene)
    measure, compare, *_ = re.findall(r"^    etendue (.*)$", page, re.MULTILINE)

    def code(arguments):
        return subprocess.run([sys.executable, "-m", "etendue", *arguments.split()], check=False).returncode

    assert code(measure) == 0
    for script, expected in [(theory, 0), (theory.replace("x[:, None] - u", "x[:, None] + u"), 1)]:
        exec(script, {})
        assert code(f"{compare} --force") == expected


def test_the_notebook(tmp_path):
    nbclient = pytest.importorskip("nbclient")
    import nbformat

    notebook = nbformat.read(ROOT / "docs/notebook.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(ROOT)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    assert any("<table>" in output.get("data", {}).get("text/html", "") for output in outputs)


@pytest.mark.parametrize("path", sorted((ROOT / "docs").glob("*.ipynb")), ids=lambda path: path.stem)
def test_notebooks_are_committed_with_their_pictures(path):
    """So that they are read without being run."""
    cells = [cell for cell in json.loads(path.read_text())["cells"] if cell["cell_type"] == "code"]
    for cell in cells:
        assert not any(output["output_type"] == "error" or output.get("name") == "stderr" for output in cell["outputs"])
        if "plt.show()" in "".join(cell["source"]):
            assert any("image/png" in output.get("data", {}) for output in cell["outputs"])
    assert any(cell["outputs"] for cell in cells)


def test_dask_merges_to_the_same_bytes(tmp_path):
    pytest.importorskip("distributed")
    scene = ROOT / "scenes/fig9b.ron"
    # Processes of Dask import the package as this one does.
    subprocess.run([sys.executable, ROOT / "python/examples/dask_parts.py", scene, tmp_path / "a"], check=True, env=os.environ)
    line = ["run", scene, "--photons=2^20", "--quiet", "--out", tmp_path / "b"]
    subprocess.run([sys.executable, "-m", "etendue", *line], check=False)
    assert (tmp_path / "a/summary.json").read_bytes() == (tmp_path / "b/summary.json").read_bytes()
