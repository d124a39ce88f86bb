"""A header of `frictionjoint export --to c`, compiled and called from Python."""

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np

FLAGS = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2")
COMPILER = next((found for found in map(shutil.which, ("cc", "gcc", "clang")) if found), None)
_DRIVER = """
#include "friction.h"
void drive(int joint, double *state, int n, const double *t, const double *q, const double *v,
    const double *around, double *F);
void drive(int joint, double *state, int n, const double *t, const double *q, const double *v,
    const double *around, double *F)
{
    for (int k = 0; k < n; k++) {
        frictionjoint_surroundings s;
        if (around) {
            s.bias = around[6 * k];
            s.inertia = around[6 * k + 1];
            s.armature = around[6 * k + 2];
            s.gravity[0] = around[6 * k + 3];
            s.gravity[1] = around[6 * k + 4];
            s.asked = around[6 * k + 5];
        }
        F[k] = frictionjoint_torque(&frictionjoint_joints[joint], state, t[k], q[k], v[k],
            around ? &s : 0);
    }
}
int room(void);
int room(void)
{
    return FRICTIONJOINT_STATE;
}
"""


def compile_c(folder: Path, source: str, *options: str, name: str = "driver") -> Path:
    """Compile C text next to the headers in a folder.

    Raises:
        RuntimeError: the compiler says anything, warnings among it.
    """
    code = folder / f"{name}.c"
    code.write_text(source)
    out = folder / name
    command = [COMPILER or "cc", *FLAGS, *options, str(code), "-o", str(out), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode or done.stderr:
        raise RuntimeError(done.stderr)
    return out


class Header:
    """A compiled header.

    Args:
        text: of the header. folder: an empty one to compile in.
    """

    def __init__(self, text: str, folder: Path) -> None:
        (folder / "friction.h").write_text(text)
        path = compile_c(folder, _DRIVER, "-shared", "-fPIC")
        self._library = ctypes.CDLL(str(path))
        self.room = int(self._library.room())

    def torque(self, joint, time, position, velocity, around=None, state=None):
        """Friction torque at each call, N m.

        Args:
            joint: its index. time, position, velocity: shape (n,).
            around: the surroundings, shape (n, 6), or None.
            state: shape (room,), changed; a fresh one without it.
        """
        columns = [np.ascontiguousarray(x, dtype=np.float64) for x in (time, position, velocity)]
        n = len(columns[0])
        state = np.zeros(self.room) if state is None else state
        given = None if around is None else np.ascontiguousarray(around, dtype=np.float64)
        out = np.empty(n)
        pointers = [x.ctypes.data_as(ctypes.c_void_p) for x in columns]
        self._library.drive(
            ctypes.c_int(joint),
            state.ctypes.data_as(ctypes.c_void_p),
            ctypes.c_int(n),
            *pointers,
            None if given is None else given.ctypes.data_as(ctypes.c_void_p),
            out.ctypes.data_as(ctypes.c_void_p),
        )
        return out
