"""`FrictionBatch` as a Warp kernel, made from the same source as the compiled code."""

# The annotations of kernels are warp's types, not Python's:
# mypy: ignore-errors

import functools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from frictionjoint.arrays import ROUNDING, Array, Index, like
from frictionjoint.batch_kernel import step_joint
from frictionjoint.effects.signals import N_SIGNALS
from frictionjoint.errors import ParameterError
from frictionjoint.translate.warp import translate


@functools.lru_cache(maxsize=4)
def _kernel(single: bool) -> Any:
    """The kernel for arrays in single or double precision."""
    import warp as wp

    real = wp.float32 if single else wp.float64
    joint = translate([step_joint], N_SIGNALS, f"frictionjoint_batch_{int(single)}")[
        "frictionjoint_batch_kernel_step_joint"
    ]

    @wp.kernel(enable_backward=False, module="unique")
    def step(
        P: wp.array(dtype=wp.float64),
        blocks: wp.array(dtype=int),
        ends: wp.array(dtype=int),
        X: wp.array2d(dtype=wp.float64),
        q: wp.array(dtype=real),
        v: wp.array(dtype=real),
        h: wp.float64,
        rounding: wp.float64,
        torque: wp.array(dtype=real),
        stiffness: wp.array(dtype=real),
        damping: wp.array(dtype=real),
    ):
        i = wp.tid()
        F, K, D = joint(
            P, blocks[i], ends[i], X[i], 0, wp.float64(q[i]), wp.float64(v[i]), h, rounding
        )
        torque[i] = real(F)
        stiffness[i] = real(K)
        damping[i] = real(D)

    return step


class WarpBatch:
    """State and constants of a batch on a device of Warp."""

    def __init__(self, device: str, P: Array, blocks: Index, ends: Index, stride: int) -> None:
        try:
            import warp as wp
        except ImportError as error:
            raise ParameterError(
                f"device {device!r} needs Warp ({error}): pip install 'frictionjoint[warp]'"
            ) from None
        self._wp, self.device = wp, wp.get_device(device)
        with wp.ScopedDevice(self.device):
            self._P = wp.array(P, dtype=wp.float64)
            self._blocks = wp.array(blocks, dtype=int)
            self._ends = wp.array(ends, dtype=int)
            # joints side by side: neighbouring threads then read neighbouring numbers
            self.state = wp.zeros((stride, len(blocks)), dtype=wp.float64).transpose()

    def step(self, q: Any, v: Any, h: float, shape: tuple[int, ...]) -> tuple[Any, Any, Any]:
        """One step of every joint on the device, in the form of `FrictionBatch.step`."""
        wp = self._wp
        position, velocity = (self._array(n, x, shape) for n, x in (("q", q), ("v", v)))
        single = position.dtype == wp.float32
        made = [wp.empty(shape, dtype=position.dtype, device=self.device) for _ in range(3)]
        # the law needs many registers, which small blocks waste least
        wp.launch(
            _kernel(single),
            dim=position.size,
            inputs=[
                *(self._P, self._blocks, self._ends, self.state),
                *(position.flatten(), velocity.flatten(), h, ROUNDING if single else 0.0),
            ],
            outputs=[x.flatten() for x in made],
            device=self.device,
            block_dim=1 if self.device.is_cpu else 128,
        )
        if isinstance(q, np.ndarray):
            return tuple(x.numpy() for x in made)
        return tuple(like(q, x) for x in made)

    def reset(self, chosen: NDArray[np.bool_]) -> None:
        """Reset joints to rest; chosen: of shape (joints in all,)."""
        state = self.state.numpy()
        state[chosen] = 0.0
        self.state.assign(state)

    def _array(self, name: str, x: Any, shape: tuple[int, ...]) -> Any:
        wp = self._wp
        if isinstance(x, np.ndarray):
            x = wp.array(x, device=self.device)
        elif not isinstance(x, wp.array):
            x = wp.from_dlpack(x)
        if tuple(x.shape) != shape or x.dtype not in (wp.float32, wp.float64):
            raise ParameterError(
                f"{name} is of shape {tuple(x.shape)}: give {shape}, single or double precision"
            )
        if x.device != self.device:
            raise ParameterError(f"{name} is on {x.device}, the batch on {self.device}: move it")
        return x.contiguous()
