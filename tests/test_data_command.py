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
