"""A log of any length is fitted within bounded memory, and what was left out is said."""

import numpy as np
import pytest

from frictionjoint.measured.log import JointLog
from frictionjoint.measured.long_logs import MOST_ROWS, LongLogWarning, shortened


def log(n, dt=1e-3, frequency=0.5, name="long"):
    t = dt * np.arange(n)
    q = np.sin(2 * np.pi * frequency * t) + 1e-4 * np.random.default_rng(0).standard_normal(n)
    return JointLog(
        name=name,
        joint="j",
        time=t,
        position=q,
        torque=np.tanh(50 * np.cos(2 * np.pi * frequency * t)),
        torque_enabled=np.arange(n) % 100_000 != 5,
        other_positions={"k": q**2},
    )


def test_short_logs_are_left_alone():
    logs = [log(1000), log(2000)]
    assert shortened(logs) == logs


def test_finely_sampled_log_is_averaged_and_keeps_its_motion():
    long = log(4 * MOST_ROWS, dt=1e-4)
    with pytest.warns(LongLogWarning, match="long: 400000 rows .* 4 samples averaged") as warned:
        (short,) = shortened([long])
    assert len(warned) == 1
    assert len(short.time) == MOST_ROWS
    assert "4 samples averaged" in short.name
    assert short.duration == pytest.approx(long.duration, rel=1e-5)
    assert np.allclose(short.position, np.sin(np.pi * short.time), atol=5e-4)
    assert np.allclose(short.other_positions["k"], short.position**2, atol=5e-4)
    # where the drive was off for one of the averaged samples it counts as off
    assert (~short.torque_enabled).sum() == (~long.torque_enabled).sum()


def test_what_cannot_be_averaged_is_cut_and_said():
    long = log(3 * MOST_ROWS, dt=0.02, frequency=2.0)
    with pytest.warns(LongLogWarning, match=r"first \d+ s"):
        (short,) = shortened([long])
    assert len(short.time) == MOST_ROWS
    assert np.array_equal(short.position, long.position[:MOST_ROWS])


def test_several_logs_share_the_room():
    logs = [log(MOST_ROWS, name="a"), log(3 * MOST_ROWS, name="b"), log(500, name="c")]
    with pytest.warns(LongLogWarning):
        short = shortened(logs)
    assert sum(len(x.time) for x in short) <= MOST_ROWS + 1000
    assert short[2] is logs[2]
    assert len(short[1].time) > len(short[0].time)
