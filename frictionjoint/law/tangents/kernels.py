"""The laws' kernels with their tangents, differentiated from the source of the laws.

The kernels that evaluate a law along a motion are defined on import and run from the compiled
library. The kernels that they call are defined only where kernels run as Python, as in translation.
"""

import linecache

from frictionjoint.compiled import PLAIN
from frictionjoint.law.tangents.drive import drives


def _define(text: str, what: str) -> None:
    file = f"<{what} of {__name__}>"
    # debuggers and the translation read the source from this cache
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    exec(compile(text, file, "exec"), globals())


_define(drives(), "drives")
if PLAIN:
    from frictionjoint.law.tangents.generate import source

    _define(source(), "kernels")
