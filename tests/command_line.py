"""The command line called in this process: as `test_cli.started`, without a new Python."""

import contextlib
import io
import signal
import sys
import warnings
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from frictionjoint.cli import main


@dataclass(frozen=True)
class Done:
    """How a command ended and what it said."""

    returncode: int
    stdout: str
    stderr: str


def run(*arguments: object, cwd: Path) -> Done:
    """``frictionjoint ARGUMENTS`` in a folder."""
    out, err = io.StringIO(), io.StringIO()
    terminated = signal.getsignal(signal.SIGTERM)
    words = ["frictionjoint", *map(str, arguments)]
    try:
        with (
            contextlib.chdir(cwd),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            warnings.catch_warnings(),
            mock.patch.object(sys, "argv", words),
        ):
            warnings.simplefilter("default")
            main()
    except SystemExit as ended:
        return Done(int(ended.code or 0), out.getvalue(), err.getvalue())
    finally:
        signal.signal(signal.SIGTERM, terminated)
    raise AssertionError("main always ends with SystemExit")
