"""The README and the site: few pages, few words, plain ones, small pictures; the API page lists
every public name, and the effect that CONTRIBUTING.md shows works as it stands there."""

import importlib.util
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import frictionjoint as fj
from frictionjoint.effects import signals

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))
import api_page  # noqa: E402

LISTED = [name for names in api_page.GROUPS.values() for name in names]
README = (ROOT / "README.md").read_text()
PAGES = sorted(DOCS.glob("*.md"))
GENERATED = {"effects.md", "commands.md", "api.md"}
ARM = """<mujoco><worldbody><body><joint name="elbow" axis="0 1 0"/>
<inertial pos="0.15 0 0" mass="0.3" diaginertia="2e-3 2e-3 2e-3"/></body></worldbody></mujoco>"""
# words with a meaning of their own here, which a new reader does not know
PRIVATE = re.compile(
    r"\b(told|borne out|beside|plants?|(second|third) hand|ripe|mend|hardly|swings?|thereof"
    r"|bent law|the squares|never looked at|let go)\b"
)


def navigation() -> list[str]:
    """Pages that the site's navigation lists."""
    return re.findall(r":\s+(\S+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE)


def test_every_page_is_listed_once_and_pages_and_words_are_few():
    listed = navigation()
    assert len(listed) == len(set(listed)) <= 14
    assert {page.name for page in PAGES} | GENERATED == set(listed)
    assert sum(len(page.read_text().split()) for page in PAGES) < 15_000


@pytest.mark.parametrize("page", [ROOT / "README.md", *PAGES], ids=lambda page: page.stem)
def test_a_page_uses_the_fields_words(page):
    prose = re.sub(r"```.*?```|`[^`]*`|\]\([^)]*\)", " ", page.read_text(), flags=re.DOTALL)
    assert [found.group() for found in PRIVATE.finditer(prose)] == []


def test_the_readme_has_its_two_commands_and_its_lines_run(tmp_path, monkeypatch, capsys):
    lines = README.splitlines()
    assert lines.index("pip install . && frictionjoint demo") < lines.index("```python") < 20
    assert "pip install '.[test]' && pytest" in lines
    monkeypatch.chdir(tmp_path)
    Path("arm.xml").write_text(ARM)
    exec(re.search(r"```python\n(.*?)```", README, re.DOTALL)[1], {})
    # the weight of the arm, which the joint holds
    assert float(capsys.readouterr().out) == pytest.approx(0.3 * 9.81 * 0.15, rel=1e-3)


def test_the_readme_shows_a_moving_picture_below_a_megabyte_and_links_files_that_exist():
    (name,) = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README)
    content = (ROOT / name).read_bytes()
    assert len(content) < 1_000_000
    assert content.count(b"ANMF") > 50, "frames of an animated WebP"
    links = re.findall(r"\]\(([^)#]+)\)", README)
    assert [link for link in links if "://" not in link and not (ROOT / link).exists()] == []


def test_modules_that_the_pages_import_are_listed() -> None:
    text = "\n".join([README, *(page.read_text() for page in PAGES)])
    used = set(re.findall(r"^\s*from (frictionjoint\.\S+) import", text, re.MULTILINE))
    public = {fj._HOMES[name] for name in LISTED}
    assert used, "the pages show imports"
    assert used <= public | set(api_page.MODULES)


def test_the_page_says_what_each_public_name_does() -> None:
    assert sorted(LISTED) == sorted(fj._HOMES)
    rows = re.findall(r"^\| `(\w+)\(.*?\)` \| (.+) \|$", api_page.page(), re.MULTILINE)
    assert {name for name, _ in rows} == set(LISTED)
    assert all(len(text) > 10 for _, text in rows)


@pytest.fixture(scope="module")
def magnet(tmp_path_factory):
    guide = (ROOT / "CONTRIBUTING.md").read_text()
    (code,) = re.findall(r"^```python\n(.*?)^```", guide, re.MULTILINE | re.DOTALL)
    file = tmp_path_factory.mktemp("guide") / "magnet.py"
    file.write_text(code)
    spec = importlib.util.spec_from_file_location("magnet", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_its_torque_pulls_as_its_form_says(magnet):
    width, strength = 0.2, 3.0
    torque = getattr(magnet.torque, "py_func", magnet.torque)  # it is not in the built library
    P, row, X = np.array([width, strength]), np.zeros(signals.N_SIGNALS), np.zeros(3)
    for q in (-0.3, 0.0, 0.1, 0.2, 2.0):
        row[signals.Q] = q
        expected = strength * q / width * np.exp(-((q / width) ** 2))
        assert torque(P, 0, row, X, 0) == pytest.approx(expected, rel=1e-12)
