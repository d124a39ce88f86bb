"""Does an installed frictionjoint work? Run away from the source, with the installation's Python.

    cd /tmp && python /path/to/scripts/smoke.py

Fails where the source tree is what was imported, a file that ships is missing, the package has no
types, or a joint that its friction must hold moves.
"""

import importlib.resources
import subprocess
import sys
from pathlib import Path

import frictionjoint as fj

SOURCE = Path(__file__).resolve().parents[1]
sys.path.append(str(SOURCE / "examples"))

from five_lines import ARM, ELBOW  # noqa: E402


def main() -> None:
    """Installed files, a held joint, the command."""
    home = Path(fj.__file__).resolve().parent
    assert not home.is_relative_to(SOURCE / "frictionjoint"), f"the source was imported: {home}"
    assert (home / "py.typed").is_file(), "py.typed is missing"

    import mujoco

    models = importlib.resources.files("frictionjoint.models")
    fj.load_model(str(models / "kuka_ir361_joint1.xml"))

    spec = mujoco.MjSpec.from_string(ARM)
    fj.install(spec, {"elbow": ELBOW})
    model = spec.compile()
    data = mujoco.MjData(model)
    with fj.attach(model):
        mujoco.mj_step(model, data, nstep=10_000)
    assert 0.0 < abs(data.qpos[0]) < 3e-4, f"the joint went {data.qpos[0]:.3g} rad"

    joint = Path(str(importlib.resources.files("frictionjoint.demo") / "joint.xml"))
    assert joint.is_file(), "the demo's model is missing"
    command = Path(sys.executable).with_name("frictionjoint")
    asked = subprocess.run([command, "--help"], capture_output=True, text=True)
    assert asked.returncode == 0, asked.stderr
    assert "close-loop" in asked.stdout, asked.stdout
    print(f"frictionjoint in {home}: works with MuJoCo {mujoco.__version__}")


if __name__ == "__main__":
    main()
