"""Trial plants against MuJoCo and against closed forms; never against the law under test."""

import re
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from plants import catalogue
from plants.draw import TIES, draw_trial
from plants.friction import bristle, gms, maxwell_elements, stribeck
from plants.parts import MICRO_DAMPING
from plants.plant import (
    Controller,
    Effect,
    Friction,
    Instrument,
    Motion,
    PlantSpec,
    assemble,
    simulate,
    write,
)
from trial_logs import quiet

ROOT = Path(__file__).resolve().parents[2]

CANONICAL = {
    "position-periodic", "load-dependent", "temperature-dependent", "warm-up-drift",
    "direction-asymmetry", "nonlinear-viscous", "gravity-error", "torque-bias", "inertia-error",
    "spring", "joint-elasticity", "backlash", "measurement-delay", "torque-gain", "back-emf",
    "frictional-lag", "dwell-time", "end-stop",
}  # fmt: skip


def rough(*effects: Effect, **changes: object) -> PlantSpec:
    """The same plant with ordinary friction."""
    friction = Friction("gms", Fs=0.8, Fc=0.5, Vs=0.1, sigma2=0.1, presliding=2e-3)
    return replace(quiet(*effects), friction=friction, **changes)


def lacking(spec: PlantSpec) -> dict[str, np.ndarray]:
    """Torque that the believed model's inverse dynamics leaves unexplained, with q, v, a."""
    trial = simulate(spec)
    log = trial.logs[0]
    t, q = log["time_s"], log["position_rad"]
    v = np.gradient(q, t)
    a = np.zeros_like(q)
    a[1:-1] = (q[2:] - 2.0 * q[1:-1] + q[:-2]) / np.gradient(t)[1:-1] ** 2
    model = mujoco.MjModel.from_xml_string(trial.mjcf)
    data = mujoco.MjData(model)
    inverse = np.zeros_like(q)
    for i in range(q.size):
        data.qpos[0], data.qvel[0], data.qacc[0] = q[i], v[i], a[i]
        mujoco.mj_inverse(model, data)
        inverse[i] = data.qfrc_inverse[0]
    # command is held over each millisecond while a is centred on its start: average the two
    torque = 0.5 * (log["torque_nm"] + np.roll(log["torque_nm"], 1))
    keep = slice(200, -5)
    return {"t": t[keep], "q": q[keep], "v": v[keep], "a": a[keep], "tau": torque[keep],
            "R": (torque - inverse)[keep]}  # fmt: skip


def test_names_are_the_catalogue_of_the_design():
    assert set(catalogue.EFFECTS) == CANONICAL
    assert len(catalogue.UNKNOWN) >= 5
    assert not set(catalogue.UNKNOWN) & CANONICAL
    assert all(kind.quantities for kind in catalogue.UNKNOWN.values())


def test_plants_do_not_import_what_they_test():
    for path in (ROOT / "lab" / "plants").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"^\s*(import|from)\s+frictionjoint", text, re.M), path


def test_same_spec_same_logs():
    spec = rough(instrument=Instrument(rate=200.0, torque_noise=0.01, jitter=0.1))
    first, second = simulate(spec).logs[0], simulate(spec).logs[0]
    for name, column in first.items():
        assert np.array_equal(column, second[name])
    assert np.all(np.diff(first["time_s"]) > 0.0)


def test_frictionless_plant_is_the_believed_model():
    parts = lacking(quiet())
    assert np.abs(parts["R"]).max() < 0.01 * np.abs(parts["tau"]).max()


FORMS = {
    "torque-bias": ({"bias": 0.3}, lambda s, p: -0.3 + 0.0 * s["q"]),
    "gravity-error": (
        {"mass": 0.5, "angle": 0.8},
        lambda s, p: 0.5 * 0.2**2 * s["a"] + 0.5 * 9.81 * 0.2 * np.sin(s["q"] + 0.8),
    ),
    "inertia-error": ({"inertia": 0.05}, lambda s, p: 0.05 * s["a"]),
    "spring": ({"stiffness": 0.9, "rest": 0.2}, lambda s, p: 0.9 * (s["q"] - 0.2)),
    "end-stop": ({"at": 0.1, "stiffness": 5.0}, lambda s, p: 5.0 * np.maximum(s["q"] - 0.1, 0.0)),
    "position-periodic": (
        {"amplitude": 0.2, "cycles": 9.0, "phase": 0.4},
        lambda s, p: -0.2 * np.sin(9.0 * s["q"] + 0.4),
    ),
    "nonlinear-viscous": ({"c": 0.2, "power": 2.0}, lambda s, p: 0.2 * s["v"] * np.abs(s["v"])),
    "torque-gain": ({"error": 0.1}, lambda s, p: s["tau"] * 0.1 / 1.1),
}


@pytest.mark.parametrize("name", sorted(FORMS))
def test_effect_has_its_closed_form(name):
    parameters, form = FORMS[name]
    parts = lacking(quiet(Effect(name, parameters)))
    expected = form(parts, parameters)
    assert np.abs(expected).max() > 0.05
    assert np.abs(parts["R"] - expected).max() < 0.02 * np.abs(parts["tau"]).max()


def test_lugre_plant_moves_as_the_lugre_motor_of_mujoco():
    friction = Friction("lugre", Fs=0.8, Fc=0.5, Vs=0.1, delta=2.0, sigma2=0.0, presliding=5e-3)
    spec = replace(quiet(), friction=friction)
    log = simulate(spec).logs[0]
    s0 = 2.0 * friction.Fs / friction.presliding
    s1 = MICRO_DAMPING * np.sqrt(s0 * (spec.inertia + spec.armature))
    motor = (
        f'<actuator><dcmotor joint="joint" input="none" motorconst="1e-6" resistance="1" '
        f'lugre="{s0} {s1} {friction.Fc} {friction.Fs} {friction.Vs}"/></actuator></mujoco>'
    )
    text = assemble(spec).mjcf().replace("</mujoco>", motor)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    position = []
    for command in np.concatenate([[0.0], log["torque_nm"]])[:-1]:
        for _ in range(10):
            data.qfrc_applied[0] = command
            mujoco.mj_step(model, data)
        position.append(data.qpos[0])
    worst = np.abs(np.array(position) - log["position_rad"]).max()
    assert worst < 0.02 * np.ptp(log["position_rad"])
    without = replace(spec, friction=quiet().friction)
    other = simulate(without).logs[0]["torque_nm"]
    assert np.abs(other - log["torque_nm"]).max() > 0.3  # the friction was there to be compared


def test_gms_keeps_its_memory_and_reaches_the_level():
    k, alpha = maxwell_elements(1.0, 1e-3)
    z, slip = np.zeros(k.size), np.zeros(k.size, dtype=np.bool_)

    def travel(distance: float, last: float) -> float:
        v = np.sign(distance) * 0.01
        n = 2000
        for _ in range(n):
            force = gms(z, slip, distance / n, v, 1e-4, 1.0, k, alpha, 40.0, 0.0, last)
            last = v
        return float(force)

    assert travel(5e-4, 0.0) < 1.0
    before = travel(2e-4, 0.01)
    travel(-1e-4, 0.01)
    assert travel(1e-4, -0.01) == pytest.approx(before, rel=0.02)  # the inner loop closed
    assert travel(5e-3, 0.01) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("plateau", [0.0, 0.5])
def test_bristle_settles_on_the_stribeck_level(plateau):
    z, level = np.zeros(1), stribeck(0.3, 1.5, 1.0, 0.1, 2.0)
    for _ in range(4000):
        force = bristle(z, 3e-5, 1e-4, level, 1e3, 1.0, plateau)
    assert force == pytest.approx(level, rel=1e-6)


def dissipated(spec: PlantSpec) -> tuple[np.ndarray, float]:
    """Motor work less the believed body's energy along the first log, and the work turned over."""
    log = simulate(spec).logs[0]
    t, q = log["time_s"], log["position_rad"]
    v = np.gradient(q, t)
    power = 0.5 * (log["torque_nm"] + np.roll(log["torque_nm"], 1)) * v
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(t))])
    energy = 0.5 * (spec.inertia + spec.armature) * v**2 - spec.gravity_torque * np.cos(q)
    keep = slice(200, -5)
    lost = (work - energy)[keep]
    return lost - lost[0], float(np.abs(power[keep]).mean() * (t[-1] - t[0]))


def test_frictionless_plant_keeps_its_energy():
    lost, turned_over = dissipated(quiet())
    assert np.abs(lost).max() < 0.02 * turned_over


@pytest.mark.parametrize("law", ["gms", "lugre", "elasto-plastic", "plain"])
def test_friction_only_takes_energy(law):
    spec = replace(rough(), friction=replace(rough().friction, law=law))
    lost, turned_over = dissipated(spec)
    assert lost[-1] > 0.1 * turned_over
    # what the bristles give back at a reversal is far below what sliding takes
    assert (np.maximum.accumulate(lost) - lost).max() < 0.02 * turned_over


def test_plain_friction_is_mujocos_own():
    spec = replace(rough(), friction=replace(rough().friction, law="plain", Fs=0.5))
    parts = lacking(spec)
    sliding = np.abs(parts["v"]) > 0.3
    assert sliding.sum() > 300
    expected = 0.5 * np.sign(parts["v"]) + 0.1 * parts["v"]
    assert np.median(np.abs(parts["R"] - expected)[sliding]) < 0.02


def test_backlash_loses_motion_within_its_gap():
    gap = 0.02
    spec = rough(Effect("backlash", {"gap": gap, "stiffness": 4000.0}))
    model = mujoco.MjModel.from_xml_string(assemble(spec).mjcf())
    data = mujoco.MjData(model)
    data.qpos[1] = 0.4 * gap
    mujoco.mj_forward(model, data)
    assert data.qfrc_passive[1] == 0.0
    data.qpos[1] = 0.75 * gap
    mujoco.mj_forward(model, data)
    assert data.qfrc_passive[1] == pytest.approx(-4000.0 * 0.25 * gap)


def test_delay_shifts_position_and_nothing_else():
    late = simulate(rough(Effect("measurement-delay", {"delay": 5e-3}))).logs[0]
    prompt = simulate(rough()).logs[0]
    assert np.array_equal(late["torque_nm"], prompt["torque_nm"])
    assert np.allclose(late["position_rad"][5:], prompt["position_rad"][:-5])


def test_warming_lowers_friction_and_only_one_log_shows_why():
    heat = {"viscous": 0.3, "level": 0.5, "rise": 40.0, "tau": 1.0, "scale": 10.0}
    shown = simulate(rough(Effect("temperature-dependent", heat))).logs[0]
    hidden = simulate(rough(Effect("warm-up-drift", heat))).logs[0]
    assert shown["temperature_c"][-1] > shown["temperature_c"][0] + 5.0
    assert "temperature_c" not in hidden


def test_voltage_plant_gives_the_motor_equation():
    motor = {"kt": 0.5, "resistance": 2.0}
    trial = simulate(quiet(Effect("back-emf", motor), controller=Controller(kp=60.0, kd=3.0)))
    log = trial.logs[0]
    assert "torque_nm" not in log
    base = lacking(quiet())
    v = np.gradient(log["position_rad"], log["time_s"])[200:-5]
    torque = 0.25 * (log["voltage_v"][200:-5] - 0.5 * v)
    assert np.corrcoef(torque, base["tau"])[0, 1] > 0.99


def test_coupled_joint_is_in_the_log_and_in_the_model():
    spec = rough(Effect("joint-coupling", {"damper": 1.0, "torque": 0.3}))
    trial = simulate(spec)
    assert {"joint.position_rad", "joint.torque_nm", "other.position_rad"} <= set(trial.logs[0])
    assert mujoco.MjModel.from_xml_string(trial.mjcf).njnt == 2
    assert np.ptp(trial.logs[0]["other.position_rad"]) > 0.3


@pytest.mark.parametrize("name", sorted(CANONICAL) + sorted(catalogue.UNKNOWN))
def test_drawn_effect_changes_the_log(name):
    group = "one" if name in CANONICAL else "unknown"
    spec = draw_trial(np.random.default_rng(11), f"{group}:{name}")
    short = tuple(replace(m, duration=6.0) for m in spec.motions[:2])
    spec = replace(spec, motions=short, instrument=replace(spec.instrument, torque_noise=0.0))
    with_it, without = simulate(spec).logs, simulate(replace(spec, effects=())).logs
    names = {n.removeprefix("joint.") for n in with_it[0]} & set(without[0]) - {"time_s"}
    change = 0.0
    for a, b in zip(with_it, without, strict=True):
        plain = {k.removeprefix("joint."): v for k, v in a.items()}
        assert all(np.isfinite(v).all() for v in plain.values())
        change = max([change] + [np.std(plain[n] - b[n]) / np.std(b[n]) for n in names])
    assert change > 1e-3


def test_pairs_that_no_motion_parts_are_not_drawn():
    rng = np.random.default_rng(2)
    for _ in range(100):
        names = frozenset(e.name for e in draw_trial(rng, "two").effects)
        assert len(names) == 2
        assert names not in TIES


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda: Friction("coulomb"), "coulomb"),
        (lambda: Friction(Fs=1.0, Fc=2.0), "Fs"),
        (lambda: Motion("waltz", 1, 1.0, 1.0, 1.0), "waltz"),
        (lambda: quiet(inertia=1e-3), "inertia"),
        (lambda: simulate(quiet(Effect("ghost"))), "ghost"),
        (lambda: draw_trial(np.random.default_rng(0), "three"), "three"),
    ],
)
def test_bad_specs_are_named(make, word):
    with pytest.raises(ValueError, match=word):
        make()


def test_written_trial_holds_no_truth(tmp_path):
    spec = rough(Effect("torque-bias", {"bias": 0.3}))
    paths = write(simulate(spec), tmp_path)
    assert paths == [tmp_path / "log0.csv"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["joint.xml", "log0.csv"]
    assert "bias" not in (tmp_path / "joint.xml").read_text(encoding="utf-8")


def test_shipped_log_comes_from_its_script():
    import make_logs

    folder = ROOT / "frictionjoint" / "demo"
    trial = simulate(make_logs.DEMO)
    for name, log in zip(make_logs.names(make_logs.DEMO), trial.logs, strict=True):
        shipped = np.genfromtxt(folder / name, delimiter=",", names=True)
        assert shipped.dtype.names == tuple(log)
        for column, tolerance in (("position_rad", 1e-3), ("torque_nm", 0.05)):
            assert np.sqrt(np.mean((shipped[column] - log[column]) ** 2)) < tolerance
    assert sum(p.stat().st_size for p in folder.iterdir() if p.is_file()) < 300_000
