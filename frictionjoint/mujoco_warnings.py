"""MuJoCo's warnings, as Python warnings or for code that simulates possibly unstable models.

MuJoCo itself prints them and writes them to MUJOCO_LOG.TXT in the working directory.
"""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import mujoco

_UNSTABLE = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
)


@contextmanager
def unheard() -> Iterator[list[str]]:
    """Collect MuJoCo's warnings inside the block in a list, and print nothing."""
    texts: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(texts.append)
    try:
        yield texts
    finally:
        mujoco.set_mju_user_warning(before)


@contextmanager
def as_python_warnings() -> Iterator[None]:
    """Turn MuJoCo's warnings inside the block into Python warnings after it, unless it raises."""
    with unheard() as texts:
        yield
    for text in dict.fromkeys(texts):
        warnings.warn(" ".join(text.split()), RuntimeWarning, stacklevel=4)


def became_unstable(data: mujoco.MjData) -> bool:
    """Whether MuJoCo reset the simulation to the model's own pose since `data` was reset."""
    return any(data.warning[int(kind)].number for kind in _UNSTABLE)
