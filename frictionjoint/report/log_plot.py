"""Drawing of a log as measured, before anything is fitted."""

import numpy as np

from frictionjoint.arrays import Array
from frictionjoint.measured.log import JointLog
from frictionjoint.measured.validate import FAR
from frictionjoint.report.charts import Chart, Colour, cloud, over_time


def log_charts(log: JointLog) -> tuple[Chart, ...]:
    """Position, velocity and drive over time, then the drive against velocity and position."""
    x, torque, newtons = ("m", "force", "N") if log.slide else ("rad", "torque", "N m")
    time = log.time - log.time[0]
    against = (("velocity", log.velocity, f"{x}/s"), ("position", log.position, x))
    tracks: tuple[tuple[str, Array | None, str, Colour], ...] = (
        ("position", log.position, x, "measured"),
        ("velocity", log.velocity, f"{x}/s", "measured"),
        (torque, log.torque, newtons, "after"),
        ("voltage", log.voltage, "V", "after"),
        ("current", log.current, "A", "after"),
        ("temperature", log.temperature, "°C", "before"),
    )
    found = []
    for name, values, unit, colour in tracks:
        if values is None:
            continue
        lines, label = [over_time("measured", time, values, colour)], f"{name}, {unit}"
        if name == "position" and log.target is not None:
            lines.append(over_time("target", time, log.target, "target"))
        found.append(Chart(name.capitalize(), "time, s", label, tuple(lines), log.name))
        for other, along, its_unit in against if colour == "after" else ():
            if along is not None:
                points = (cloud("measured", along, values, "after"),)
                title = f"{name.capitalize()} against {other}"
                found.append(Chart(title, f"{other}, {its_unit}", label, points))
    return tuple(found)


def described(log: JointLog) -> str:
    """Samples, duration, rate and range of positions of a log, in one line."""
    rate = (len(log.time) - 1) / log.duration
    low, high = float(log.position.min()), float(log.position.max())
    unit = "m" if log.slide else "rad"
    return (
        f"{log.name}, {log.joint}: {len(log.time)} samples, {log.duration:.3g} s, "
        f"{rate:.4g} Hz, position {low:.4g} to {high:.4g} {unit}"
    )


def unit_doubt(log: JointLog) -> str:
    """A hint that the positions may be in degrees, if the joint turns far or fast; else empty."""
    travel = float(np.ptp(log.position))
    steps = np.abs(np.diff(log.position)) / np.diff(log.time)
    speed = float(np.quantile(steps, 0.99))
    # a hinge beyond 60 rad/s may be in degrees too
    if log.slide or (travel < FAR and speed < 60.0):
        return ""
    return (
        f"The joint travels {travel:.3g} rad ({travel / (2.0 * np.pi):.2g} turns) at up to "
        f"{speed:.3g} rad/s. If the file is in degrees, give --unit position=deg."
    )
