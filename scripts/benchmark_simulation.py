"""What friction costs a simulation step: ours and MuJoCo's own, over the bare step of the same run.

    python scripts/benchmark_simulation.py [--repeats 15] [--only chain trees quadruped]

Chains of 1, 7, 30 and 100 hinges, 2,000 trees of one hinge, and a quadruped of 12 joints that
stands on its feet; held below breakaway and sliding, for presliding stiffnesses h sqrt(K/J) of 0.3,
3 and 30. The models take turns, each from the same state, and are timed in computing time. A figure
is the median ratio to the bare step of the same turn; in brackets the ratio of the least times,
which a busy machine disturbs least. "frictionloss" has no stiffness, `dcmotor` LuGre and yield
springs (MuJoCo 4.0) have that of ours. A way whose motion diverges is left out ("-").
"""

import argparse
import contextlib
import os
import time

import mujoco
import numpy as np

import frictionjoint as fj

LEVEL = 0.1  # N m
RATIOS = (0.3, 3.0, 30.0)
WAYS = ("ours", "frictionloss", "LuGre", "yield springs")
STATE = mujoco.mjtState.mjSTATE_INTEGRATION
WARM_UP, AGAIN = 60, 5
# of the stiffness and of the level, for each yield spring of a joint
ELEMENTS = ((0.6, 0.3), (0.3, 0.4), (0.1, 0.3))
OPTION = '<option timestep="1e-3" integrator="implicitfast"{}/>'
LINK = (
    '<joint name="j{0}" axis="{1}"/><geom type="capsule" fromto="0 0 0 {2}" size=".01" mass=".5" '
    'contype="0" conaffinity="0"/>'
)


def chain(n: int) -> str:
    """Links in a row, axes by turns, without gravity."""
    bodies = "".join(
        f'<body pos="0 0 {0.1 * bool(i)}">' + LINK.format(i, f"{i % 2} {1 - i % 2} 0", "0 0 .1")
        for i in range(n)
    )
    option = OPTION.format(' gravity="0 0 0"')
    return f"<mujoco>{option}<worldbody>{bodies}{'</body>' * n}</worldbody></mujoco>"


def trees(n: int) -> str:
    """Links side by side, without gravity."""
    bodies = "".join(
        f'<body pos="{0.2 * i} 0 0">{LINK.format(i, "0 1 0", ".1 0 0")}</body>' for i in range(n)
    )
    option = OPTION.format(' gravity="0 0 0"')
    return f"<mujoco>{option}<worldbody>{bodies}</worldbody></mujoco>"


def quadruped() -> str:
    """A trunk of 8 kg on four legs with hip, thigh and knee, about the size of a Go1."""
    legs, i = "", 0
    for x in (0.19, -0.19):
        for y in (0.05, -0.05):
            side = 0.08 if y > 0 else -0.08
            legs += (
                f'<body pos="{x} {y} 0"><joint name="j{i}" axis="1 0 0"/>'
                f'<geom class="link" fromto="0 0 0 0 {side} 0" mass=".6"/>'
                f'<body pos="0 {side} 0"><joint name="j{i + 1}" axis="0 1 0"/>'
                '<geom class="link" fromto="0 0 0 -.1 0 -.19" mass=".9"/>'
                f'<body pos="-.1 0 -.19"><joint name="j{i + 2}" axis="0 1 0"/>'
                '<geom class="link" fromto="0 0 0 .1 0 -.19" mass=".2"/>'
                '<geom size=".02" pos=".1 0 -.19" mass=".05"/></body></body></body>'
            )
            i += 3
    link = '<default class="link"><geom type="capsule" size=".02" contype="0" conaffinity="0"/>'
    return (
        f"<mujoco>{OPTION.format('')}<default>{link}</default></default><worldbody>"
        '<geom type="plane" size="3 3 .1"/><body pos="0 0 .4"><freejoint/><geom type="box" '
        f'size=".19 .05 .05" mass="8" contype="0" conaffinity="0"/>{legs}</body></worldbody>'
        "</mujoco>"
    )


def model_of(xml: str, way: str, ratio: float, level: float) -> mujoco.MjModel | None:
    """The model with one kind of friction at every joint; None where MuJoCo has it not."""
    spec = mujoco.MjSpec.from_string(xml)
    plain = spec.compile()
    if way == "bare":
        return plain
    joints = [joint for joint in spec.joints if joint.name]
    h, laws = plain.opt.timestep, {}
    for joint in joints:
        K = (ratio / h) ** 2 / plain.dof_invweight0[plain.joint(joint.name).dofadr[0]]
        if way == "ours":
            knots = (
                (level / K, level),
                (3 * level / K, 1.7 * level),
                (10 * level / K, 2.1 * level),
            )
            laws[joint.name] = fj.FrictionParameters.symmetric(
                Fs=level, Fc=0.7 * level, Vs=0.05, n=2.0, knots=knots
            )
        elif way == "frictionloss":
            joint.frictionloss = level
    if way == "ours":
        fj.install(spec, laws)
    text = spec.to_xml() if way in ("LuGre", "yield springs") else ""
    if way == "LuGre":
        motors = ""
        for joint in joints:
            K = (ratio / h) ** 2 / plain.dof_invweight0[plain.joint(joint.name).dofadr[0]]
            motors += (
                f'<dcmotor joint="{joint.name}" input="none" motorconst="1e-6" resistance="1" '
                f'lugre="{K} 0 {0.7 * level} {level} 0.05"/>'
            )
        text = text.replace("</mujoco>", f"<actuator>{motors}</actuator></mujoco>")
    if way == "yield springs":
        if not hasattr(plain, "jnt_springyield") and not hasattr(plain, "tendon_springyield"):
            return None
        tendons = ""
        for joint in joints:
            K = (ratio / h) ** 2 / plain.dof_invweight0[plain.joint(joint.name).dofadr[0]]
            tendons += "".join(
                f'<fixed stiffness="{k * K}" springlength="0" springyield='
                f'"{f * level / (k * K)}"><joint joint="{joint.name}" coef="1"/></fixed>'
                for k, f in ELEMENTS
            )
        text = text.replace("</mujoco>", f"<tendon>{tendons}</tendon></mujoco>")
    return mujoco.MjModel.from_xml_string(text) if text else spec.compile()


def cost(
    xml: str, ratio: float, sliding: bool, level: float, repeats: int, seconds: float = 0.02
) -> dict[str, tuple[float, float]]:
    """Median and least microseconds of the bare step, then ratios to it by way."""
    found: dict[str, list[float]] = {}
    runs = {}
    for way in ("bare", *WAYS):
        try:
            model = model_of(xml, way, ratio, level)
        except ValueError:
            model = None
        if model is None:
            continue
        data = mujoco.MjData(model)
        joints = model.nv - 6 * (model.nq != model.nv)
        # a load that friction holds, shared so that a chain holds it too
        data.qfrc_applied[-joints:] = 0.0 if sliding else 0.3 * level / np.arange(1, joints + 1)
        data.qvel[-joints:] = 2.0 * sliding
        with fj.attach(model) if way == "ours" else contextlib.nullcontext():
            mujoco.mj_step(model, data, AGAIN if sliding else WARM_UP)
        if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
            continue
        start = np.empty(mujoco.mj_stateSize(model, STATE))
        mujoco.mj_getState(model, data, start, STATE)
        runs[way], found[way] = (model, data, start), []
    steps = 0
    for _ in range(repeats):
        for way, (model, data, start) in runs.items():
            with fj.attach(model) if way == "ours" else contextlib.nullcontext():
                mujoco.mj_setState(model, data, start, STATE)
                mujoco.mj_step(model, data, AGAIN)
                if not steps:  # as many as fill the time, but not so many that sliding ends
                    begin = time.thread_time()
                    mujoco.mj_step(model, data, AGAIN)
                    taken = (time.thread_time() - begin) / AGAIN
                    steps = int(np.clip(seconds / taken, 10, 40 if sliding else 4000))
                begin = time.thread_time()
                mujoco.mj_step(model, data, steps)
                found[way].append((time.thread_time() - begin) / steps * 1e6)
    bare = np.array(found.pop("bare"))
    cells = {"bare": (float(np.median(bare)), float(bare.min()))}
    for way, taken in found.items():
        own = np.array(taken)
        cells[way] = (float(np.median(own / bare)), float(own.min() / bare.min()))
    return cells


def main() -> None:
    """Measure and print, as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--only", nargs="*", default=["chain", "trees", "quadruped"])
    given = parser.parse_args()
    print(f"MuJoCo {mujoco.__version__}, {os.cpu_count()} CPUs. Median ratios (of least times).\n")
    print(f"| model | joints | h sqrt(K/J) | motion | bare, us | {' | '.join(WAYS)} |")
    print("|---" * (5 + len(WAYS)) + "|")
    models = [("chain", n, chain(n), LEVEL) for n in (1, 7, 30, 100)]
    models += [("trees", 2000, trees(2000), LEVEL), ("quadruped", 12, quadruped(), 20.0)]
    for name, n, xml, level in models:
        for ratio in RATIOS if name in given.only else ():
            for sliding in (False, True) if name != "quadruped" else (False,):
                found = cost(xml, ratio, sliding, level, given.repeats)
                cells = [
                    "{:.2f} ({:.2f})".format(*found[way]) if way in found else "-" for way in WAYS
                ]
                motion = "sliding" if sliding else "held"
                bare = f"{found['bare'][0]:.2f}"
                print(
                    f"| {name} | {n} | {ratio:g} | {motion} | {bare} | {' | '.join(cells)} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
