"""``frictionjoint data``: names, licences, hashes of public logs; local copies, never a guess."""

import json
import os
from pathlib import Path
from unittest import mock

import command_line
import pytest

from frictionjoint.measured.registry import list_data


def run(*arguments, data=None):
    with mock.patch.dict(os.environ, {"FRICTIONJOINT_DATA": str(data)} if data else {}):
        return command_line.run("data", *arguments, cwd=Path())


def test_list_names_every_set_with_its_licence():
    done = run("list")
    assert done.returncode == 0, done.stderr
    for data in list_data():
        assert data.name in done.stdout
    found = json.loads(run("list", "--json").stdout)
    assert {row["name"]: row["licence"] for row in found} == {
        x.name: x.licence for x in list_data()
    }
    assert all(len(digest) == 64 for row in found for digest in row["files"].values())


@pytest.mark.parametrize("name", [x.name for x in list_data()])
def test_get_tells_where_the_logs_lie(name, measured_data):
    found = json.loads(run("get", name, "--json", data=measured_data).stdout)
    assert found["licence"]
    assert all(os.path.exists(log) for log in found["logs"])


def test_altered_copy_is_refused(tmp_path):
    (tmp_path / "emps").mkdir()
    (tmp_path / "emps" / "DATA_EMPS.mat").write_bytes(b"something else")
    done = run("get", "emps", data=tmp_path)
    assert done.returncode == 2
    assert len(done.stderr.strip().splitlines()) == 1
    assert "not the published file" in done.stderr


def test_unknown_name_is_refused_in_one_line(tmp_path):
    done = run("get", "nothing", data=tmp_path)
    assert done.returncode == 2
    assert "emps, panda, xl330" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
