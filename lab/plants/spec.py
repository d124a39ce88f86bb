"""What a trial plant is: frozen dataclasses."""

from __future__ import annotations

from dataclasses import dataclass, field

# m/s^2, as MuJoCo has it
GRAVITY = 9.81
LAWS = ("gms", "lugre", "elasto-plastic", "plain")
MOTIONS = ("steps", "ramps", "sines", "multisine", "pick-and-place", "stick-slip", "dwell")


@dataclass(frozen=True)
class Friction:
    """Friction of the plant, at the joint, in N m and rad.

    `asymmetry` scales the level up for v > 0 and down for v < 0. `presliding` is the displacement
    over which the virgin curve rises to Fs, so its initial stiffness is a small multiple of
    Fs / presliding.
    """

    law: str = "gms"
    Fs: float = 1.2
    Fc: float = 0.8
    Vs: float = 0.1
    delta: float = 1.0
    sigma2: float = 0.3
    presliding: float = 2e-3
    asymmetry: float = 0.0

    def __post_init__(self) -> None:
        if self.law not in LAWS:
            raise ValueError(f"friction law {self.law!r} is none of {', '.join(LAWS)}")
        if not self.Fs >= self.Fc > 0.0:
            raise ValueError(f"friction needs Fs >= Fc > 0, got Fs={self.Fs}, Fc={self.Fc}")


@dataclass(frozen=True)
class Motion:
    """One log's excitation: `kind`, its seed, amplitude rad, top speed rad/s, duration s.

    `center` is the middle of the motion in rad; `soft` scales the controller's gains.
    """

    kind: str
    seed: int
    amplitude: float
    speed: float
    duration: float
    center: float = 0.0
    soft: float = 1.0

    def __post_init__(self) -> None:
        if self.kind not in MOTIONS:
            raise ValueError(f"motion {self.kind!r} is none of {', '.join(MOTIONS)}")


@dataclass(frozen=True)
class Controller:
    """Position controller: torque = kp e + ki integral(e) - kd v, limited; 1 kHz, held."""

    kp: float
    kd: float
    ki: float = 0.0
    limit: float = 1e9


@dataclass(frozen=True)
class Instrument:
    """What is recorded: rate Hz, encoder counts per turn (0: no quantum), torque noise N m rms,
    jitter of the sampling instants as a fraction of the period (recorded in time_s)."""

    rate: float = 500.0
    counts: int = 65536
    torque_noise: float = 0.0
    jitter: float = 0.0


@dataclass(frozen=True)
class Effect:
    """One undeclared effect: a catalogue name or an out-of-catalogue kind, and its parameters."""

    name: str
    parameters: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class PlantSpec:
    """A trial plant. SI units at the joint.

    mass, length: link's mass kg and distance of its centre from the axis m (axis horizontal, the
    link hangs down at q = 0; length 0 means no gravity load). inertia: link about the axis,
    kg m^2. armature: rotor reflected to the joint, kg m^2. Mass, length, inertia and armature are
    what the user believes too; the truth differs only through `effects`.
    """

    mass: float
    length: float
    inertia: float
    armature: float
    friction: Friction
    controller: Controller
    motions: tuple[Motion, ...]
    instrument: Instrument
    seed: int
    effects: tuple[Effect, ...] = ()
    step: float = 1e-4

    def __post_init__(self) -> None:
        if self.inertia < self.mass * self.length**2:
            raise ValueError(f"inertia {self.inertia} is below mass*length^2")
        if len(self.effects) > 2:
            raise ValueError("a trial plant has at most two effects")

    @property
    def gravity_torque(self) -> float:
        """Largest gravity torque, N m."""
        return self.mass * GRAVITY * self.length

    @property
    def arm(self) -> float:
        """m from the axis to where an extra mass is put: 0.1 where the joint has no arm."""
        return self.length or 0.1
