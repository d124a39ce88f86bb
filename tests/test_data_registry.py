"""Public data: hashes hold, a local copy is used, no network is one line; the command `data`."""

import json
import os
import socket
from pathlib import Path
from unittest import mock

import command_line
import pooch
import pytest

from frictionjoint.errors import LogError
from frictionjoint.measured.readers import read_log
from frictionjoint.measured.registry import get_data, list_data


@pytest.fixture
def offline(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Every connection fails, and the cache is empty."""

    def refuse(*_: object, **__: object) -> None:
        raise OSError("no network in this test")

    monkeypatch.setattr(socket, "create_connection", refuse)
    monkeypatch.setattr(socket, "getaddrinfo", refuse)
    monkeypatch.setattr(pooch, "os_cache", lambda _: tmp_path / "cache")
    monkeypatch.delenv("FRICTIONJOINT_DATA", raising=False)


def test_every_set_is_pinned_and_says_its_licence() -> None:
    assert {data.name for data in list_data()} == {"emps", "panda", "xl330"}
    for data in list_data():
        assert data.licence
        assert any(len(part) == 40 for part in data.address.split("/"))
        assert all(len(digest) == 64 for digest in data.files.values())


@pytest.mark.usefixtures("offline")
def test_a_copy_needs_no_network(measured_data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRICTIONJOINT_DATA", str(measured_data))
    for data in list_data():
        folder = get_data(data.name)
        joint = "joint1" if data.name == "panda" else None
        assert read_log(folder / data.logs[0], joint).duration > 5.0


@pytest.mark.usefixtures("offline")
def test_no_network_is_one_line() -> None:
    with pytest.raises(LogError, match="FRICTIONJOINT_DATA") as caught:
        get_data("emps")
    assert "\n" not in str(caught.value)


def test_an_altered_or_missing_local_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FRICTIONJOINT_DATA", str(tmp_path))
    with pytest.raises(LogError, match=r"DATA_EMPS\.mat: missing"):
        get_data("emps")
    (tmp_path / "emps").mkdir()
    (tmp_path / "emps" / "DATA_EMPS.mat").write_bytes(b"other")
    with pytest.raises(LogError, match="not the published file"):
        get_data("emps")
    with pytest.raises(LogError, match="emps, panda, xl330"):
        get_data("atlas")


def run(*arguments, data=None):
    with mock.patch.dict(os.environ, {"FRICTIONJOINT_DATA": str(data)} if data else {}):
        return command_line.run("data", *arguments, cwd=Path())


def test_list_names_every_set_with_its_licence():
    done = run("list")
    assert done.returncode == 0, done.stderr
    assert all(data.name in done.stdout for data in list_data())
    found = json.loads(run("list", "--json").stdout)
    assert [(x["name"], x["licence"]) for x in found] == [(x.name, x.licence) for x in list_data()]
    assert all(row["files"] for row in found)


@pytest.mark.parametrize("name", [x.name for x in list_data()])
def test_get_tells_where_the_logs_lie(name, measured_data):
    found = json.loads(run("get", name, "--json", data=measured_data).stdout)
    assert found["licence"]
    assert all(os.path.exists(log) for log in found["logs"])
