"""What users complain of in MuJoCo's own friction, reproduced, with ours next to it.

    python lab/native_complaints.py [--out lab/notes/img/native_friction.png]

A joint of 0.01 kg m^2, Coulomb 1 N m, breakaway 1.5 N m, stepped at 1 ms. The numbers are printed
as the table of lab/notes/native_friction.md.
"""

import argparse
import contextlib
from pathlib import Path

import matplotlib.pyplot as plt
import mujoco
import numpy as np

import frictionjoint as fj
from frictionjoint.errors import ParameterError

INERTIA, FS, FC, VS = 0.01, 1.5, 1.0, 0.05
OURS = {"Fs": FS, "Fc": FC, "Vs": VS, "n": 50.0, "virgin": "masing"}


def joint(
    native: str = "",
    actuator: str = "",
    option: str = "",
    ours: fj.FrictionParameters | None = None,
) -> mujoco.MjModel:
    """One hinge with a motor, and friction of one kind."""
    spec = mujoco.MjSpec.from_string(
        f'<mujoco><option timestep="0.001" gravity="0 0 0" {option}/><worldbody><body>'
        f'<joint name="j" {native}/><inertial pos="0 0 0" mass="1" '
        f'diaginertia="{INERTIA} {INERTIA} {INERTIA}"/></body></worldbody><actuator>{actuator}'
        '<motor joint="j"/></actuator></mujoco>'
    )
    if ours:
        fj.install(spec, {"j": ours})
    return spec.compile()


def law(stiffness: float) -> fj.FrictionParameters:
    """Ours, with a stiffness and the damping of it that the native one has as well."""
    return fj.FrictionParameters.symmetric(
        **OURS, sigma1=2 * (stiffness * INERTIA) ** 0.5, knots=((2 * FS / stiffness, 2 * FS),)
    )


def lugre(stiffness: float) -> str:
    """A dcmotor that is nothing but LuGre friction."""
    return (
        '<dcmotor joint="j" input="none" motorconst="1e-6" resistance="1" '
        f'lugre="{stiffness} {2 * (stiffness * INERTIA) ** 0.5} {FC} {FS} {VS}"/>'
    )


def run(model: mujoco.MjModel, load, seconds: float, v0: float = 0.0, every: int = 1):
    """Position and velocity under load(t), arrays of shape (n, 2); stops where it diverges."""
    data = mujoco.MjData(model)
    data.qvel[0] = v0
    track = []
    ours = any(
        (model.numeric(i).name or "").startswith("frictionjoint") for i in range(model.nnumeric)
    )
    with fj.attach(model) if ours else contextlib.nullcontext():
        for k in range(round(seconds / model.opt.timestep)):
            data.ctrl[-1] = load(data.time)
            mujoco.mj_step(model, data)
            if k % every == 0:
                track.append((data.qpos[0], data.qvel[0]))
            if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
                track.append((np.nan, np.nan))
                break
    return np.array(track)


def creep() -> tuple[float, float, np.ndarray, np.ndarray]:
    """Speed under half the limit, rad/s: frictionloss, and ours as a drift over the last 50 s."""
    native = run(joint(native=f'frictionloss="{FC}"'), lambda t: 0.5 * FC, 60.0, every=100)
    ours = run(joint(ours=law(1e3)), lambda t: 0.5 * FS * min(1.0, t / 2.0), 60.0, every=100)
    return float(native[-1, 1]), float(ours[-1, 0] - ours[len(ours) // 6, 0]), native, ours


def deceleration() -> tuple[float, float]:
    """Relative error of the stopping distance from 1 rad/s under Coulomb friction."""
    exact = INERTIA * 1.0**2 / (2 * FC)
    noslip = joint(native=f'frictionloss="{FC}"', option='noslip_iterations="20"')
    coulomb = fj.FrictionParameters.symmetric(Fs=FC, Fc=FC, Vs=VS, n=50.0, knots=((2e-4, 2 * FC),))
    found = [run(m, lambda t: 0.0, 2.0, v0=1.0)[:, 0].max() for m in (noslip, joint(ours=coulomb))]
    return found[0] / exact - 1.0, found[1] / exact - 1.0


def drift() -> tuple[float, float, np.ndarray, np.ndarray]:
    """rad a cycle under 0.5 +- 0.4 N m, far below breakaway: LuGre of dcmotor, and ours."""

    def load(t: float) -> float:
        return 0.5 * min(1.0, t) + 0.4 * np.sin(2 * np.pi * t) * (t > 1.0)

    found = []
    for model in (joint(actuator=lugre(1e3)), joint(ours=law(1e3))):
        track = run(model, load, 41.0, every=10)[:, 0]
        found.append(((track[-1] - track[-2001]) / 20, track))
    return float(found[0][0]), float(found[1][0]), found[0][1], found[1][1]


def stiff() -> tuple[str, str]:
    """A bristle of 1e5 N m/rad with Euler at 1 ms, h sqrt(K/J) = 3.2: largest speed in 2 s."""
    said = []
    for model in (
        joint(actuator=lugre(1e5), option='integrator="Euler"'),
        joint(ours=law(1e5), option='integrator="Euler"'),
    ):
        v = run(model, lambda t: 0.3, 2.0)[:, 1]
        said.append("diverges" if not np.isfinite(v).all() else f"{np.abs(v).max():.1e} rad/s")
    return said[0], said[1]


def unchecked() -> tuple[str, str]:
    """A Stribeck speed below zero and a breakaway below Coulomb."""
    joint(actuator=lugre(1e3).replace(f"{FC} {FS} {VS}", f"{FC} {0.5 * FC} {-VS}"))
    try:
        fj.FrictionParameters.symmetric(**{**OURS, "Fs": 0.5 * FC}, knots=((1e-3, 1.0),))
    except ParameterError as error:
        return "compiles", str(error)
    return "compiles", "accepted"


def main() -> None:
    """Print the table, draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="PNG of creep and drift")
    out = parser.parse_args().out
    native_creep, ours_creep, native_hold, ours_hold = creep()
    native_stop, ours_stop = deceleration()
    native_drift, ours_drift, native_track, ours_track = drift()
    native_stiff, ours_stiff = stiff()
    native_check, ours_check = unchecked()
    print("| complaint | native | ours |\n|---|---|---|")
    print(
        f"| creep under half the limit | {native_creep:.1e} rad/s for ever (`frictionloss`) | "
        f"{ours_creep:.1e} rad in the last 50 s of 60 |"
    )
    print(
        f"| stopping distance from 1 rad/s | {native_stop:+.1%} (`frictionloss`, noslip) | "
        f"{ours_stop:+.1%} |"
    )
    print(
        f"| drift under 0.5 +- 0.4 N m | {native_drift:.1e} rad a cycle (`dcmotor` LuGre) | "
        f"{ours_drift:.1e} rad a cycle |"
    )
    print(
        f"| stiffness 1e5 N m/rad, Euler, 1 ms, 0.3 N m | {native_stiff} (`dcmotor` LuGre) | "
        f"largest speed {ours_stiff} |"
    )
    print(f"| breakaway below Coulomb | {native_check} | {ours_check} |")
    if out:
        figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
        time = np.linspace(0, 60, len(native_hold))
        left.plot(time, native_hold[:, 0], label="frictionloss")
        left.plot(time, ours_hold[:, 0], label="frictionjoint")
        left.set(xlabel="time, s", ylabel="position, rad", title="Constant load, half the limit")
        left.legend()
        time = np.linspace(0, 41, len(native_track))
        right.plot(time, 1e3 * native_track, label="dcmotor LuGre")
        right.plot(time, 1e3 * ours_track, label="frictionjoint")
        right.set(xlabel="time, s", ylabel="position, mrad", title="0.5 +- 0.4 N m")
        right.legend()
        out.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(out, dpi=110)


if __name__ == "__main__":
    main()
