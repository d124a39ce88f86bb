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
    """Write files into a folder, all of them or none, whatever ends the run meanwhile.

    They are finished in a hidden folder first. A new folder then takes its name in one step, so
    that it is whole or absent; into a folder that exists each file is moved finished.

    Raises:
        FrictionJointError: the folder cannot be written; nothing new stays in it.
    """
    staging = None
    try:
        new = not folder.exists()
        place = folder.absolute().parent if new else folder
        place.mkdir(parents=True, exist_ok=True)
        staging = Path(tempfile.mkdtemp(prefix=".frictionjoint-", dir=place))
        for name, content in contents.items():
            data = content if isinstance(content, bytes) else content.encode()
            (staging / name).write_bytes(data)
        if new:
            staging.chmod(0o777 & ~_umask())  # mkdtemp makes it private
            os.rename(staging, folder)
            return
        for name in contents:
            os.replace(staging / name, folder / name)
    except OSError as error:
        reason = error.strerror or str(error)
        raise FrictionJointError(f"{folder}: cannot write the result: {reason}") from None
    finally:
        if staging is not None:
            shutil.rmtree(staging, ignore_errors=True)


def _umask() -> int:
    mask = os.umask(0o022)
    os.umask(mask)
    return mask
