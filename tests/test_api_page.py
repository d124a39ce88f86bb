"""The API page lists every public module once."""

import re
from importlib import import_module
from pathlib import Path

import frictionjoint as fj

DOCS = Path(__file__).resolve().parents[1] / "docs"
LISTED = re.findall(r"^::: (\S+)", (DOCS / "api.md").read_text(), re.MULTILINE)


def test_nothing_is_listed_twice() -> None:
    assert len(LISTED) == len(set(LISTED))


def test_what_the_package_offers_is_listed() -> None:
    listed = {name.removesuffix(".FrictionParameters") for name in LISTED}
    assert sorted(set(fj._HOMES.values()) - listed) == []


def test_modules_that_the_pages_import_are_listed() -> None:
    pages = [DOCS.parent / "README.md", *DOCS.glob("*.md")]
    text = "\n".join(page.read_text() for page in pages)
    used = set(re.findall(r"^\s*from (frictionjoint\.\S+) import", text, re.MULTILINE))
    assert used, "the pages show imports"
    assert sorted(used - set(LISTED)) == []


def test_what_is_listed_is_there() -> None:
    for name in LISTED:
        if name in ("frictionjoint.simulate.mjlab", "frictionjoint.simulate.sysid"):
            continue  # they import what may not be installed
        try:
            import_module(name)
        except ModuleNotFoundError:
            module, _, thing = name.rpartition(".")
            assert hasattr(import_module(module), thing), name
