"""The part of the build that pyproject.toml cannot say: kernels compiled into the wheel."""

import os
import sys
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

# kernels run as Python while they are translated
os.environ["FRICTIONJOINT_PYTHON"] = "1"
ROOT = Path(__file__).parent
# a name of `frictionjoint.translate.build.TARGETS`, to compile for another machine
TARGET = os.environ.get("FRICTIONJOINT_TARGET")
PLATFORMS = {
    "linux-x86_64": "manylinux_2_17_x86_64",
    "linux-aarch64": "manylinux_2_17_aarch64",
    "macos-arm64": "macosx_11_0_arm64",
    "windows-x86_64": "win_amd64",
}


class BuildPy(build_py):
    """Python files, and the shared library that is made of them."""

    def run(self) -> None:
        """Build into the folder of the wheel; into the source tree for an editable install."""
        super().run()
        sys.path.insert(0, str(ROOT))
        from frictionjoint.translate.build import build

        base = ROOT if self.editable_mode else Path(self.build_lib)
        build(base / "frictionjoint" / "_native", TARGET)


class BdistWheel(bdist_wheel):
    """A wheel for one platform and every Python 3."""

    def get_tag(self) -> tuple[str, str, str]:
        """Tags of Python, ABI and platform."""
        platform = PLATFORMS[TARGET] if TARGET else super().get_tag()[2]
        return "py3", "none", platform


class WithLibrary(Distribution):
    """A distribution that is not the same on every platform."""

    def has_ext_modules(self) -> bool:
        """There is a library in it, though no extension of Python."""
        return True


setup(distclass=WithLibrary, cmdclass={"build_py": BuildPy, "bdist_wheel": BdistWheel})
