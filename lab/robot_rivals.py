"""Measured robots next to mujoco.sysid, figaroh and trainnr: the same logs, the same samples.

    python lab/robot_rivals.py --data DIR --reports DIR [--figaroh PYTHON] [--trainnr PYTHON]
        [--write]
    python lab/robot_rivals.py --data DIR --only mujoco.sysid --limit 400

Fitted to the first 70% of the log, tested on the rest. `--reports` is the folder that
`real_robots.py` wrote. `mujoco.sysid` fits the pseudo-inertia of the last three links, and the
armature, damping and frictionloss of every joint, to positions of free runs of 0.5 s, from one
start; after `--limit` seconds of processor time the best numbers so far are taken. figaroh and
trainnr need environments of their own, whose Python `--figaroh` and `--trainnr` name; see
`figaroh_robot.py` and `trainnr_robot.py`. trainnr fits armature, damping and frictionloss to
torques below 10 Hz. Torque: rms error in motion, in per cent of the joint's, averaged over joints.
Replay: rms position error of free runs of 2 s from measured states. With `--write` the table goes
to the end of lab/notes/robots.md.
"""

import argparse
import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import sysid_robot
from real_robots import HELD_OUT, PAGE, ROBOTS, ROOT

import frictionjoint as fj
from frictionjoint.effects.signals import TIME, A, Q, V
from frictionjoint.identify.fit import IN_MOTION
from frictionjoint.identify.intervals import stated_covariance
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.rigid_body import direction
from frictionjoint.identify.weights import errors_elsewhere, weighted
from frictionjoint.robot.joint import first_fit
from frictionjoint.robot.logs import RobotLogs

COMPARED = ("ur10", "tx40")
# s: free runs that sysid fits, and those of the table
FITTED_RUN, RUN = 0.5, 2.0
STEP = 1e-3
PROGRAMS = ("frictionjoint", "mujoco.sysid", "figaroh 1.0.2", "trainnr 0.1")
TITLE = "## Beside mujoco.sysid and figaroh"


@dataclass(frozen=True)
class Case:
    """A robot's logs, as all programs are given them.

    Attributes:
        fit, held: by joint, position, velocity and acceleration of all joints at the samples kept
            for that joint, (3, n, joints). torque, measured: of that joint there.
        moving: of the samples held out. size: rms of the joint's torque.
        tracks: time, positions, velocities and torques of the part fitted and of that held out.
    """

    names: list
    fit: list
    torque: list
    held: list
    measured: list
    moving: list
    size: list
    tracks: list


def case_of(robot, data) -> Case:
    """Read and filter."""
    model = ROOT / "models" / robot.model
    logs = RobotLogs.read([data / x for x in robot.logs], [], float(HELD_OUT), model)
    found = Case(logs.joints, [], [], [], [], [], [], [])
    segments = ([], [])
    for name in logs.joints:
        joint = first_fit(logs.fit[name], model, name, None)
        body = joint.alongs[0].body
        kept_back = prepare(list(logs.held_out[name]), body, joint.prepared.band)
        cov = stated_covariance(joint.prepared, joint.fit)
        left = errors_elsewhere(joint.prepared, joint.fit, cov)
        kept_back = weighted(kept_back, joint.fit, left)
        (one,), (other,) = joint.prepared.segments, kept_back.segments
        for s, motions, torques in (
            (one, found.fit, found.torque),
            (other, found.held, found.measured),
        ):
            motions.append(np.array([motion(s, name, found.names, k) for k in range(3)]))
            torques.append(s.balanced_drive())
        found.moving.append(other.at_kept(other.weight) ** 2 > IN_MOTION)
        found.size.append(joint.fit.target_rms)
        segments[0].append(one)
        segments[1].append(other)
    for parts in segments:
        dt = max(min(s.dt for s in parts), STEP)
        t = np.arange(0.0, min(s.signals[-1, TIME] for s in parts), dt)
        columns = [
            np.column_stack([np.interp(t, s.signals[:, TIME], x(s)) for s in parts])
            for x in (lambda s: s.signals[:, Q], lambda s: s.signals[:, V], lambda s: s.drive)
        ]
        found.tracks.append((t, *columns))
    return found


def motion(segment, name, names, kind):
    """Position, velocity or acceleration of all joints, as the balance sees them, (n, joints)."""
    own = segment.signals[:, (Q, V, A)[kind]]
    key = ("position", "velocity", "acceleration")[kind]
    tracks = [own if n == name else segment.others[f"{n}.{key}"] for n in names]
    return segment.balanced(np.column_stack(tracks))


def windows(track, length):
    """Parts of a track of some seconds, one after the other."""
    t, *columns = track
    n = round(length / (t[1] - t[0]))
    edge = round(0.1 / (t[1] - t[0]))  # the filters' ends
    return [[x[a : a + n] for x in columns] for a in range(edge, len(t) - n - edge, n)]


def torque_percent(case, predicted):
    """Averaged over the joints that move in the part held out."""
    errors = [np.sqrt(np.mean((case.measured[j] - predicted[j])[case.moving[j]] ** 2))
              for j in moved(case)]  # fmt: skip
    return float(np.mean(100.0 * np.array(errors) / np.array(case.size)[moved(case)]))


def moved(case):
    """Joints that move in the part held out."""
    return [j for j, moving in enumerate(case.moving) if moving.any()]


def replayed(model, case):
    """rms over the runs held out."""
    track = case.tracks[1]
    dt = track[0][1] - track[0][0]
    at = [int(model.joint(n).qposadr[0]) for n in case.names]
    dofs = [int(model.joint(n).dofadr[0]) for n in case.names]
    model.opt.disableflags |= int(
        mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_ACTUATION
    )
    substeps = int(np.ceil(dt / STEP))
    model.opt.timestep = dt / substeps
    errors = []
    for q, v, drive in windows(track, RUN):
        data = mujoco.MjData(model)
        data.qpos[at], data.qvel[dofs] = q[0], v[0]
        for k in range(len(q) - 1):
            for i in range(substeps):
                part = i / substeps
                data.qfrc_applied[dofs] = (1.0 - part) * drive[k] + part * drive[k + 1]
                mujoco.mj_step(model, data)
            errors.append(data.qpos[at] - q[k + 1])
    return float(np.sqrt(np.mean(np.square(errors))))


def by_sysid(robot, case, limit):
    """Fitted to free runs of the part fitted."""
    t, pieces = case.tracks[0][0], windows(case.tracks[0], FITTED_RUN)
    file = ROOT / "models" / robot.model
    model, seconds = sysid_robot.fitted(file, case.names, case.size, pieces, t[1] - t[0], limit)
    return torque_percent(case, inverse(model, case)), replayed(model, case), seconds


def inverse(model, case):
    """Torque of each joint by inverse dynamics, its frictionloss along the direction of motion."""
    loss = model.dof_frictionloss.copy()
    model.dof_frictionloss[:] = 0.0
    data, found = mujoco.MjData(model), []
    dofs = [int(model.joint(n).dofadr[0]) for n in case.names]
    for j, (q, v, a) in enumerate(case.held):
        torque = np.zeros(len(q))
        for k in range(len(q)):
            data.qpos[dofs], data.qvel[dofs], data.qacc[dofs] = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            torque[k] = data.qfrc_inverse[dofs[j]]
        found.append(torque + loss[dofs[j]] * direction(v[:, j]))
    model.dof_frictionloss[:] = loss
    return found


def by_figaroh(robot, case, python):
    """In its own environment."""
    given = {"model": str(ROOT / "models" / robot.model)}
    for j in range(len(case.names)):
        given |= {f"fit{j}": case.fit[j], f"torque{j}": case.torque[j], f"held{j}": case.held[j]}
    pieces = windows(case.tracks[1], RUN)
    t = case.tracks[1][0]
    given |= {"windows": len(pieces), "dt": t[1] - t[0]}
    for w, piece in enumerate(pieces):
        given |= {f"{key}{w}": x for key, x in zip(("q", "v", "drive"), piece, strict=True)}
    found = elsewhere("figaroh_robot.py", python, given)
    predicted = [found[f"predicted{j}"] for j in range(len(case.names))]
    errors = [found[f"run{w}"][1:] - piece[0][1:] for w, piece in enumerate(pieces)]
    replay = float(np.sqrt(np.mean(np.square(np.concatenate(errors)))))
    return torque_percent(case, predicted), replay, float(found["seconds"])


def by_trainnr(robot, case, python):
    """In its own environment; its terms run in MuJoCo here."""
    file = ROOT / "models" / robot.model
    t, q, v, drive = case.tracks[0]
    given = {"model": str(file), "names": case.names, "time": t, "position": q, "velocity": v}
    given |= {"acceleration": np.gradient(v, t, axis=0), "torque": drive}
    found = elsewhere(
        "trainnr_robot.py", python, given | {f"held{j}": x for j, x in enumerate(case.held)}
    )
    model = mujoco.MjModel.from_xml_path(str(file))
    for name, terms in zip(case.names, found["terms"], strict=True):
        dof = int(model.joint(name).dofadr[0])
        model.dof_armature[dof], model.dof_frictionloss[dof] = terms[0], terms[2]
        damping = np.zeros_like(model.dof_damping[dof])  # a polynomial in newer versions
        damping.flat[0] = terms[1]
        model.dof_damping[dof] = damping
    predicted = [found[f"predicted{j}"] for j in range(len(case.names))]
    return torque_percent(case, predicted), replayed(model, case), float(found["seconds"])


def elsewhere(script, python, given):
    """What a script next to this one computes with another Python: arrays in, arrays out."""
    with tempfile.TemporaryDirectory() as folder:
        one, other = Path(folder) / "in.npz", Path(folder) / "out.npz"
        np.savez(one, **given)
        subprocess.run([python, str(Path(__file__).with_name(script)), one, other], check=True)
        return dict(np.load(other))


def by_frictionjoint(case, folder):
    """From the report."""
    report = json.loads((folder / "report.json").read_text())
    model = fj.load_model(folder / "model.xml")
    with fj.attach(model):
        replay = replayed(model, case)
    seconds = json.loads((folder / "spent.json").read_text())["cpu_s"]
    # over the rms of the part fitted, as of the other programs
    left = [report["joints"][case.names[j]]["after"]["torque_rms"]["held_out"] for j in moved(case)]
    percent = float(np.mean(100.0 * np.array(left) / np.array(case.size)[moved(case)]))
    return percent, replay, seconds


def by_program(program, name, case, asked):
    """Torque error, replay and seconds of one of them."""
    if program == "frictionjoint":
        return by_frictionjoint(case, asked.reports / name)
    if program == "mujoco.sysid":
        return by_sysid(ROBOTS[name], case, asked.limit)
    if program == "trainnr 0.1":
        return by_trainnr(ROBOTS[name], case, asked.trainnr)
    return by_figaroh(ROBOTS[name], case, asked.figaroh)


def installed(asked):
    """Programs whose environment is named, and those of this one."""
    absent = {PROGRAMS[2]: not asked.figaroh, PROGRAMS[3]: not asked.trainnr}
    return [p for p in PROGRAMS if not absent.get(p)]


def table(asked) -> str:
    """All programs on all robots."""
    lines = ["| robot | program | torque held out | replay over 2 s, rad | s |"]
    lines.append("|---|---|---|---|---|")
    for name in asked.robot or COMPARED:
        case = case_of(ROBOTS[name], asked.data)
        for program in asked.only or installed(asked):
            torque, replay, seconds = by_program(program, name, case, asked)
            error = "diverges" if not replay < 10.0 else f"{replay:.2g}"
            lines.append(f"| {name} | {program} | {torque:.1f}% | {error} | {seconds:.0f} |")
            print(lines[-1], flush=True)
    return "\n".join(lines)


def main() -> None:
    """Compute, print, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--reports", type=Path)
    parser.add_argument("--robot", action="append", choices=COMPARED)
    parser.add_argument("--only", action="append", choices=PROGRAMS)
    parser.add_argument("--limit", type=float, default=400.0, help="s of sysid's, of one processor")
    parser.add_argument("--figaroh", help="Python of an environment that has figaroh")
    parser.add_argument("--trainnr", help="Python of an environment that has trainnr")
    parser.add_argument("--write", action="store_true", help=f"write to {PAGE}")
    asked = parser.parse_args()
    text = table(asked)
    if asked.write:
        page = ROOT / PAGE
        before = page.read_text().partition(TITLE)[0].rstrip()
        about = "\n".join(__doc__.splitlines()[4:])
        page.write_text(f"{before}\n\n{TITLE}\n{about}\n\n{text}\n")


if __name__ == "__main__":
    main()
