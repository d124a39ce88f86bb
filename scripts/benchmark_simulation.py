"""What friction costs a simulation step: ours and MuJoCo's own, over the bare step of the same run.

    python scripts/benchmark_simulation.py [--repeats 15] [--only chain trees robots batch]

Chains of 1, 7, 30 and 100 hinges, 2,000 trees of one hinge, a quadruped of 12 and a humanoid of 29
joints that stand on their feet; held below breakaway and sliding, for presliding stiffnesses
h sqrt(K/J) of 0.3, 3 and 30. The models take turns, each from the same state, and are timed in
computing time. A figure is the median ratio to the bare step of the same turn; in brackets the
ratio of the least times, which a busy machine disturbs least. "frictionloss" has no stiffness,
`dcmotor` LuGre and yield springs (MuJoCo 4.0) have that of ours. A way that diverges is left out
("-"). Last come steps of many worlds by MuJoCo's Batch, thousands per second.

With --robots FOLDER the robots are unitree_go1 and unitree_g1 of a folder of models like MuJoCo
Menagerie, in their first keyframe; without it two of the same size are made here. The bare robot
falls: it is timed while it still stands, as sliding is while it lasts.
"""

import argparse
import contextlib
import os
import time
from pathlib import Path

import mujoco
import numpy as np

import frictionjoint as fj

LEVEL, CREEP = 0.1, 0.01  # N m, of chains and trees that are held and that slide
SPEED = 0.5  # rad/s, of those that slide, and Stribeck velocity a tenth of it
RATIOS = (0.3, 3.0, 30.0)
WAYS = ("ours", "frictionloss", "LuGre", "yield springs")
STATE = mujoco.mjtState.mjSTATE_INTEGRATION
WARM_UP, AGAIN = 60, 5
WORLDS = 256
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


def limb(names: list[str], axes: str, ends: list[str], masses: list[float], tip: str) -> str:
    """Links in a row, each with one joint; `tip` is what the last one has besides."""
    axis = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
    text = tip
    for k in reversed(range(len(names))):
        at = ends[k - 1] if k else "0 0 0"
        text = (
            f'<body pos="{at}"><joint name="{names[k]}" axis="{axis[axes[k]]}"/>'
            f'<geom class="link" fromto="0 0 0 {ends[k]}" mass="{masses[k]}"/>{text}</body>'
        )
    return text


def robot(height: float, trunk: str, limbs: list[tuple[str, str]]) -> str:
    """A free trunk above a floor, and limbs at places of it."""
    link = '<default class="link"><geom type="capsule" size=".02" contype="0" conaffinity="0"/>'
    placed = "".join(f'<body pos="{at}">{text}</body>' for at, text in limbs)
    return (
        f"<mujoco>{OPTION.format('')}<default>{link}</default></default><worldbody>"
        f'<geom type="plane" size="3 3 .1"/><body pos="0 0 {height}"><freejoint/><geom type="box" '
        f'{trunk} contype="0" conaffinity="0"/>{placed}</body></worldbody></mujoco>'
    )


def quadruped() -> str:
    """A trunk of 8 kg on four legs with hip, thigh and knee, about the size of a Go1."""
    limbs = []
    for i, (x, y) in enumerate((x, y) for x in (0.19, -0.19) for y in (0.05, -0.05)):
        names = [f"j{3 * i + k}" for k in range(3)]
        ends = [f"0 {0.08 if y > 0 else -0.08} 1e-3", "-.1 0 -.19", ".1 0 -.19"]
        foot = '<geom size=".02" pos=".1 0 -.19" mass=".05"/>'
        limbs.append((f"{x} {y} 0", limb(names, "xyy", ends, [0.6, 0.9, 0.2], foot)))
    return robot(0.4, 'size=".19 .05 .05" mass="8"', limbs)


def humanoid() -> str:
    """29 joints and 33 kg, about the size of a G1: legs of six, a waist of three, arms of seven."""
    sole = "".join(
        f'<geom size=".01" pos="{x} {y} -.05" mass=".05"/>'
        for x in (-0.06, 0.12)
        for y in (-0.03, 0.03)
    )
    short, limbs = "0 0 -1e-3", []
    for side in (1, -1):
        names = [f"leg{side}{k}" for k in range(6)]
        ends = [short, short, "0 0 -.3", "0 0 -.3", short, "0 0 -.04"]
        text = limb(names, "yxzyyx", ends, [1.3, 1.5, 1.7, 1.9, 0.1, 0.6], sole)
        limbs.append((f"0 {0.12 * side} -.06", text))
    arms = ""
    for side in (1, -1):
        names = [f"arm{side}{k}" for k in range(7)]
        ends = [short, short, "0 0 -.2", "0 0 -.1", "0 0 -.1", short, "0 0 -.05"]
        text = limb(names, "yxzyxyz", ends, [0.7, 0.6, 0.7, 0.6, 0.1, 0.5, 0.2], "")
        arms += f'<body pos="0 {0.15 * side} .25">{text}</body>'
    waist = ["waist0", "waist1", "waist2"]
    up = "0 0 1e-3"
    limbs.append(("0 0 .05", limb(waist, "zxy", [up, up, "0 0 .25"], [0.2, 0.1, 8.0], arms)))
    return robot(0.76, 'size=".06 .1 .05" mass="4"', limbs)


def model_of(xml: str | Path, way: str, ratio: float, level: float) -> mujoco.MjModel | None:
    """The model with one kind of friction at every joint; None where MuJoCo has it not."""
    read = mujoco.MjSpec.from_file if isinstance(xml, Path) else mujoco.MjSpec.from_string
    spec = read(str(xml))
    joints = [joint for joint in spec.joints if joint.type != mujoco.mjtJoint.mjJNT_FREE]
    for joint in joints:
        joint.frictionloss = 0.0
    plain = spec.compile()
    if way == "bare":
        return plain
    h, laws = plain.opt.timestep, {}
    for joint in joints:
        K = (ratio / h) ** 2 / plain.dof_invweight0[plain.joint(joint.name).dofadr[0]]
        if way == "ours":
            knots = (
                (level / K, level),
                (3 * level / K, 1.6 * level),
                (10 * level / K, 2.1 * level),
            )
            laws[joint.name] = fj.FrictionParameters.symmetric(
                Fs=level, Fc=0.7 * level, Vs=0.1 * SPEED, n=2.0, knots=knots
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
                f'lugre="{K} 0 {0.7 * level} {level} {0.1 * SPEED}"/>'
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


def start_of(model: mujoco.MjModel, sliding: bool, level: float) -> mujoco.MjData:
    """Data in which the joints slide, or are held: those of a robot by its weight."""
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    if model.nq == model.nv:
        j = np.arange(model.nv)
        # neighbours turn against each other, so that a chain does not whip; a load is shared
        data.qvel[:] = sliding * SPEED * (1.0 - 2.0 * (j // 2 % 2))
        data.qfrc_applied[:] = 0.0 if sliding else 0.3 * level / (j + 1)
    return data


def cost(
    xml: str | Path, ratio: float, sliding: bool, level: float, repeats: int, seconds: float = 0.02
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
        data = start_of(model, sliding, level)
        with fj.attach(model) if way == "ours" else contextlib.nullcontext():
            mujoco.mj_step(model, data, AGAIN if sliding else WARM_UP)
        if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
            continue
        start = np.empty(mujoco.mj_stateSize(model, STATE))
        mujoco.mj_getState(model, data, start, STATE)
        runs[way], found[way] = (model, data, start), []
    steps = rounds = 0
    for _ in range(repeats):
        for way, (model, data, start) in runs.items():
            total = 0.0
            with fj.attach(model) if way == "ours" else contextlib.nullcontext():
                if not steps:
                    taken = _seconds(model, data, start, AGAIN) / AGAIN
                    lasts = 40 if sliding or model.nq != model.nv else 4000
                    steps = int(np.clip(seconds / taken, 10, lasts))
                    rounds = max(1, int(seconds / taken / steps))
                for _ in range(rounds):
                    total += _seconds(model, data, start, steps)
            found[way].append(total / steps / rounds * 1e6)
    bare = np.array(found.pop("bare"))
    cells = {"bare": (float(np.median(bare)), float(bare.min()))}
    for way, each in found.items():
        own = np.array(each)
        cells[way] = (float(np.median(own / bare)), float(own.min() / bare.min()))
    return cells


def _seconds(model: mujoco.MjModel, data: mujoco.MjData, start: np.ndarray, steps: int) -> float:
    mujoco.mj_setState(model, data, start, STATE)
    mujoco.mj_step(model, data, AGAIN)
    begin = time.thread_time()
    mujoco.mj_step(model, data, steps)
    return time.thread_time() - begin


def worlds_per_second(xml: str | Path, level: float, repeats: int) -> dict[str, float]:
    """Steps of worlds that MuJoCo's Batch makes on all CPUs, thousands per second, by way."""
    from mujoco.batch import Batch  # MuJoCo 3.17 on

    found = {}
    for way in ("bare", "ours", "frictionloss"):
        model = model_of(xml, way, 3.0, level)
        assert model is not None
        with fj.attach(model) if way == "ours" else contextlib.nullcontext():
            batch, taken = Batch(model, WORLDS, os.cpu_count() or 1), []
            for k in range(repeats + 1):
                begin = time.perf_counter()
                for _ in range(20):
                    batch.step()
                if k:
                    taken.append(time.perf_counter() - begin)
        found[way] = 20e-3 * WORLDS / float(np.median(taken))
    return found


def main() -> None:
    """Measure and print, as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=15)
    parser.add_argument("--only", nargs="*", default=["chain", "trees", "robots", "batch"])
    parser.add_argument("--robots", type=Path, help="folder with unitree_go1 and unitree_g1")
    given = parser.parse_args()
    quad: str | Path = quadruped()
    human: str | Path = humanoid()
    if given.robots:
        quad = given.robots / "unitree_go1" / "scene.xml"
        human = given.robots / "unitree_g1" / "scene.xml"
    print(f"MuJoCo {mujoco.__version__}, {os.cpu_count()} CPUs. Median ratios (of least times).\n")
    print(f"| model | joints | h sqrt(K/J) | motion | bare, us | {' | '.join(WAYS)} |")
    print("|---" * (5 + len(WAYS)) + "|")
    models: list[tuple[str, str, int, str | Path, float]]
    models = [("chain", "chain", n, chain(n), LEVEL) for n in (1, 7, 30, 100)]
    models += [("trees", "trees", 2000, trees(2000), LEVEL)]
    models += [("robots", "quadruped", 12, quad, 20.0), ("robots", "humanoid", 29, human, 60.0)]
    worst, above = ("", 0.0), []
    for group, name, n, xml, level in models:
        for ratio in RATIOS if group in given.only else ():
            for sliding in (False, True) if group != "robots" else (False,):
                found = cost(xml, ratio, sliding, CREEP if sliding else level, given.repeats)
                cells = [
                    "{:.2f} ({:.2f})".format(*found[way]) if way in found else "-" for way in WAYS
                ]
                motion = "sliding" if sliding else "held"
                row = f"{name} | {n} | {ratio:g} | {motion}"
                print(f"| {row} | {found['bare'][0]:.2f} | {' | '.join(cells)} |", flush=True)
                if found["ours"][0] > worst[1]:
                    worst = row, found["ours"][0]
                if found["ours"][0] >= found.get("frictionloss", (np.inf, 0.0))[0]:
                    above.append(row)
    if worst[0]:
        print(f"\nThe worst of ours: {worst[1]:.2f} ({worst[0]}).")
        print(f"Not below frictionloss: {'; '.join(above) or 'none'}.")
    if "batch" in given.only:
        print(f"\n| Batch of {WORLDS} worlds | bare, 1000 steps/s | ours | frictionloss |")
        print("|---|---|---|---|")
        for name, text, level in (("7 hinges", chain(7), LEVEL), ("quadruped", quad, 20.0)):
            speeds = worlds_per_second(text, level, given.repeats).values()
            print(f"| {name} | {' | '.join(f'{x:.0f}' for x in speeds)} |")


if __name__ == "__main__":
    main()
