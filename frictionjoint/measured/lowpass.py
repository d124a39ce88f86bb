"""A zero-phase low-pass filter, its derivatives and a delay, all exact at every frequency.

The response is applied to the discrete spectrum, so that a filtered derivative is the derivative of
the filtered signal to rounding: whatever is balanced passes the same operator.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from frictionjoint.arrays import Array

Spectrum = NDArray[np.complex128]

# periods of the corner by which a signal is continued at its ends
_CONTINUED = 3.0


@dataclass(frozen=True)
class LowPass:
    """Amplitude response 1 / (1 + (f/corner)^order), no phase.

    Attributes:
        n: samples of the signals. dt: s between them. corner_hz: half of the amplitude passes.
        order: steepness; 4 rings hardly, 8 is flat up to half of the corner.
        step: one in `step` samples is given back. up: so many are given back for each, and then
            one in `step` of those.
    """

    n: int
    dt: float
    corner_hz: float
    order: int
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
        pad, n = self._pad, self.n
        tail = min(self._length - pad - n, pad)
        whole = np.zeros((self._length, *x.shape[1:]))
        rest = whole[pad : pad + n]
        np.multiply(self._parts.reshape(-1, *(1,) * (x.ndim - 1)), ends[0] - ends[1], out=rest)
        rest += x
        rest -= ends[0]
        fade = self._fade.reshape(-1, *(1,) * (x.ndim - 1))
        np.multiply(rest[pad:0:-1], -fade, out=whole[:pad])
        np.multiply(rest[-2 : -tail - 2 : -1], -fade[::-1][:tail], out=whole[pad + n :][:tail])
        return np.asarray(rfft(whole, axis=0, overwrite_x=True)), ends

    def back(
        self, spectrum: tuple[Spectrum, Array], derivative: int = 0, delay: float = 0.0
    ) -> Array:
        """The filtered signal of a spectrum, differentiated, `delay` seconds late."""
        values, ends = spectrum
        response = self._response * (1j * self._omega) ** derivative
        if delay:
            response = response * np.exp(-1j * self._omega * delay)
        m = self._length * self.up // self.step
        k = min(m, self._length) // 2 + 1
        kept = values[:k] * response[:k].reshape(-1, *(1,) * (values.ndim - 1))
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
    def _parts(self) -> Array:
        return np.arange(self.n) / (self.n - 1.0)

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

    @cached_property
    def _length(self) -> int:
        return self.step * int(next_fast_len(-(-(self.n + 2 * self._pad) // self.step), real=True))

    @cached_property
    def _omega(self) -> Array:
        found = 2.0 * np.pi * np.arange(self._length // 2 + 1) / (self._length * self.dt)
        return np.asarray(found, dtype=np.float64)

    @cached_property
    def _response(self) -> Array:
        ratio = self._omega / (2.0 * np.pi * self.corner_hz)
        return np.asarray(1.0 / (1.0 + ratio**self.order))
