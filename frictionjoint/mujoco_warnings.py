"""MuJoCo's warnings as Python's."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import mujoco


@contextmanager
def as_python_warnings() -> Iterator[None]:
    """What MuJoCo warns of inside the block is warned of after it; an error makes it idle.

    MuJoCo itself prints its warnings and writes them to MUJOCO_LOG.TXT wherever one stands.
    """
    texts: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(texts.append)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
    for text in dict.fromkeys(texts):
        warnings.warn(" ".join(text.split()), RuntimeWarning, stacklevel=4)
