"""Public logs of motors, from clones of their repositories to the columns that the package reads.

    python lab/motor_logs.py --clones DIR --out DATA [--only damiao]

DIR holds one clone (a bare one suffices) per repository, named as in `REPOSITORIES` below; files
are read at the commit named there. `scripts/make_motors.py --data DATA` then identifies from them.
"""

import argparse
import io
import json
import subprocess
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.io import loadmat

from frictionjoint.arrays import Array

REPOSITORIES = {
    "damiao": (
        "YIZHIXIAOCANGSHU/Friction-Identification-for-Manipulators",
        "f915751262ab6c43dc436b7395f41b03f2e8ee2b",
    ),
    "ur10e": ("shamilmamedov/dynamic_calibration", "11af40e7deb758ec080a175fed8fcdd6c99aca29"),
    "ak80": (
        "dfki-ric-underactuated-lab/double_pendulum",
        "1e8544e67f3da72a51ee52fbbb278e131ce2a43f",
    ),
    "sts3250": ("kscalelabs/sysid", "addeb83"),
    "kinova": ("HBRS-SDP/joint-friction-model", "bf1c8d87f6d76a1629a9918ae8ff66a921096202"),
    "ri50": ("karthikurs/actuator-dynamometer", "1ab6e56f6f9dbedd90398ccdfc05a4728ed38e03"),
    "odrive": ("gchenfc/ODrive", "54611550"),
    "fr3": (
        "shubhamsonkar01/franka_ros2_teleop_data_collection",
        "1c62aa8d39565907439c7a4e4051c163c2ba5b37",
    ),
}
# N m/A: target moment over target current of the robot's controller, joints 2 to 5 as they rest in
# ur-20_01_22-joint_1 (residual 0.03 to 2%); joint 1 is of the size of 2, joint 6 of that of 4 and 5
UR10E_GAINS = (11.976, 11.976, 9.839, 10.764, 10.733, 10.75)
DAMIAO_JOINTS = ("second", "third", "fourth", "fifth", "sixth", "sixthoutput", "seventh")


class Clone:
    """Files of a repository at one commit."""

    def __init__(self, folder: Path, name: str) -> None:
        self.repository, self.commit = REPOSITORIES[name]
        self.folder = folder / self.repository.replace("/", "+")

    def names(self, folder: str) -> list[str]:
        """Paths of the files below a folder."""
        return self._git("ls-tree", "-r", "--name-only", self.commit, folder).decode().split("\n")

    def read(self, path: str) -> bytes:
        """A file's content."""
        return self._git("show", f"{self.commit}:{path}")

    def _git(self, *asked: str) -> bytes:
        return subprocess.run(
            ["git", "-C", str(self.folder), *asked], check=True, capture_output=True
        ).stdout


def write(path: Path, columns: Mapping[str, Array]) -> None:
    """A CSV file with nine digits per number."""
    path.parent.mkdir(parents=True, exist_ok=True)
    table = np.column_stack(list(columns.values()))
    np.savetxt(path, table, "%.9g", ",", header=",".join(columns), comments="")


def news(time: Array, readings: Array) -> Array:
    """Rows without repeats of a motor's last message; one that rests is kept every 30 ms.

    Args:
        readings: shape (n, k), the position first.
    """
    fresh = np.flatnonzero(np.r_[True, (np.diff(readings, axis=0) != 0.0).any(axis=1)])
    kept = [fresh]
    for i, j in pairwise(fresh):
        if readings[i, 0] == readings[j, 0]:
            rest = np.arange(time[i] + 0.03, time[j] - 0.01, 0.03)
            kept.append(np.searchsorted(time, rest))
    return np.unique(np.concatenate(kept))


def damiao(clone: Clone, out: Path) -> None:
    """An arm of seven Damiao motors; in each recording one joint moves, the others hold still."""
    for i, name in enumerate(DAMIAO_JOINTS):
        # two of the seven raw recordings are larger than what some mirrors keep
        path = f"results/real_friction_identification_joint_{i + 1}.npz"
        with np.load(io.BytesIO(clone.read(path))) as log:
            own = np.column_stack([log[key][:, i] for key in ("q", "qd", "tau_measured")])
            new = news(log["time"], own)
            if i == 0:  # it rests before and after
                new = new[np.abs(log["time"][new] - log["time"][0] - 50.0) < 30.0]
            columns = {"time_s": log["time"][new] - log["time"][0]}
            for j, other in enumerate(DAMIAO_JOINTS):
                columns[f"{other}.position_rad"] = log["q"][new, j]
            columns[f"{name}.velocity_rad_s"] = log["qd"][new, i]
            columns[f"{name}.torque_nm"] = log["tau_measured"][new, i]
        write(out / f"joint_{i + 1}.csv", columns)


def ur10e(clone: Clone, out: Path) -> None:
    """Exciting motions of a UR10e at 100 Hz: motor current times the controller's own constants."""
    for name in ("20_02_12-40sec_12harm", "20_01_31-unload"):
        text = clone.read(f"dataset_ur10e/identification_data/ur-{name}.csv")
        rows = np.loadtxt(io.BytesIO(text), delimiter=",")
        columns = {"time_s": rows[:, 0] - rows[0, 0]}
        for j, gain in enumerate(UR10E_GAINS):
            columns[f"j{j + 1}.position_rad"] = rows[:, 1 + j]
            columns[f"j{j + 1}.velocity_rad_s"] = rows[:, 7 + j]
            columns[f"j{j + 1}.torque_nm"] = gain * rows[:, 13 + j]
        write(out / f"{name}.csv", columns)


def ak80(clone: Clone, out: Path) -> None:
    """A double pendulum with a T-Motor AK80-6 at each joint, 500 Hz."""
    for i in range(6):
        text = clone.read(
            f"data/experiment_records/design_A.0/20220815/sys_id/trajectory_{i:02d}.csv"
        )
        rows = np.genfromtxt(io.BytesIO(text), delimiter=",", names=True)
        columns = {"time_s": rows["time"]}
        for j in (1, 2):
            columns[f"joint{j}.position_rad"] = rows[f"pos_meas{j}"]
            columns[f"joint{j}.velocity_rad_s"] = rows[f"vel_meas{j}"]
            columns[f"joint{j}.torque_nm"] = rows[f"tau_meas{j}"]
        write(out / f"trajectory_{i:02d}.csv", columns)


def sts3250(clone: Clone, out: Path) -> None:
    """The second servo of the STS3215's test bench: two of its eight loads, the first repeats."""
    out.mkdir(parents=True, exist_ok=True)
    for path in clone.names("data/feetech/STS_3250/raw"):
        if not path.endswith(".json"):
            continue
        text = clone.read(path)
        log = json.loads(text)
        load = (log["mass"], log["length"])
        if load not in ((0.535, 0.1), (0.969, 0.15)) or log["kp"] not in (4, 8, 16, 32):
            continue
        name = f"m{load[0]}_l{load[1]}_kp{log['kp']}_{log['trajectory']}.json"
        if not (out / name).exists():
            (out / name).write_bytes(text)


def kinova(clone: Clone, out: Path) -> None:
    """Joint 7 of a Kinova Gen3 at ten constant speeds, 999 Hz; 7.6 N m/A as in their settings."""
    for speed in (0.03, 0.05, 0.09, 0.1, 0.3, 0.5, 0.7, 0.9, 1.3, 1.5):
        text = clone.read(f"data/velocity_{speed:.6f}readings.csv")
        rows = np.genfromtxt(io.BytesIO(text), usecols=range(6))
        columns = {"time_s": np.arange(len(rows)) / 999.0}
        columns["joint_7.position_rad"] = np.unwrap(rows[:, 1])
        columns["joint_7.velocity_rad_s"] = rows[:, 2]
        columns["joint_7.torque_nm"] = 7.6 * rows[:, 5]
        write(out / f"speed_{speed:g}.csv", columns)


def ri50(clone: Clone, out: Path) -> None:
    """A T-Motor RI50 on a dynamometer: its own torque less what the torque sensor passes on."""
    text = clone.read("futek_data/futek_test_27_04_2021_17-39-20.csv").decode()
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    column = dict(zip(lines[0].split(","), np.genfromtxt(lines[1:], delimiter=",").T, strict=True))
    sensor = column["trs605-5 torque [Nm]"]
    position = column["a1 position [rad]"]
    columns = {"time_s": column["time [s]"], "rotor.position_rad": position}
    columns["rotor.torque_nm"] = column["a1 torque [Nm]"] - (sensor - np.median(sensor[:10]))
    end = int(np.flatnonzero(np.abs(position - position[-1]) > 0.1)[-1])
    write(out / "17-39-20.csv", {name: x[:end] for name, x in columns.items()})


def odrive(clone: Clone, out: Path) -> None:
    """A bare motor on an ODrive, spun up by a constant current for a second, 1.3 kHz."""
    for trial in (7, 8):
        path = f"analysis/cogging_torque/accel_tests/spinup_{trial}_comp.mat"
        currents, *readings = loadmat(io.BytesIO(clone.read(path)), squeeze_me=True)["data"]
        for i in range(9, len(currents), 5 if trial == 7 else 10):
            time, counts, current = (np.asarray(x[i], dtype=np.float64) for x in readings)
            columns = {"time_s": time - time[0]}
            columns["rotor.position_rad"] = 2.0 * np.pi / 8192.0 * (counts - counts[0])
            columns["rotor.current_a"] = current
            write(out / f"{'fit' if trial == 7 else 'held'}_{i:02d}.csv", columns)


def fr3(clone: Clone, out: Path) -> None:
    """A Franka Research 3 that follows another arm, 1 kHz; every tenth row."""
    for name in ("162545_final_20260223_162556", "162853_final_20260223_162903",
                 "163055_final_20260223_163105", "163230_final_20260223_163240"):  # fmt: skip
        text = clone.read(f"franka_data/franka_follower_20260223_{name}.npy")
        rows = np.load(io.BytesIO(text), allow_pickle=False)[::10]
        columns = {"time_s": (rows[:, 0] - rows[0, 0]) * 1e-9}
        for j in range(7):
            columns[f"joint{j + 1}.position_rad"] = rows[:, 1 + j]
            columns[f"joint{j + 1}.velocity_rad_s"] = rows[:, 8 + j]
            columns[f"joint{j + 1}.torque_nm"] = rows[:, 15 + j]
        write(out / f"{name[:6]}.csv", columns)


MAKERS: dict[str, Callable[[Clone, Path], None]] = {
    "damiao": damiao,
    "ur10e": ur10e,
    "ak80": ak80,
    "sts3250": sts3250,
    "kinova": kinova,
    "ri50": ri50,
    "odrive": odrive,
    "fr3": fr3,
}


def main() -> None:
    """Write the logs of every repository."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--clones", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", action="append", choices=MAKERS)
    asked = parser.parse_args()
    for name in asked.only or MAKERS:
        MAKERS[name](Clone(asked.clones, name), asked.out / name)


if __name__ == "__main__":
    main()
