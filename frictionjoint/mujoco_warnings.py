"""MuJoCo's warnings: as Python's, or for whoever runs a simulation that may become unstable.

MuJoCo itself prints them and writes them to MUJOCO_LOG.TXT wherever one stands.
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
    """What MuJoCo warns of inside the block goes into a list and nowhere else."""
    texts: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(texts.append)
    try:
        yield texts
    finally:
        mujoco.set_mju_user_warning(before)


@contextmanager
def as_python_warnings() -> Iterator[None]:
    """What MuJoCo warns of inside the block is warned of after it; an error makes it idle."""
    with unheard() as texts:
        yield
    for text in dict.fromkeys(texts):
        warnings.warn(" ".join(text.split()), RuntimeWarning, stacklevel=4)


def became_unstable(data: mujoco.MjData) -> bool:
    """Whether MuJoCo began a simulation anew since `data` was reset, at the model's own pose."""
    return any(data.warning[int(kind)].number for kind in _UNSTABLE)
