"""The script behind lab/notes/paper.md, and the page itself."""

import json
import re
import sys
from pathlib import Path

import paper_figures
import pytest

ROOT = Path(__file__).resolve().parents[2]

ONLY = ["--only", "reversal"]


def test_one_claim_becomes_a_picture_and_numbers(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["paper_figures.py", "--out", str(tmp_path), *ONLY])
    paper_figures.main()
    assert (tmp_path / "reversal.png").read_bytes().startswith(b"\x89PNG")
    numbers = json.loads((tmp_path / "numbers.json").read_text())
    assert numbers["reversal"]["extrema_after_closing"] == 2


@pytest.mark.parametrize("arguments", [[], ["--write", *ONLY]])
def test_nothing_to_write_or_half_a_page_is_refused(arguments, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["paper_figures.py", *arguments])
    with pytest.raises(SystemExit) as refused:
        paper_figures.main()
    assert refused.value.code == 2
    assert "--write" in capsys.readouterr().err


def test_the_page_shows_every_claim_and_its_pictures_are_small():
    page = (ROOT / "lab" / "notes" / "paper.md").read_text()
    shown = re.findall(r"\]\((img/paper/(\w+)\.png)\)", page)
    assert [name for _, name in shown] == list(paper_figures.NAMES)
    for path, _ in shown:
        assert 5_000 < (ROOT / "lab" / "notes" / path).stat().st_size < 150_000
