"""The command line: what its commands print, their help, exit code 2 for bad input."""

import json
import re
import subprocess
import sys
from importlib import metadata
from importlib.resources import files
from pathlib import Path

import pytest
from command_line import run

from frictionjoint.files import read_parameters, toml_text
from frictionjoint.parameters import FrictionParameters

DEMO = Path(str(files("frictionjoint"))) / "demo"
LOG = DEMO / "ramps.csv"
MODEL = DEMO / "joint.xml"


def started(*arguments, cwd):
    """As a process of its own, which takes seconds to import everything."""
    command = [sys.executable, "-m", "frictionjoint", *arguments]
    return subprocess.run(
        [str(a) for a in command], cwd=cwd, capture_output=True, text=True, timeout=300
    )


def test_the_process_ends_with_the_code_and_the_line(tmp_path):
    done = started(
        *("close-loop", "none.csv", "--model", MODEL, "--joint", "joint", "--out", "out"),
        cwd=tmp_path,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("frictionjoint: none.csv: no such log")
    assert len(done.stderr.splitlines()) == 1


def test_identify_install_and_check_work_in_a_row(tmp_path):
    # the model has one joint: it needs no name
    done = run("identify", LOG, "--model", MODEL, "--out", "joint.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    # breakaway and Coulomb torque of the plant: 1.5 and 1.0 N m
    found = read_parameters(tmp_path / "joint.toml").parameters
    assert 0.6 < found.Fc_pos < 1.5
    done = run("install", MODEL, "--joint", "joint=joint.toml", "--out", "arm.xml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = run("check", "arm.xml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "integrated" in done.stdout


COMMANDS = (
    *("demo", "plot", "close-loop", "evaluate", "identify", "compare", "inspect", "sample"),
    *("drift", "install", "uninstall", "check", "view", "export", "motors", "data"),
)


@pytest.mark.parametrize("name", [*COMMANDS, "data list", "data get"])
def test_every_subcommand_has_help_with_an_example(name, tmp_path):
    done = run(*name.split(), "--help", cwd=tmp_path)
    assert done.returncode == 0
    assert f"Usage: frictionjoint {name}" in done.stdout
    assert re.search(rf"Examples?:\s+frictionjoint {name}", done.stdout)


def test_the_help_lists_the_commands_in_the_order_of_use(tmp_path):
    for arguments in ((), ("--help",), ("-h",)):
        done = run(*arguments, cwd=tmp_path)
        assert done.returncode == 0
        assert re.findall(r"^│ ([a-z][a-z-]+)  ", done.stdout, re.MULTILINE) == list(COMMANDS)


def test_version(tmp_path):
    done = run("--version", cwd=tmp_path)
    assert done.returncode == 0
    assert done.stdout.startswith(f"frictionjoint {metadata.version('frictionjoint')}\nmujoco ")


def test_piped_output_is_plain_and_wide(tmp_path):
    for arguments in (("--help",), ("data", "list")):
        assert "\x1b" not in started(*arguments, cwd=tmp_path).stdout
    # an address that is cut short leads nowhere
    listed = "".join(run("data", "list", cwd=tmp_path).stdout.split())
    assert "…" not in listed


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["close-lop"], "No such command 'close-lop'. Did you mean 'close-loop'?; see"),
        (["bogus"], "No such command 'bogus'; see frictionjoint --help"),
        (["check"], "; see frictionjoint check --help"),
        (["check", LOG], "not a model: give the path of an MJCF or a URDF"),
        (["check", DEMO], "a folder, give the path of an MJCF"),
        (["sample", "out", "--n", 10**11, "--out", "s.json"], "--n"),
        (["sample", "out", "--n", 3, "--out", "s.toml"], "the name must end in .json"),
        (["evaluate", "none.xml", LOG], "no hinge or slide joint in the model"),
        (["identify", LOG, "--model", "none.xml", "--out", "a.toml"], "none.xml: no hinge or"),
        (["identify", LOG, "--model", "unnamed.xml", "--out", "a.toml"], "joint has no name: name"),
        (
            ["compare", "none.xml"],
            "none.xml: not TOML: Invalid statement (at line 1, column 1); give",
        ),
        (["inspect", "latin.toml"], "latin.toml: not text in UTF-8, save it as UTF-8"),
    ],
)
def test_wrong_usage_names_what_to_do(arguments, line, tmp_path):
    (tmp_path / "none.xml").write_text("<mujoco/>")
    (tmp_path / "unnamed.xml").write_text(MODEL.read_text().replace('name="joint"', ""))
    (tmp_path / "latin.toml").write_bytes(b"# \xe9")
    done = run(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert line in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("line", "wanted"),
    [("frictionjoint cl", ["close-loop"]), ("frictionjoint check --js", ["--json"])],
)
def test_shells_complete_commands_and_options(line, wanted, tmp_path, monkeypatch):
    monkeypatch.setenv("_FRICTIONJOINT_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", str(len(line.split()) - 1))
    done = started(cwd=tmp_path)
    assert done.stdout.split() == wanted, done.stderr


def test_json_goes_to_scripts_alone(tmp_path):
    (tmp_path / "arm.xml").write_text(MODEL.read_text())
    parameters = FrictionParameters.symmetric(Fs=1.5, Fc=1.0, Vs=0.05, knots=((1e-3, 3.2),))
    (tmp_path / "p.toml").write_text(toml_text(parameters))
    done = run("install", "arm.xml", "--joint", "joint=p.toml", "--out", "with.xml", cwd=tmp_path)
    assert done.stdout == "Wrote with.xml with friction in joint.\n"
    (row,) = json.loads(run("check", "with.xml", "--json", cwd=tmp_path).stdout)
    assert row["joint"] == "joint"
    assert row["stiffness"] == pytest.approx(3200.0)
