"""A zero-phase low-pass filter, its derivatives and a delay, all exact at every frequency.

The response is applied to the discrete spectrum, so a filtered derivative equals the derivative of
the filtered signal to rounding: both sides of a torque balance pass the same operator.

A log is unknown beyond its ends, and the assumed continuation affects samples near the ends. The
range depends on the response; a sharp cut-off rings through the whole log.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, next_fast_len, rfft

from frictionjoint.arrays import Array, Index, Vector
from frictionjoint.compiled import compiled, pointer


class Spectrum(NamedTuple):
    """Spectra without the line through first and last values: `values`, (logs, rows, frequencies),
    and `ends`, (logs, rows, 2)."""

    values: NDArray[np.complex128]
    ends: Array


# periods of the corner over which the unknown continuation of a log affects what a filter passes
REACH = 2.0
# amplitude by frequency over the corner, at which it is one half
Response = Callable[[Array], Array]


def steep(ratio: Array) -> Array:
    """Flat up to half of the corner (99.6% passes); 0.4% passes at twice the corner."""
    return np.asarray(1.0 / (1.0 + ratio**8))


def gentle(ratio: Array) -> Array:
    """A raised cosine, zero above twice the corner: four samples a period represent it completely.
    The unknown signal beyond a log's ends has an influence of 0.4% of the kernel's peak at one
    period of the corner from the end, and of 0.05% at two."""
    return np.asarray(np.cos(0.25 * np.pi * np.minimum(ratio, 2.0)) ** 2)


@dataclass(frozen=True)
class LowPass:
    """A zero-phase filter.

    Attributes:
        n: samples of the signals. dt: sampling interval, s. corner_hz: half of the amplitude
            passes.
        response: amplitude, `gentle` or `steep`.
        step: one in `step` samples is returned. up: first, so many are interpolated for each.
    """

    n: int
    dt: float
    corner_hz: float
    response: Response
    step: int = 1
    up: int = 1

    def __call__(self, x: Array, derivative: int = 0) -> Array:
        """The filtered signal, shape (n,) or (n, k), along axis 0, or a derivative of it by time,
        shape (m,) or (m, k), with m = ceil(((n - 1) up + 1) / step)."""
        rows = x.reshape(self.n, int(np.prod(x.shape[1:]))).T
        found = self._alone.back(self._alone.spectra(rows), derivative)
        return found.T if x.ndim > 1 else found[0]

    def spectrum(self, x: Array) -> Spectrum:
        """Spectrum of a signal, shape (n,)."""
        (found,) = self._alone.spectra(x[None])
        return found

    def back(
        self,
        spectrum: Spectrum,
        derivative: int = 0,
        delay: float = 0.0,
        weight: Callable[[Array], Array] | None = None,
    ) -> Array:
        """The filtered signal of a spectrum, differentiated and delayed by `delay` seconds, shape
        (m,), with a `weight` of the amplitude by angular frequency, rad/s, 1 at zero."""
        return np.asarray(self._alone.back([spectrum], derivative, delay, weight)[0])

    def motion(
        self, position: Array, weight: Callable[[Array], Array] | None = None
    ) -> tuple[Array, Array, Array]:
        """A filtered position, velocity and acceleration, the last with a weight, see `back`."""
        spectrum = self.spectrum(position)
        q, v = self.back(spectrum), self.back(spectrum, 1)
        return q, v, self.back(spectrum, 2, 0.0, weight)

    @cached_property
    def _alone(self) -> "LowPasses":
        return LowPasses([self])

    @property
    def given(self) -> int:
        """Number of returned samples."""
        return (self.n - 1) * self.up // self.step + 1

    @cached_property
    def fade(self) -> Array:
        """Weight of the continuation beyond the ends, from 0 far away to 1 at the signal."""
        return np.asarray(np.sin(0.5 * np.pi * np.linspace(0.0, 1.0, self.pad + 1)[1:]) ** 2)

    @cached_property
    def pad(self) -> int:
        """Number of samples of the continuation before the beginning."""
        # a signal is continued at its ends by three periods of the corner
        wanted = min(self.n - 1, max(8, int(3.0 / (self.corner_hz * self.dt))))
        return max(1, wanted // self.step) * self.step if wanted >= self.step else 0

    @property
    def tail(self) -> int:
        """Number of samples of the continuation after the end."""
        return min(self.length - self.pad - self.n, self.pad)

    @cached_property
    def length(self) -> int:
        """Number of samples of the Fourier transform."""
        return self.step * int(next_fast_len(-(-(self.n + 2 * self.pad) // self.step), real=True))

    @cached_property
    def omega(self) -> Array:
        """Angular frequencies of the transform, rad/s."""
        found = 2.0 * np.pi * np.arange(self.length // 2 + 1) / (self.length * self.dt)
        return np.asarray(found, dtype=np.float64)

    @cached_property
    def amplitude(self) -> Array:
        """Amplitudes at these frequencies."""
        return self.response(self.omega / (2.0 * np.pi * self.corner_hz))


class LowPasses:
    """Filters of several logs with concatenated signals."""

    def __init__(self, filters: Sequence[LowPass]) -> None:
        alike: dict[tuple[int, int, int], list[list[int]]] = {}
        for i, one in enumerate(filters):
            groups = alike.setdefault((one.length, one.step, one.up), [[]])
            # 40_000: samples of a row in one transform: with more of them the processor's cache
            # holds no more what comes of one step for the next (30 logs of 3,600: 1.9 ms, in two
            # parts 0.7 ms)
            if len(groups[-1]) * one.length >= 40_000:
                groups.append([])
            groups[-1].append(i)
        begin, back = places([f.n for f in filters]), places([f.given for f in filters])
        self._groups = [
            _Alike([filters[i] for i in at], [begin[i] for i in at], [back[i] for i in at])
            for groups in alike.values()
            for at in groups
        ]
        self._count = back[-1].stop

    def __call__(self, x: Array) -> Array:
        """Filter each row of n samples of all logs, shape (k, n) to (k, m)."""
        return self.back(self.spectra(x))

    def spectra(self, x: Array) -> list[Spectrum]:
        """Spectra of rows of signals, in the order of the groups of filters."""
        rows = np.ascontiguousarray(x, dtype=np.float64)
        return [group.spectrum(rows) for group in self._groups]

    def back(
        self,
        spectra: Sequence[Spectrum],
        derivative: int = 0,
        delay: float = 0.0,
        weight: Callable[[Array], Array] | None = None,
    ) -> Array:
        """The filtered signals of spectra, see `LowPass.back`, shape (k, m)."""
        out = np.empty((spectra[0].ends.shape[1], self._count))
        for group, spectrum in zip(self._groups, spectra, strict=True):
            group.fill_back(spectrum, derivative, delay, weight, out)
        return out


class _Alike:
    """Filters with transforms of one length; slices of their logs in the input and output."""

    def __init__(
        self, filters: Sequence[LowPass], begin: Sequence[slice], back: Sequence[slice]
    ) -> None:
        first = filters[0]
        self._length, self._step, self._up = first.length, first.step, first.up
        self._m = self._length * self._up // self._step
        k = min(self._m, self._length) // 2 + 1
        self._omega = np.array([f.omega[:k] for f in filters])
        self._amplitude = np.array([f.amplitude[:k] for f in filters])
        self._dt = np.array([f.dt for f in filters])
        n, pad, tail = (np.array([getattr(f, x) for f in filters]) for x in ("n", "pad", "tail"))
        self._fade = np.zeros((len(filters), max(pad)))
        for fade, f in zip(self._fade, filters, strict=True):
            fade[: f.pad] = f.fade
        self._given = np.array([own.start for own in begin]), n, pad, tail
        where = np.array([own.start for own in back])
        self._back = where, np.array([f.given for f in filters]), pad * self._up // self._step, n

    def spectrum(self, x: Array) -> Spectrum:
        """Spectrum of the part of each log in every row."""
        whole = np.zeros((len(self._dt), len(x), self._length))
        ends = np.empty((len(self._dt), len(x), 2))
        _fill_continued(x, *self._given, self._fade, whole, ends)
        return Spectrum(np.asarray(rfft(whole, axis=2, overwrite_x=True)), ends)

    def fill_back(
        self,
        spectrum: Spectrum,
        derivative: int,
        delay: float,
        weight: Callable[[Array], Array] | None,
        out: Array,
    ) -> None:
        """Write the filtered part of each log into every row of `out`."""
        response = self._amplitude
        if weight is not None:
            response = response * weight(self._omega)
        if derivative:
            response = response * (1j * self._omega) ** derivative
        if delay:
            response = response * np.exp(-1j * delay * self._omega)
        passed = spectrum.values[:, :, : response.shape[1]] * response[:, None]
        found = np.asarray(irfft(passed, self._m, axis=2, overwrite_x=True))
        times = float(self._step), self._dt, float(self._up), delay
        _fill_back(found, spectrum.ends, *self._back, *times, derivative, out)


def places(lengths: Sequence[int]) -> list[slice]:
    """Slice of each log in the concatenation of all."""
    ends = np.cumsum(lengths).tolist()
    return [slice(end - n, end) for n, end in zip(lengths, ends, strict=True)]


@compiled
def _fill_continued(
    x: Array,
    begin: Index,
    n: Index,
    pad: Index,
    tail: Index,
    fade: Array,
    whole: Array,
    ends: Array,
) -> None:
    """Fill `whole`, zeros of shape (logs, k, m), with the rows x, shape (k, n), of all logs without
    their chords, reflected about both ends and faded out.

    Without the line through its first and last sample, `ends`, shape (logs, k, 2), a signal
    continues with the same value and slope when it is rotated about its ends.
    """
    for i in range(len(n)):
        a, count, before = begin[i], n[i], pad[i]
        for k in range(len(x)):
            row = pointer(x, k * x.shape[1] + a)
            out = pointer(whole, (i * whole.shape[1] + k) * whole.shape[2])
            first, last = row[0], row[count - 1]
            ends[i, k, 0], ends[i, k, 1] = first, last
            slope = (last - first) / (count - 1)
            for j in range(count):
                out[before + j] = row[j] - first - slope * j
            for j in range(before):
                out[before - 1 - j] = -fade[i, before - 1 - j] * out[before + 1 + j]
            for j in range(tail[i]):
                out[before + count + j] = -fade[i, before - 1 - j] * out[before + count - 2 - j]


@compiled
def _fill_back(
    x: Array,
    ends: Array,
    begin: Index,
    given: Index,
    first: Index,
    n: Index,
    step: float,
    dt: Vector,
    up: float,
    delay: float,
    derivative: int,
    out: Array,
) -> None:
    """Fill `out` with the signals of inverse transforms, (logs, k, m), including their chords."""
    for i in range(len(n)):
        a, b = begin[i], first[i]
        for k in range(len(out)):
            slope = (ends[i, k, 1] - ends[i, k, 0]) / ((n[i] - 1) * dt[i])
            at_first = ends[i, k, 0] - slope * delay
            for j in range(given[i]):
                found = x[i, k, b + j] * (up / step)
                if derivative == 0:
                    found = found + slope * (j * step * (dt[i] / up)) + at_first
                elif derivative == 1:
                    found = found + slope
                out[k, a + j] = found
