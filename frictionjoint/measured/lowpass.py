"""A zero-phase low-pass filter, its derivatives and a delay, all exact at every frequency.

The response is applied to the discrete spectrum, so that a filtered derivative is the derivative of
the filtered signal to rounding: whatever is balanced passes the same operator.

Beyond its ends a log is not known, and what a filter makes of its continuation spoils what is near
them. How near is a matter of the response: one that is cut off, by itself or by the coarser grid of
what it gives back, rings for the whole log.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from frictionjoint.arrays import Array
from frictionjoint.compiled import compiled

Spectrum = NDArray[np.complex128]
# amplitude by frequency over the corner, at which it is one half
Response = Callable[[Array], Array]

# periods of the corner by which a signal is continued at its ends
_CONTINUED = 3.0


def steep(ratio: Array) -> Array:
    """Flat up to half of the corner, where 99.6% passes; at its double 0.4% does."""
    return np.asarray(1.0 / (1.0 + ratio**8))


def gentle(ratio: Array) -> Array:
    """A raised cosine, zero from twice the corner: of four samples a period nothing is cut off.

    Of what is beyond the ends of a log 0.4% of its kernel's peak is seen a period of the corner
    away, and 0.05% two periods away.
    """
    return np.asarray(np.cos(0.25 * np.pi * np.minimum(ratio, 2.0)) ** 2)


@dataclass(frozen=True)
class LowPass:
    """A filter without phase.

    Attributes:
        n: samples of the signals. dt: s between them. corner_hz: half of the amplitude passes.
        response: amplitude, `gentle` or `steep`.
        step: one in `step` samples is given back. up: so many are given back for each, and then
            one in `step` of those.
    """

    n: int
    dt: float
    corner_hz: float
    response: Response
    step: int = 1
    up: int = 1

    def __call__(self, x: Array, derivative: int = 0) -> Array:
        """Filter along axis 0.

        Args:
            x: shape (n,) or (n, k). derivative: of the filtered signal by time.
        Returns:
            shape (m,) or (m, k), with m = ceil(((n - 1) up + 1) / step).
        """
        return self.back(self.spectrum(x), derivative)

    def spectrum(self, x: Array) -> tuple[Spectrum, Array]:
        """Of a signal without its chord, and the chord's first and last value.

        Without the line through its first and last sample a signal goes on evenly when it is turned
        about its ends, which keeps its value and its slope.
        """
        ends = np.array([x[0], x[-1]])
        count = int(np.prod(x.shape[1:]))
        columns = np.ascontiguousarray(x, dtype=np.float64).reshape(self.n, count)
        whole = np.zeros((self._length, count))
        continued(columns, self._fade, self._tail, whole)
        whole = whole.reshape(self._length, *x.shape[1:])
        return np.asarray(rfft(whole, axis=0, overwrite_x=True)), ends

    def back(
        self,
        spectrum: tuple[Spectrum, Array],
        derivative: int = 0,
        delay: float = 0.0,
        weight: Callable[[Array], Array] | None = None,
    ) -> Array:
        """The filtered signal of a spectrum, differentiated, `delay` seconds late.

        Args:
            weight: amplitude by angular frequency, rad/s, 1 at zero.
        """
        values, ends = spectrum
        m = self._length * self.up // self.step
        k = min(m, self._length) // 2 + 1
        response = self._amplitude[:k]
        if weight is not None:
            response = response * weight(self._omega[:k])
        if derivative:
            response = response * (1j * self._omega[:k]) ** derivative
        if delay:
            response = response * np.exp(-1j * delay * self._omega[:k])
        kept = values[:k] * response.reshape(-1, *(1,) * (values.ndim - 1))
        out = irfft(kept, m, axis=0, overwrite_x=True)
        out *= self.up / self.step
        count = len(self._time)
        first = self._pad * self.up // self.step
        found = out[first : first + count]
        slope = (ends[1] - ends[0]) / ((self.n - 1) * self.dt)
        if derivative == 0:
            found += self._time.reshape(-1, *(1,) * (values.ndim - 1)) * slope
            found += ends[0] - slope * delay
        elif derivative == 1:
            found += slope
        return np.asarray(found)

    @cached_property
    def _time(self) -> Array:
        """Of the samples given back, s."""
        at = np.arange(0, (self.n - 1) * self.up + 1, self.step, dtype=np.float64)
        return np.asarray(at * (self.dt / self.up))

    @cached_property
    def _fade(self) -> Array:
        return np.asarray(np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, self._pad + 1)[1:]) ** 2)

    @cached_property
    def _pad(self) -> int:
        wanted = min(self.n - 1, max(8, int(_CONTINUED / (self.corner_hz * self.dt))))
        return max(1, wanted // self.step) * self.step if wanted >= self.step else 0

    @property
    def _tail(self) -> int:
        """Samples by which a signal is continued at its end."""
        return min(self._length - self._pad - self.n, self._pad)

    @cached_property
    def _length(self) -> int:
        return self.step * int(next_fast_len(-(-(self.n + 2 * self._pad) // self.step), real=True))

    @cached_property
    def _omega(self) -> Array:
        found = 2.0 * np.pi * np.arange(self._length // 2 + 1) / (self._length * self.dt)
        return np.asarray(found, dtype=np.float64)

    @cached_property
    def _amplitude(self) -> Array:
        return self.response(self._omega / (2.0 * np.pi * self.corner_hz))


@compiled
def continued(x: Array, fade: Array, tail: int, whole: Array) -> None:
    """Fill `whole` with columns without their chords, turned about both ends and faded out.

    Args:
        x: shape (n, k). fade: shape (pad,), from 0 at the end of a continuation to 1 at the signal.
        tail: samples of the continuation behind the signal. whole: zeros, shape (m, k).
    """
    n, pad = len(x), len(fade)
    for k in range(x.shape[1]):
        first, slope = x[0, k], (x[-1, k] - x[0, k]) / (n - 1)
        for i in range(n):
            whole[pad + i, k] = x[i, k] - first - slope * i
        for i in range(pad):
            whole[pad - 1 - i, k] = -fade[pad - 1 - i] * whole[pad + 1 + i, k]
        for i in range(tail):
            whole[pad + n + i, k] = -fade[pad - 1 - i] * whole[pad + n - 2 - i, k]
