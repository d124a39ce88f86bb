"""Friction of many joints for simulators without a passive callback: torque, stiffness, damping.

    batch = frictionjoint.FrictionBatch(parameters, n)
    torque, stiffness, damping = batch.step(q, v, h)

Over the step of h seconds that begins at (q, v), friction is to first order

    F(q', v') = torque + stiffness (q' - q) + damping (v' - v)

positive against positive motion. An explicit simulator applies ``-torque``; one with implicit
drives also uses stiffness and damping, which a stiff joint needs. MuJoCo uses the same kernels.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import ROUNDING, Index, like
from frictionjoint.batch_kernel import ROW, step_all
from frictionjoint.errors import ParameterError
from frictionjoint.law.kernel import row_size as law_row_size
from frictionjoint.laws import require_parameters
from frictionjoint.parameters import Friction
from frictionjoint.simulate.row import row_size


class FrictionBatch:
    """Friction of n joints, or of worlds times joints, outside of MuJoCo.

    Args:
        parameters: of all joints, or a sequence with those of each.
        n: number of joints, or (worlds, joints).
        device: None: compiled code on the CPU, for arrays of numpy or any library with DLPack
            (torch, JAX, Warp). "cuda:0", or "cpu": Warp kernels, for arrays on that device.
    Attributes:
        shape: of the arrays, (n,) or (worlds, joints).
        state: doubles, shape (joints in all, m): the memory of the joints. Copy it to save a
            simulation, write it back to restore it.
    Raises:
        ParameterError: not one set of parameters per joint, or effects, which need a model.
        TypeError: no parameters.
    """

    def __init__(
        self,
        parameters: Friction | Sequence[Friction],
        n: int | tuple[int, int],
        device: str | None = None,
    ) -> None:
        self.shape = (n,) if isinstance(n, int) else tuple(n)
        if not self.shape or min(self.shape) < 1 or len(self.shape) > 2:
            raise ParameterError(f"n is {n!r}: give a number of joints, or (worlds, joints)")
        total, joints = int(np.prod(self.shape)), self.shape[-1]
        sets = list(parameters) if isinstance(parameters, Sequence) else [parameters]
        for one in sets:
            if getattr(one, "effects", ()):
                raise ParameterError("FrictionBatch: effects need a model: give .parameters alone")
            require_parameters(one, "FrictionBatch")
        if len(sets) not in (1, joints, total):
            raise ParameterError(
                f"{len(sets)} sets of parameters for {joints} joints: give one, or one per joint"
            )
        packed = [np.append(one.pack(), 0.0) for one in sets]  # no effects behind
        self._P = np.concatenate(packed)
        begins = np.cumsum([0, *(len(x) for x in packed)])
        which = np.arange(total) % len(sets)
        self._blocks: Index = begins[which].astype(np.int64)
        self._ends: Index = self._blocks + np.array([len(x) - 1 for x in packed])[which]
        rows = [law_row_size(self._P, int(b)) for b in begins[:-1]]
        self._stride = ROW + row_size(max(rows), 0)
        self._warp: Any = None
        self.state: Any = np.zeros((total, self._stride))
        if device is not None:
            from frictionjoint.batch_warp import WarpBatch

            self._warp = WarpBatch(device, self._P, self._blocks, self._ends, self._stride)
            self.state = self._warp.state

    def step(self, q: Any, v: Any, h: float) -> tuple[Any, Any, Any]:
        """Friction over the step that begins now; one call per step.

        Args:
            q: position at the start of the step, rad (m), of `shape`, single or double precision.
            v: velocity there, rad/s (m/s), of `shape`. h: length of the step, s.
        Returns:
            torque, N m (N), stiffness, N m/rad, and damping, N m s/rad, with the array type and
            precision of q. Doubles on the CPU are not copied; single precision is computed in
            doubles. A NaN in q or v makes all three of its joint NaN, until that joint is `reset`.
        Raises:
            ParameterError: another shape or device, or h is not positive.
        """
        if not (np.isfinite(h) and h > 0.0):
            raise ParameterError(f"step of {h!r} s: give a positive number")
        if self._warp is not None:
            found: tuple[Any, Any, Any] = self._warp.step(q, v, float(h), self.shape)
            return found
        position, velocity = self._array("q", q), self._array("v", v)
        if velocity.dtype != position.dtype:
            raise ParameterError(f"q is of {position.dtype}, v of {velocity.dtype}: make them one")
        made = [np.empty(self.shape) for _ in range(3)]
        step_all(
            self._P,
            self._blocks,
            self._ends,
            self.state.reshape(-1),
            self._stride,
            # doubles are read where they lie
            position.astype(np.float64, copy=False).reshape(-1),
            velocity.astype(np.float64, copy=False).reshape(-1),
            float(h),
            ROUNDING if position.dtype == np.float32 else 0.0,
            *(x.reshape(-1) for x in made),
        )
        torque, stiffness, damping = (like(q, x.astype(position.dtype, copy=False)) for x in made)
        return torque, stiffness, damping

    def reset(self, mask: Any = None) -> None:
        """Reset joints to rest, as if they had never moved.

        Args:
            mask: of `shape`, or (worlds,), True for joints to reset; None: all.
        """
        chosen = np.ones(self.shape, dtype=bool)
        if mask is not None:
            given = np.asarray(mask.cpu() if hasattr(mask, "cpu") else mask, dtype=bool)
            chosen = np.broadcast_to(
                given[:, None] if given.ndim < chosen.ndim else given, self.shape
            )
        if self._warp is not None:
            self._warp.reset(chosen.reshape(-1))
        else:
            self.state[chosen.reshape(-1)] = 0.0

    def _array(self, name: str, x: Any) -> NDArray[Any]:
        """A numpy view of an array on the CPU."""
        if not isinstance(x, np.ndarray):
            if not hasattr(x, "__dlpack__"):
                raise TypeError(f"{name} is of type {type(x).__name__}: give an array")
            if int(x.__dlpack_device__()[0]) != 1:  # DLPack's number of the CPU
                raise ParameterError(
                    f"{name} is not on the CPU: make FrictionBatch(..., device='cuda:0')"
                )
            try:
                x = np.from_dlpack(x)
            except (BufferError, RuntimeError) as error:
                raise ParameterError(f"{name} cannot be read through DLPack: {error}") from None
        if x.shape != self.shape or x.dtype not in (np.float32, np.float64):
            raise ParameterError(
                f"{name} is of shape {x.shape} and {x.dtype}: give {self.shape}, single or double "
                "precision"
            )
        return np.ascontiguousarray(x)
