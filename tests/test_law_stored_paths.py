"""The stored presliding paths are those of the independent reference too."""

import json

import numpy as np
import pytest
from reference.integrated_solver import reference_torque
from test_presliding import PATHS, STORED, friction, path


@pytest.mark.parametrize("name", PATHS)
@pytest.mark.parametrize("variant", ["ganseman1997", "lampaert2002"])
def test_reference_meets_the_stored_paths(name, variant):
    stored = json.loads(STORED.read_text())[f"{name}/{variant}"]
    found, _ = reference_torque(friction(variant=variant), *path(PATHS[name]))
    np.testing.assert_allclose(found[::8], stored, rtol=0, atol=1.5e-6)
