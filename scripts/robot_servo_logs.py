"""A whole robot driven to its targets: every joint through the loop, then all of them at once.

    python scripts/robot_servo_logs.py LOG... --model MJCF --controller FILE|PRESET [--joint NAME]
        [--held-out LOG]... [--refine]

Each joint is explained while the others follow their measured motion, the base where the MJCF
holds it. Where the controller's torque is known, all joints then run at once in MuJoCo, from their
targets alone: as the MJCF says them, with its own friction; with `frictionloss`, `damping` and
`armature` of each joint fitted to that motion on the same logs; and with what was found. Printed is
the mean absolute position error of each joint, rad, on what was held out: the logs named, or the
last third.
"""

import argparse
import contextlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import mujoco
import numpy as np

import frictionjoint
from frictionjoint import close_loop
from frictionjoint.control import read_controller
from frictionjoint.control.block import block_of, delay_of, supply_of
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import STATE, one_tick
from frictionjoint.control.reconstruct import held
from frictionjoint.diagnose.report_data import Report
from frictionjoint.files import joint_friction
from frictionjoint.measured.log import JointLog, split_in_time
from frictionjoint.measured.readers import joints_with_drive, read_log
from frictionjoint.simulate.carrier import blocks, install

LAST = 1.0 / 3.0
STEP = 1e-3
# of the fit of MuJoCo's own friction: steps, change of a logarithm for a difference, and what a
# number that is nothing begins at
ROUNDS, CHANGE, LEAST = 5, 0.05, 1e-3


def with_friction(path: Path, reports: Mapping[str, Report]) -> mujoco.MjModel:
    """The MJCF with what was found of each joint in place of its own friction."""
    spec = mujoco.MjSpec.from_file(str(path))
    laws, effects = {}, {}
    for name, report in reports.items():
        if report.posterior is None:
            continue
        joint = spec.joint(name)
        joint.frictionloss, joint.damping = 0.0, np.zeros_like(joint.damping)
        alone = mujoco.MjModel.from_xml_string(report.mjcf)
        joint.armature = float(alone.dof_armature[alone.joint(name).dofadr[0]])
        found = joint_friction(report.posterior.content)
        laws[name], effects[name] = found.parameters, found.effects
    install(spec, laws, effects)
    return spec.compile()


def run(
    model: mujoco.MjModel, logs: Mapping[str, JointLog], controllers: Mapping[str, Controller]
) -> dict[str, np.ndarray]:
    """Position of each joint at its log's times, all joints driven at once."""
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model.opt.timestep = STEP
    data = mujoco.MjData(model)
    first = next(iter(logs.values()))
    time = np.arange(first.time[0], first.time[-1] + STEP, STEP)
    qpos = {name: int(model.joint(name).qposadr[0]) for name in logs}
    dof = {name: int(model.joint(name).dofadr[0]) for name in logs}
    numbers = {name: block_of(controllers[name], log) for name, log in logs.items()}
    states = {name: np.zeros(STATE) for name in logs}
    targets = {
        name: held(log.time, log.target, time - delay_of(controllers[name]))
        for name, log in logs.items()
    }
    supplies = {name: supply_of(controllers[name], log) for name, log in logs.items()}
    assert all(np.all(x == 1.0) for x in supplies.values()), "a supply that varies is not simulated"
    for name, log in logs.items():
        data.qpos[qpos[name]] = log.position[0]
        data.qvel[dof[name]] = (log.position[1] - log.position[0]) / (log.time[1] - log.time[0])
    found = {name: np.empty(len(time)) for name in logs}
    carries = bool(blocks(model))
    with frictionjoint.attach(model) if carries else contextlib.nullcontext():
        for k, t in enumerate(time):
            for name in logs:
                q, v = data.qpos[qpos[name]], data.qvel[dof[name]]
                found[name][k] = q
                drive = one_tick(numbers[name], states[name], t, targets[name][k], q, v)
                data.qfrc_applied[dof[name]] = drive
            mujoco.mj_step(model, data)
    return {name: np.interp(log.time, time, found[name]) for name, log in logs.items()}


def native_fitted(
    path: Path,
    logs: Sequence[Mapping[str, JointLog]],
    controllers: Mapping[str, Controller],
) -> mujoco.MjModel:
    """The MJCF with MuJoCo's own friction and armature fitted to simulated motion.

    Least squares by the logarithms of three numbers a joint. One run with a number of all joints
    changed tells how each joint's own error changes: what it changes in others is left out.
    """
    model = mujoco.MjModel.from_xml_path(str(path))
    names = list(logs[0])
    dofs = [int(model.joint(name).dofadr[0]) for name in names]
    fields = (model.dof_frictionloss, model.dof_damping, model.dof_armature)
    x = np.log(np.maximum([np.ravel(field)[dofs] for field in fields], LEAST))

    def errors_at(x: np.ndarray) -> list[np.ndarray]:
        for field, values in zip(fields, np.exp(x), strict=True):
            field.reshape(-1)[dofs] = values
        runs = [run(model, one, controllers) for one in logs]
        return [
            np.concatenate(
                [r[name] - one[name].position for r, one in zip(runs, logs, strict=True)]
            )
            for name in names
        ]

    here, damped = errors_at(x), np.ones(len(names))
    for _ in range(ROUNDS):
        slopes = []
        for k in range(len(fields)):
            moved = x.copy()
            moved[k] += CHANGE
            pairs = zip(errors_at(moved), here, strict=True)
            slopes.append([(there - own) / CHANGE for there, own in pairs])
        trial = x.copy()
        for i, e in enumerate(here):
            J = np.column_stack([slope[i] for slope in slopes])
            H = J.T @ J
            H += damped[i] * 1e-2 * np.trace(H) * np.eye(len(H))
            trial[:, i] -= np.clip(np.linalg.solve(H, J.T @ e), -1.0, 1.0)
        there = errors_at(trial)
        for i, (own, other) in enumerate(zip(here, there, strict=True)):
            better = other @ other < own @ own
            damped[i] *= 0.3 if better else 10.0
            if better:
                x[:, i] = trial[:, i]
        here = errors_at(x)
    return model


def errors(
    model: mujoco.MjModel,
    logs: Sequence[Mapping[str, JointLog]],
    controllers: Mapping[str, Controller],
) -> dict[str, float]:
    """Mean absolute error of each joint over all logs, rad."""
    total: dict[str, list[np.ndarray]] = {}
    for one in logs:
        for name, position in run(model, one, controllers).items():
            total.setdefault(name, []).append(np.abs(position - one[name].position))
    return {name: float(np.mean(np.concatenate(x))) for name, x in total.items()}


def main() -> None:
    """Explain, simulate, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("log", type=Path, nargs="+")
    parser.add_argument("--model", type=Path, required=True)
    parser.add_argument("--controller", required=True)
    parser.add_argument("--joint", action="append", help="to explain; default: all")
    parser.add_argument("--held-out", type=Path, action="append", default=[])
    parser.add_argument("--refine", action="store_true")
    asked = parser.parse_args()
    known = read_controller(asked.controller)
    names = joints_with_drive(asked.log[0])
    fit: dict[str, list[JointLog]] = {}
    kept: dict[str, list[JointLog]] = {}
    for name in names:
        whole = [read_log(path, name) for path in asked.log]
        if asked.held_out:
            fit[name], kept[name] = whole, [read_log(path, name) for path in asked.held_out]
        else:
            pairs = [split_in_time(log, LAST) for log in whole]
            fit[name], kept[name] = [a for a, _ in pairs], [b for _, b in pairs]
    reports: dict[str, Report] = {}
    print("| joint | law alone | balance | refined | taken | found | not explained |", flush=True)
    print("|---|---|---|---|---|---|---|", flush=True)
    for name in asked.joint or names:
        report = close_loop(
            fit[name], asked.model, name, kept[name], controller=known, refine=asked.refine
        )
        reports[name] = report
        loops = [f"{x.mae.held_out:.4f}" for x in report.closed_loops or ()] or ["", ""]
        refined = report.refined
        found = ", ".join(
            f"{a.effect} ({', '.join(f'{n} {x.value:.3g}' for n, x in a.parameters.items())})"
            for a in report.added
        )
        cells = [
            *(name, *loops, f"{refined.loops.mae.held_out:.4f}" if refined else ""),
            *("yes" if refined and refined.taken else "no", found),
            ", ".join(f"{variable} {share:.0%}" for variable, share in report.unexplained),
        ]
        print(f"| {' | '.join(cells)} |", flush=True)
    if known.scale_unknown:
        return  # what a torque it makes is each joint's own finding, and no torque of the MJCF's
    logs = [{name: kept[name][i] for name in names} for i in range(len(kept[names[0]]))]
    same = dict.fromkeys(names, known)
    shipped = errors(mujoco.MjModel.from_xml_path(str(asked.model)), logs, same)
    used = [{name: fit[name][i] for name in names} for i in range(len(fit[names[0]]))]
    fitted = errors(native_fitted(asked.model, used, same), logs, same)
    told = {name: (reports[name].controller if name in reports else known) for name in names}
    ours = errors(with_friction(asked.model, reports), logs, told)
    print("\n| joint, all at once | MJCF's own friction | the same fitted | found |")
    print("|---|---|---|---|")
    for name in names:
        print(f"| {name} | {shipped[name]:.4f} | {fitted[name]:.4f} | {ours[name]:.4f} |")
    mean = [float(np.mean(list(x.values()))) for x in (shipped, fitted, ours)]
    print(f"| mean | {mean[0]:.4f} | {mean[1]:.4f} | {mean[2]:.4f} |")


if __name__ == "__main__":
    main()
