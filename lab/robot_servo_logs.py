"""A whole robot driven to its targets: every joint through the loop, then all of them at once.

    python lab/robot_servo_logs.py LOG... --model MJCF --controller FILE|PRESET
        [--joint NAME]... [--names LOG=MJCF]... [--until LOG=S]... [--held-out LOG]... [--no-refine]

The MJCF is read without its meshes and with its base held, so that Menagerie's file alone will do
(github.com/google-deepmind/mujoco_menagerie, for instance `unitree_go2/go2.xml` and
`robotstudio_so101/so101.xml`); --names says how a log's joint is called there. Each joint is
explained while the others follow their measured motion. All joints then run at once in MuJoCo, from
their targets alone: as the MJCF says them, with its own friction; with `frictionloss`, `damping`
and `armature` of each joint fitted to that motion on the same logs; and with what was found. Where
kp is not known, the MJCF's own position actuators drive it, and their kp is fitted too. Printed is
the mean absolute position error of each joint, rad, on what was held out: the logs named, or the
last third. --until leaves out what a log holds after some time.
"""

import argparse
import contextlib
import tempfile
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np

import frictionjoint
from frictionjoint import close_loop
from frictionjoint.control import read_controller
from frictionjoint.control.controller import Controller
from frictionjoint.control.kernel import STATE, tick
from frictionjoint.control.kernel_numbers import block_of, delay_of, supply_of
from frictionjoint.control.profile import held
from frictionjoint.files import joint_friction
from frictionjoint.measured.log import JointLog, split_in_time
from frictionjoint.measured.readers import joints_with_drive, read_log
from frictionjoint.report.joint_report import Report
from frictionjoint.simulate.block import blocks
from frictionjoint.simulate.carrier import install
from frictionjoint.simulate.motor import Motor, add_motor

LAST = 1.0 / 3.0
STEP = 1e-3
# of the fit of MuJoCo's own friction: steps, change of a logarithm for a difference, and what a
# number that is nothing begins at
ROUNDS, CHANGE, LEAST = 8, 0.05, 1e-3
# of the MJCF's kp, the second start
SOFT = 0.02
# of one joint at its log's times, by name
Positions = dict[str, np.ndarray]


def without_meshes(path: Path, names: Mapping[str, str]) -> mujoco.MjSpec:
    """An MJCF without meshes and free joints, its joints called as the logs have them."""
    spec = mujoco.MjSpec.from_file(str(path))
    for geom in list(spec.geoms):
        if geom.type == mujoco.mjtGeom.mjGEOM_MESH:
            spec.delete(geom)
    for mesh in list(spec.meshes):
        spec.delete(mesh)
    for joint in list(spec.joints):
        if joint.type == mujoco.mjtJoint.mjJNT_FREE:
            spec.delete(joint)
            for key in list(spec.keys):
                spec.delete(key)
    for ours, theirs in names.items():
        spec.joint(theirs).name = ours
        for actuator in spec.actuators:
            if actuator.target == theirs:
                actuator.target = ours
    return spec


def with_friction(path: Path, reports: Mapping[str, Report]) -> mujoco.MjModel:
    """The MJCF with what was found of each joint in place of its own friction."""
    spec = mujoco.MjSpec.from_file(str(path))
    for actuator in list(spec.actuators):
        spec.delete(actuator)
    laws, effects = {}, {}
    for name, report in reports.items():
        if report.posterior is None:
            continue
        joint = spec.joint(name)
        joint.frictionloss, joint.damping = 0.0, np.zeros_like(joint.damping)
        alone = mujoco.MjModel.from_xml_string(report.mjcf)
        joint.armature = float(alone.dof_armature[alone.joint(name).dofadr[0]])
        motor = mujoco.mj_name2id(alone, mujoco.mjtObj.mjOBJ_ACTUATOR, f"{name}_voltage")
        if motor >= 0:
            gain, back_emf = alone.actuator_gainprm[motor, 0], -alone.actuator_biasprm[motor, 2]
            add_motor(spec, name, Motor(float(gain), float(back_emf)))
        found = joint_friction(report.posterior.content)
        laws[name], effects[name] = found.parameters, found.effects
    install(spec, laws, effects)
    return spec.compile()


def run(
    model: mujoco.MjModel, logs: Mapping[str, JointLog], controllers: Mapping[str, Controller]
) -> Positions:
    """Position of each joint at its log's times, all joints driven at once."""
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model.opt.timestep = STEP
    # a motor's back-EMF may well brake more than a step of Euler's bears
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
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
    motors = {
        name: mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, f"{name}_voltage")
        for name in logs
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
                drive = tick(numbers[name], states[name], t, targets[name][k], q, v, 1.0)
                if motors[name] < 0:
                    data.qfrc_applied[dof[name]] = drive
                else:
                    data.ctrl[motors[name]] = drive
            mujoco.mj_step(model, data)
    return {name: np.interp(log.time, time, found[name]) for name, log in logs.items()}


def run_actuators(model: mujoco.MjModel, logs: Mapping[str, JointLog]) -> Positions:
    """The same with the MJCF's own position actuators."""
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    model.opt.timestep = STEP
    data = mujoco.MjData(model)
    first = next(iter(logs.values()))
    time = np.arange(first.time[0], first.time[-1] + STEP, STEP)
    ctrl = np.zeros((1, len(time), model.nu))
    for name, log in logs.items():
        data.qpos[int(model.joint(name).qposadr[0])] = log.position[0]
        speed = (log.position[1] - log.position[0]) / (log.time[1] - log.time[0])
        data.qvel[int(model.joint(name).dofadr[0])] = speed
        ctrl[0, :, actuator_of(model, name)] = held(log.time, log.target, time)
    state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    states, _ = mujoco.rollout.rollout(model, data, state[None], ctrl)
    found = {}
    for name, log in logs.items():
        q = states[0, :, 1 + int(model.joint(name).qposadr[0])]
        found[name] = np.interp(log.time, time, np.concatenate([[log.position[0]], q[:-1]]))
    return found


def actuator_of(model: mujoco.MjModel, name: str) -> int:
    """The actuator of a joint."""
    return int(np.flatnonzero(model.actuator_trnid[:, 0] == model.joint(name).id)[0])


Run = Callable[[mujoco.MjModel, Mapping[str, JointLog]], Positions]


def native_fitted(
    path: Path, logs: Sequence[Mapping[str, JointLog]], run: Run, actuators: bool
) -> mujoco.MjModel:
    """The MJCF with MuJoCo's own friction and armature fitted to simulated motion.

    Least squares by the logarithms of three numbers a joint, or four with the actuator's kp. One
    run with a number of all joints changed tells how each joint's own error changes: what it
    changes in others is left out.
    """
    model = mujoco.MjModel.from_xml_path(str(path))
    names = list(logs[0])
    dofs = [int(model.joint(name).dofadr[0]) for name in names]
    fields = [model.dof_frictionloss, model.dof_damping, model.dof_armature]
    begin = [np.ravel(field)[dofs] for field in fields]
    at = [actuator_of(model, name) for name in names] if actuators else []
    if at:
        begin[1] = begin[1] - model.actuator_biasprm[at, 2]
        model.actuator_biasprm[at, 2] = 0.0
        begin.append(model.actuator_gainprm[at, 0])
    starts = [np.log(np.maximum(begin, LEAST))]
    if at:  # far too stiff, a drive moves alike whatever its kp: a soft one too
        starts.append(starts[0].copy())
        starts[1][3] += np.log(SOFT)

    def errors_at(x: np.ndarray) -> list[np.ndarray]:
        for field, values in zip(fields, np.exp(x), strict=False):
            field.reshape(-1)[dofs] = values
        if at:
            model.actuator_gainprm[at, 0] = np.exp(x[3])
            model.actuator_biasprm[at, 1] = -np.exp(x[3])
        runs = [run(model, one) for one in logs]
        return [
            np.concatenate(
                [r[name] - one[name].position for r, one in zip(runs, logs, strict=True)]
            )
            for name in names
        ]

    ends = [_descended(errors_at, x) for x in starts]
    x = ends[0][0]
    for other, e in ends[1:]:
        for i, (own, there) in enumerate(zip(ends[0][1], e, strict=True)):
            if there @ there < own @ own:
                x[:, i] = other[:, i]
    errors_at(x)
    return model


def _descended(
    errors_at: Callable[[np.ndarray], list[np.ndarray]], x: np.ndarray
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Numbers of each joint at its least squares nearby, shape (numbers, joints), and errors."""
    here, damped = errors_at(x), np.ones(x.shape[1])
    for _ in range(ROUNDS):
        slopes = []
        for k in range(len(x)):
            moved = x.copy()
            moved[k] += CHANGE
            both = zip(errors_at(moved), here, strict=True)
            slopes.append([(there - own) / CHANGE for there, own in both])
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
    return x, here


def errors(
    model: mujoco.MjModel, logs: Sequence[Mapping[str, JointLog]], run: Run
) -> dict[str, float]:
    """Mean absolute error of each joint over all logs, rad."""
    total: dict[str, list[np.ndarray]] = {}
    for one in logs:
        for name, position in run(model, one).items():
            total.setdefault(name, []).append(np.abs(position - one[name].position))
    return {name: float(np.mean(np.concatenate(x))) for name, x in total.items()}


def pairs(texts: Sequence[str]) -> dict[str, str]:
    """Arguments of the form NAME=VALUE."""
    return dict(text.split("=", 1) for text in texts)


def main() -> None:
    """Explain, simulate, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("log", type=Path, nargs="+")
    parser.add_argument("--model", type=Path, required=True)
    parser.add_argument("--controller", required=True)
    parser.add_argument("--joint", action="append", help="to explain; default: all")
    parser.add_argument("--held-out", type=Path, action="append", default=[])
    parser.add_argument("--no-refine", action="store_true")
    parser.add_argument("--names", action="append", default=[], metavar="LOG=MJCF")
    parser.add_argument("--until", action="append", default=[], metavar="LOG=S")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.xml"
        path.write_text(without_meshes(asked.model, pairs(asked.names)).to_xml())
        explain(asked, path)


def explain(asked: argparse.Namespace, path: Path) -> None:
    """The same on the MJCF as it is used."""
    ends = {name: float(s) for name, s in pairs(asked.until).items()}

    def read(log: Path, joint: str) -> JointLog:
        found = read_log(log, joint)
        if log.stem not in ends:
            return found
        return split_in_time(found, 1.0 - ends[log.stem] / found.duration)[0]

    known = read_controller(asked.controller)
    names = joints_with_drive(asked.log[0])
    fit: dict[str, list[JointLog]] = {}
    kept: dict[str, list[JointLog]] = {}
    for name in names:
        whole = [read(log, name) for log in asked.log]
        if asked.held_out:
            fit[name], kept[name] = whole, [read(log, name) for log in asked.held_out]
        else:
            parts = [split_in_time(log, LAST) for log in whole]
            fit[name], kept[name] = [a for a, _ in parts], [b for _, b in parts]
    reports: dict[str, Report] = {}
    print("| joint | law alone | balance | refined | taken | found | not explained |", flush=True)
    print("|---|---|---|---|---|---|---|", flush=True)
    for name in asked.joint or names:
        report = close_loop(
            fit[name], path, name, kept[name], controller=known, refine=not asked.no_refine
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
    logs = [{name: kept[name][i] for name in names} for i in range(len(kept[names[0]]))]
    used = [{name: fit[name][i] for name in names} for i in range(len(fit[names[0]]))]
    own: Run = run_actuators
    scale_unknown = known.kp == "unknown" or known.output != "torque_nm"
    if not scale_unknown:
        own = partial(run, controllers=dict.fromkeys(names, known))
    shipped = errors(mujoco.MjModel.from_xml_path(str(path)), logs, own)
    fitted = errors(native_fitted(path, used, own, scale_unknown), logs, own)
    told = {name: (reports[name].controller if name in reports else known) for name in names}
    ours = errors(with_friction(path, reports), logs, partial(run, controllers=told))
    print("\n| joint, all at once | MJCF's own friction | the same fitted | found |")
    print("|---|---|---|---|")
    for name in names:
        print(f"| {name} | {shipped[name]:.4f} | {fitted[name]:.4f} | {ours[name]:.4f} |")
    mean = [float(np.mean(list(x.values()))) for x in (shipped, fitted, ours)]
    print(f"| mean | {mean[0]:.4f} | {mean[1]:.4f} | {mean[2]:.4f} |")


if __name__ == "__main__":
    main()
