"""The API page lists every public name once, and every module that a page imports."""

import re
import sys
from pathlib import Path

import frictionjoint as fj

DOCS = Path(__file__).resolve().parents[1] / "docs"
sys.path.insert(0, str(DOCS))
import api_page  # noqa: E402

LISTED = [name for names in api_page.GROUPS.values() for name in names]


def test_every_public_name_is_listed_once() -> None:
    assert sorted(LISTED) == sorted(fj._HOMES)


def test_modules_that_the_pages_import_are_listed() -> None:
    pages = [DOCS.parent / "README.md", *DOCS.glob("*.md")]
    text = "\n".join(page.read_text() for page in pages)
    used = set(re.findall(r"^\s*from (frictionjoint\.\S+) import", text, re.MULTILINE))
    public = {fj._HOMES[name] for name in LISTED}
    assert used, "the pages show imports"
    assert used <= public | set(api_page.MODULES)


def test_the_page_says_what_each_name_does() -> None:
    rows = re.findall(r"^\| `(\w+)\(.*?\)` \| (.+) \|$", api_page.page(), re.MULTILINE)
    assert {name for name, _ in rows} == set(LISTED)
    assert all(len(text) > 10 for _, text in rows)
