"""The controller inside the servo: reads the encoder, follows the target, sets the output."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

# Entries of the firmware's memory
TICKS, GOAL, READING, SPEED, OUTPUT = range(5)
MEMORY = 5


class Firmware(NamedTuple):
    """Cycle, encoder, damping gain and output stage; infinite where something is absent."""

    period: float  # of the control loop, s
    phase: float  # of its first cycle, s
    count: float  # of the encoder, rad
    kd: float  # output per rad/s
    differentiated: bool  # speed from the encoder; otherwise the joint's own
    lowpass: float  # corner of the differentiated speed, Hz
    resolution: float  # step of the output, 0 for none
    limit: float  # of the output
    delay: float  # of the target, s
    deadband: float  # no output while |error| is below it, rad
    threshold: float  # beyond this |error| the output is cut, rad
    left: float  # to this share
    rate: float  # largest speed at which the target is followed, rad/s


def plain(
    rate_hz: float,
    phase: float,
    count: float,
    kd: float,
    limit: float,
    resolution: float = 0.0,
    lowpass: float = 0.0,
) -> Firmware:
    """Firmware that does what its file says; `lowpass` > 0 differentiates the encoder."""
    return Firmware(
        period=1 / rate_hz,
        phase=phase,
        count=count,
        kd=kd,
        differentiated=lowpass > 0,
        lowpass=lowpass,
        resolution=resolution,
        limit=limit,
        delay=0.0,
        deadband=0.0,
        threshold=math.inf,
        left=1.0,
        rate=math.inf,
    )


def begin(firmware: Firmware, target: float, q: float) -> np.ndarray:
    """Memory of a firmware that has just been switched on."""
    memory = np.zeros(MEMORY)
    memory[GOAL] = target
    memory[READING] = np.round(q / firmware.count) * firmware.count
    return memory


@njit
def cycle(fw: Firmware, kp: float, memory: np.ndarray, target: float, q: float, v: float) -> None:
    """One cycle: the order is rate, error, gains, limit, duty drop, deadband, resolution."""
    travel = fw.rate * fw.period
    memory[GOAL] += min(max(target - memory[GOAL], -travel), travel)
    reading = round(q / fw.count) * fw.count
    speed = v
    if fw.differentiated:
        blend = 1.0 - math.exp(-2.0 * math.pi * fw.lowpass * fw.period)
        raw = (reading - memory[READING]) / fw.period
        speed = memory[SPEED] + blend * (raw - memory[SPEED])
    memory[READING] = reading
    memory[SPEED] = speed
    error = memory[GOAL] - reading
    output = min(max(kp * error - fw.kd * speed, -fw.limit), fw.limit)
    if abs(error) > fw.threshold:
        output *= fw.left
    if abs(error) < fw.deadband:
        output = 0.0
    if fw.resolution > 0.0:
        output = round(output / fw.resolution) * fw.resolution
    memory[OUTPUT] = output
    memory[TICKS] += 1.0
