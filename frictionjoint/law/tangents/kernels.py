"""The laws' kernels with their tangents, differentiated from the source of the laws.

The kernels that evaluate a law along a motion are defined on import and run from the compiled
library. The kernels that they call are defined only if kernels run as Python, as during
translation, or if they are requested by name.
"""

import linecache
from typing import Any

from frictionjoint.compiled import PLAIN
from frictionjoint.law.tangents.drive import drives


def _define(text: str, what: str) -> None:
    file = f"<{what} of {__name__}>"
    # debuggers and the translation read the source from this cache
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    exec(compile(text, file, "exec"), globals())


def _define_all() -> None:
    from frictionjoint.law.tangents.generate import source

    _define(source(), "kernels")


def __getattr__(name: str) -> Any:
    if name.startswith("__") or "drive_static" not in globals():
        raise AttributeError(name)
    _define_all()
    return globals()[name]


_define(drives(), "drives")
if PLAIN:
    _define_all()
