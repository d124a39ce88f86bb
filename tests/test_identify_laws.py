"""Every law can be identified: the one a plant has is the one that explains its logs best."""

import json

import numpy as np
import pytest
from command_line import run
from plants.plant import Friction, Motion, simulate, write
from test_cli import LOG, MODEL
from trial_logs import quiet

from frictionjoint.files import read_parameters
from frictionjoint.identify.intervals import covariance
from frictionjoint.identify.prepare import prepare
from frictionjoint.identify.result import law_estimates, law_parameters
from frictionjoint.identify.rigid_body import RigidBody
from frictionjoint.identify.rival_shape import forms_of
from frictionjoint.identify.start import predict
from frictionjoint.identify.starts import fit
from frictionjoint.measured.readers import read_log

FS, FC, VS, SIGMA2, STIFFNESS = 0.8, 0.5, 0.1, 0.1, 400.0
# the plants' names of laws that the package has too
PLANTS = {"lugre": "lugre", "elasto-plastic": "elastoplastic", "gms": "maxwell_slip"}
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


def test_the_command_writes_a_file_of_the_law(tmp_path):
    given = ("identify", LOG, "--model", MODEL, "--joint", "joint", "--law")
    done = run(*given, "armstrong", "--out", "joint.toml", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = read_parameters(tmp_path / "joint.toml").parameters
    assert found.law == "armstrong"
    shown = json.loads(done.stdout)["parameters"]
    assert shown["sigma0"]["value"] == pytest.approx(found.sigma0)
    refused = run(*given, "hertz", "--out", "no.toml", cwd=tmp_path)
    assert refused.returncode == 2
    assert "unknown law 'hertz'" in refused.stderr
    assert not (tmp_path / "no.toml").exists()
