"""Write a report's folder whole or not at all."""

import json
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from frictionjoint.diagnose.report_data import Report
from frictionjoint.errors import FrictionJointError
from frictionjoint.report.page import render

FILES = ("report.json", "report.html", "model.xml")


def write_report(report: Report, folder: Path, command: str) -> None:
    """Write report.json, report.html and model.xml into `folder`.

    Each file is complete before it takes its name, so that an interrupted run leaves the old
    report or none.

    Raises:
        FrictionJointError: the folder cannot be written.
    """
    contents = {
        "report.json": json.dumps(report.to_dict(), indent=2, allow_nan=False) + "\n",
        "report.html": render(report, command),
        "model.xml": report.mjcf,
    }
    write_files(folder, contents)


def write_files(folder: Path, contents: Mapping[str, str | bytes]) -> None:
    """Write files into a folder, each by renaming a finished one.

    Raises:
        FrictionJointError: the folder cannot be written; nothing new stays in it.
    """
    staging = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=".frictionjoint-", dir=folder))
        for name, text in contents.items():
            (staging / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        for name in contents:
            os.replace(staging / name, folder / name)
    except OSError as error:
        reason = error.strerror or str(error)
        raise FrictionJointError(f"{folder}: cannot write the result: {reason}") from None
    finally:
        if staging is not None:
            shutil.rmtree(staging, ignore_errors=True)
