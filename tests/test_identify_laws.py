"""Every law can be identified: the one a plant has is the one that explains its logs best."""

import json

import numpy as np
import pytest
from command_line import run
from law_shapes import law_at
from test_cli import LOG, MODEL
from trial_logs import quiet

from frictionjoint import friction_torque
from frictionjoint.errors import ParameterError
from frictionjoint.files import read_parameters
from frictionjoint.identify.law_start import LawStart
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_estimates, law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.start import predict
from frictionjoint.identify.starts import fit
from frictionjoint.identify.uncertainty import covariance
from frictionjoint.law.names import LAWS
from frictionjoint.measured.readers import read_log
from tests.plants.plant import Friction, Motion, simulate, write

FS, FC, VS, SIGMA2, STIFFNESS = 0.8, 0.5, 0.1, 0.1, 400.0
# the plants' names of laws that the package has too
PLANTS = {"lugre": "lugre", "elasto-plastic": "elastoplastic", "gms": "maxwell_slip"}
START = LawStart(excess=0.3, Vs=0.1, delta=1.2, length=1e-3, bend=(0.4, 0.4))
MOTIONS = (Motion("ramps", 3, 0.3, 1.0, 12.0), Motion("sines", 4, 0.3, 1.0, 8.0))


@pytest.fixture(scope="module", params=PLANTS)
def plant(request, tmp_path_factory):
    """The law, and logs of a joint that has it: one to fit, one held out."""
    friction = Friction(
        request.param, Fs=FS, Fc=FC, Vs=VS, delta=2.0, sigma2=SIGMA2, presliding=2 * FS / STIFFNESS
    )
    folder = tmp_path_factory.mktemp(request.param)
    paths = write(simulate(quiet(friction=friction, motions=MOTIONS)), folder)
    body = RigidBody(folder / "joint.xml", "joint")
    logs = [read_log(path, "joint") for path in paths]
    fitted = prepare(logs[:1], body)
    return PLANTS[request.param], fitted, prepare(logs[1:], body, fitted.band)


def held_out_rms(fitted, kept):
    return float(np.sqrt(np.mean(predict(kept, fitted).error ** 2)))


def test_the_plants_own_law_explains_it(plant):
    law, logs, kept = plant
    own = fit(logs, forms=forms_of(law))
    p = law_parameters(own)
    assert p.law == law
    assert p.Fc_pos == pytest.approx(FC, rel=0.05)
    assert p.sigma2_pos == pytest.approx(SIGMA2, rel=0.15)
    assert own.rms < 0.03 * FC
    for other in {"static", "dahl"}:
        assert held_out_rms(own, kept) < 0.5 * held_out_rms(fit(logs, forms=forms_of(other)), kept)
    estimates = law_estimates(
        own, covariance(logs, own, np.arange(own.residual.size) // 200), False
    )
    assert estimates["Fc_pos"].value == p.Fc_pos
    assert 0 < estimates["Fc_pos"].stderr < 0.1 * FC
    assert estimates["stiffness"].value == pytest.approx(p.stiffness)


@pytest.mark.parametrize("law", LAWS)
def test_a_search_keeps_every_law_within_its_range(law):
    """At the bounds of the search the parameters still pass validation, and come back whole."""
    for shape in forms_of(law):
        low, high = shape.bounds(2.0, 1.5)
        started = (s.vector() for s in shape.started(START))
        for x in (low, high, 0.5 * (low + high), *started):
            moved = shape.moved(x)
            np.testing.assert_allclose(moved.vector(), x, atol=1e-12)
            p = moved.parameters(0.7, 0.1, 0.2)
            assert p.Fc_pos == 0.7
            assert len(x) == len(shape.variables)


def test_a_static_law_rises_to_its_static_friction_before_that_falls():
    """Or a curve of any form is had from the two together, with a Fs that nothing ever feels."""
    (shape,) = forms_of("static")
    for x in shape.bounds(2.0, 1.5):
        p = shape.moved(x).parameters(0.7, 0.1, 0.2)
        assert 0.5 * p.Vs_pos >= p.V0 > 0.0


def test_scaling_the_levels_scales_the_torque():
    """What lets a fit factor the Coulomb level out, in every law."""
    rng = np.random.default_rng(0)
    t = np.linspace(0.0, 3.0, 3001)
    q = np.cumsum(rng.normal(0.0, 1e-3, t.size))
    for law in LAWS:
        for shape in forms_of(law):
            shape = law_at(shape, 0.02, 0.001)
            one = friction_torque(shape.parameters(1.0, 0.0), t, q)
            np.testing.assert_allclose(
                friction_torque(shape.parameters(3.7, 0.0), t, q), 3.7 * one, atol=1e-9
            )
            np.testing.assert_allclose(shape.hysteresis(t, q)[0], one, atol=1e-12)


def test_unknown_law_is_named_with_the_known_ones():
    with pytest.raises(ParameterError, match="'gms': known are integrated, static"):
        forms_of("gms")


def test_the_command_writes_a_file_of_the_law(tmp_path):
    done = run(
        "identify", LOG, "--model", MODEL, "--joint", "joint", "--law", "armstrong",
        "--out", "joint.toml", "--json", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = read_parameters(tmp_path / "joint.toml").parameters
    assert found.law == "armstrong"
    shown = json.loads(done.stdout)["parameters"]
    assert shown["sigma0"]["value"] == pytest.approx(found.sigma0)
    refused = run(
        "identify", LOG, "--model", MODEL, "--joint", "joint", "--law", "hertz",
        "--out", "no.toml", cwd=tmp_path,
    )  # fmt: skip
    assert refused.returncode == 2
    assert "unknown law 'hertz'" in refused.stderr
    assert not (tmp_path / "no.toml").exists()
