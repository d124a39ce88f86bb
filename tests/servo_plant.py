"""A servo in MuJoCo with MuJoCo's own friction, its firmware written here."""

import math

import mujoco
import numpy as np

from frictionjoint.control import Controller
from frictionjoint.measured.log import JointLog

# s: of the plant, and of its firmware
PLANT_STEP, TICK = 1e-4, 1e-3
PLANT = """<mujoco><option timestep="0.001" integrator="implicitfast"/><compiler angle="radian"/>
<worldbody><body><joint name="j" axis="0 -1 0" armature="0.01" {}/>
<inertial pos="0 0 -0.15" mass="0.8" diaginertia="1e-4 1e-4 1e-4"/></body></worldbody></mujoco>"""
COUNT = 2 * math.pi / 4096
KT, EMF, SUPPLY = 0.4, 0.9, 12.0
KNOWN = Controller(output="duty", kp="log:kp", supply_v=SUPPLY, limit=1.0, count_rad=COUNT)


def steps(t):
    return 0.9 * (np.floor(t / 1.1) % 2) - 0.3


def sines(t):
    return 0.7 * np.sin(2.1 * t) + 0.4 * np.sin(6.3 * t)


def swept(t):
    return 0.8 * np.sin(0.9 * t**2)


def servo(name, kp, target, hidden, duration=5.0, friction='frictionloss="0.06" damping="0.03"'):
    """A log at 100 Hz; `hidden` is what its firmware does that no file says.

    Args:
        friction: attributes of the joint, MuJoCo's own.
    """
    time = 0.01 * np.arange(round(duration * 100))
    command = target(time)  # sent a hundred times a second
    position = moved(command, kp, hidden, friction)
    return JointLog(
        name=name,
        joint="j",
        time=time,
        position=np.round(position / COUNT) * COUNT,
        target=command,
        metadata={"kp": kp},
    )


def moved(command, kp, hidden, friction, start=(0.0, 0.0), step=PLANT_STEP):
    """Position of the servo at each of its commands, a hundredth of a second apart, rad.

    The firmware works a thousand times a second; the plant steps so finely that no integrator
    shows: a torque b v taken a step h early or late is an inertia of h b less or more.

    Args:
        start: position and velocity at first. step: s, of the plant, a part of `TICK`.
    """
    model = mujoco.MjModel.from_xml_string(PLANT.format(friction))
    model.opt.timestep = step
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = start
    n = 10 * len(command)
    late = round(1000 * hidden.get("delay", 0.0))
    emf = hidden.get("emf", EMF)
    # a supply with a resistance, over the winding's, that bears duty times the motor's current
    sag = hidden.get("sag", 0.0)
    waves = hidden.get("waves", {})  # N m, by their number per turn
    position, inner = np.empty(n), command[0]
    for i in range(n):
        position[i] = data.qpos[0]
        seen = round(data.qpos[0] / COUNT) * COUNT
        wanted = command[max(0, i - late) // 10]
        way = hidden.get("rate", math.inf) * TICK
        inner += min(way, max(-way, wanted - inner))
        error = inner - seen
        duty = kp * hidden.get("factor", 1.0) * error
        if abs(error) < hidden.get("deadband", 0.0):
            duty = 0.0
        limit = hidden.get("limit", 1.0)
        duty = min(limit, max(-limit, duty))
        if abs(error) > hidden.get("threshold", math.inf):
            duty *= hidden["left"]
        for _ in range(round(TICK / step)):
            volts = SUPPLY + sag * duty * emf / KT * data.qvel[0]
            volts /= 1.0 + sag * duty * duty
            data.qfrc_applied[0] = KT * duty * volts - emf * data.qvel[0]
            for number, size in waves.items():
                data.qfrc_applied[0] += size * math.sin(number * data.qpos[0])
            mujoco.mj_step(model, data)
    return position[::10]


def logs(hidden, **other):
    """Six logs, of three targets at two gains; `other` is what else `servo` takes."""
    motions = (steps, sines, swept)
    return [
        servo(f"{m.__name__} {kp}", kp, m, hidden, **other) for kp in (0.8, 3.0) for m in motions
    ]
