"""The library of motors before and after a regeneration: errors, law, stiffness, rest.

    python lab/motor_library.py FOLDER

FOLDER holds the files frictionjoint/motors/*.toml of another commit. Every motor carries a load of
0.4 of its slow sliding friction, which rises within a second and stays, with an inertia of
0.5 kg m² (0.5 kg on a slide) and with its own inertia in the model it was identified with. "Moves"
is how far the position goes within 30 s that begin 10 s after the load is full, rad (m).
"""

import argparse
from pathlib import Path

import mujoco
import numpy as np

from frictionjoint.law.motion import friction_torque
from frictionjoint.motors.library import Motor, list_motors
from frictionjoint.simulate.attach import attach
from frictionjoint.simulate.carrier import install

MODELS = Path(__file__).resolve().parents[1] / "models"
STEP, SHARE = 1e-3, 0.4


def own_inertia(motor: Motor) -> float:
    """Of a motor's joint in its own model with the others free to move along, kg m² (kg)."""
    model = mujoco.MjModel.from_xml_path(str(MODELS / motor.model))
    return 1.0 / float(model.dof_invweight0[model.joint(motor.joint).dofadr[0]])


def moves(motor: Motor, inertia: float) -> float:
    """How far a loaded joint moves within 30 s, rad (m)."""
    spec = mujoco.MjSpec.from_string(
        f"<mujoco><option timestep='{STEP}' integrator='implicitfast' gravity='0 0 0'/><worldbody>"
        f"<body><joint name='j' type='{'slide' if motor.unit == 'N' else 'hinge'}'/>"
        f"<inertial pos='0 0 0' mass='{inertia}' diaginertia='{inertia} {inertia} {inertia}'/>"
        "</body></worldbody></mujoco>"
    )
    law = motor.friction.parameters
    install(spec, {"j": law})
    model = spec.compile()
    data = mujoco.MjData(model)
    time = np.linspace(0.0, 20.0, 20_001)
    load = SHARE * float(friction_torque(law, time, 0.01 * time)[-1])
    places = []
    with attach(model):
        for k in range(41_000):
            data.qfrc_applied[0] = load * min(1.0, k * STEP)
            mujoco.mj_step(model, data)
            if k >= 11_000:
                places.append(float(data.qpos[0]))
    return max(places) - min(places)


def row(motor: Motor) -> list[str]:
    """What the table says of one motor."""
    law, fit = motor.friction.parameters, motor.fit
    kinds = ("torque_held_out", "replay_held_out", "closed_loop_held_out")
    left = [f"{fit[kind]:.4g}" if kind in fit else "" for kind in kinds]
    rest = [f"{moves(motor, inertia):.1g}" for inertia in (0.5, own_inertia(motor))]
    return [law.law, f"{law.stiffness:.3g}", *left, *rest]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old", type=Path)
    asked = parser.parse_args()
    old = {motor.name: row(motor) for motor in list_motors(asked.old)}
    heads = ("law", "stiffness", "torque", "replay", "loop", "moves, 0.5", "moves, own")
    print("| motor | " + " | ".join(heads) + " |\n|" + "---|" * (len(heads) + 1))
    for motor in list_motors():
        pairs = zip(old[motor.name], row(motor), strict=True)
        cells = [a if a == b else f"{a} to {b}" for a, b in pairs]
        print(f"| `{motor.name}` | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
