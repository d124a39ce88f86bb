"""Drawing of a log as measured, before anything is fitted."""

import numpy as np

from frictionjoint.measured.log import JointLog
from frictionjoint.measured.validate import FAR
from frictionjoint.report.charts import Chart, cloud, over_time


def log_charts(log: JointLog) -> tuple[Chart, ...]:
    """Position, velocity and drive over time, then the drive against velocity and position."""
    x = "m" if log.slide else "rad"
    drives = (
        ("force" if log.slide else "torque", log.torque, "N" if log.slide else "N m"),
        ("voltage", log.voltage, "V"),
        ("current", log.current, "A"),
    )
    time = log.time - log.time[0]
    position = [over_time("measured", time, log.position, "measured")]
    if log.target is not None:
        position.append(over_time("target", time, log.target, "target"))
    found = [Chart("Position", "time, s", f"position, {x}", tuple(position), log.name)]
    if log.velocity is not None:
        line = over_time("measured", time, log.velocity, "measured")
        found.append(Chart("Velocity", "time, s", f"velocity, {x}/s", (line,), log.name))
    for name, drive, unit in drives:
        if drive is None:
            continue
        label = f"{name}, {unit}"
        line = over_time("measured", time, drive, "after")
        found.append(Chart(name.capitalize(), "time, s", label, (line,), log.name))
        against = [("position", log.position, f"position, {x}")]
        if log.velocity is not None:
            against.insert(0, ("velocity", log.velocity, f"velocity, {x}/s"))
        for other, values, axis in against:
            points = cloud("measured", values, drive, "after")
            found.append(Chart(f"{name.capitalize()} against {other}", axis, label, (points,)))
    if log.temperature is not None:
        line = over_time("measured", time, log.temperature, "before")
        found.append(Chart("Temperature", "time, s", "temperature, °C", (line,), log.name))
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
