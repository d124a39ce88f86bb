"""Results show themselves in Jupyter, and the notebook of the documentation runs."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from frictionjoint.parameters import FrictionParameters
from frictionjoint.rivals import DahlParameters

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def test_parameters_show_a_table():
    own = FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, knots=((1e-3, 3.2),))
    assert "<td>Fs_pos</td><td>1.5</td>" in own._repr_html_()
    assert (
        "<td>law</td><td>dahl</td>"
        in DahlParameters(Fc_pos=1.0, Fc_neg=1.0, sigma0=1e3)._repr_html_()
    )


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
