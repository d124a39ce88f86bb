"""Results show themselves in Jupyter, and the notebook of the documentation runs."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def test_a_report_shows_verdict_errors_and_picture(demo_report):
    text = replace(demo_report, joint="<b>elbow</b>")._repr_html_()
    assert "<b>Missing:</b> Cogging." in text
    assert "Coulomb friction" in text
    assert "&lt;b&gt;elbow&lt;/b&gt;" in text
    assert text.count("<img") == 1
    assert "<script" not in text


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.ipynb")), ids=lambda p: p.stem)
def test_a_notebook_runs(path, tmp_path):
    shutil.copytree(EXAMPLES / "recording", tmp_path / "recording")
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(
        notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    cells = [c for c in notebook.cells if c.cell_type == "code"]
    assert all(c.execution_count for c in cells)
    assert any("text/html" in o.get("data", {}) for c in cells for o in c.outputs)
    assert any("image/png" in o.get("data", {}) for o in cells[-1].outputs), "it ends with a plot"
