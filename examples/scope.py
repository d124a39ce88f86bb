"""Plots of a joint's friction while it runs: torque over time, hysteresis loop, stick or slip.

They use MuJoCo's own figures, so the same `Scope` serves the interactive viewer
(``handle.set_figures(scope.figures(handle.viewport))``) and off-screen rendering.
"""

from collections import deque
from dataclasses import dataclass

import mujoco
import numpy as np

import frictionjoint as fj
from frictionjoint.arguments import require_model
from frictionjoint.errors import ModelError
from frictionjoint.simulate.carrier import read_friction

STICK_COLOUR = (0.10, 0.75, 0.55)
SLIP_COLOUR = (0.95, 0.45, 0.10)
# samples of one figure
_SAMPLES = mujoco.mjMAXLINEPNT - 1


@dataclass(frozen=True)
class Sample:
    """Friction at one instant.

    Attributes:
        time: s. position: rad. velocity: rad/s. torque: N m, opposing motion.
        sticks: see `frictionjoint.torque`. depth: extrema in memory, without the limits.
    """

    time: float
    position: float
    velocity: float
    torque: float
    sticks: bool
    depth: int


class Scope:
    """The last seconds of one joint's friction.

    Args:
        model: attached, or resolved by `load_model`.
        joint: a joint that carries friction.
        seconds: how far back the figures reach.
    Raises:
        ModelError: the joint has no friction, or another law than the integrated one.
    """

    def __init__(self, model: mujoco.MjModel, joint: str, seconds: float = 5.0) -> None:
        require_model(model, "Scope")
        carried = read_friction(model)
        if joint not in carried:
            raise ModelError(
                f"joint {joint!r} has no friction: choose from {', '.join(carried) or 'none'}"
            )
        self.model, self.joint, self.seconds = model, joint, seconds
        self._id = model.joint(joint).id
        self._q, self._v = int(model.jnt_qposadr[self._id]), int(model.jnt_dofadr[self._id])
        law = carried[joint].parameters
        if not isinstance(law, fj.FrictionParameters):
            raise ModelError(f"joint {joint!r} has the law {law.law}: only integrated is drawn")
        # the loop is looked at through a window as wide as presliding reaches
        self._window = law.knots[-1][0]
        slide = model.jnt_type[self._id] == mujoco.mjtJoint.mjJNT_SLIDE
        self._units = ("m", "N") if slide else ("rad", "N m")
        self._every = seconds / _SAMPLES
        self._samples: deque[Sample] = deque(maxlen=_SAMPLES)

    def record(self, data: mujoco.MjData) -> Sample:
        """Read the joint's state after a step; if time goes back, the figures are cleared."""
        friction = fj.torque(self.model, data)[self.joint]
        memory = fj.remembered(self.model, data)[self.joint]
        sample = Sample(
            float(data.time),
            float(data.qpos[self._q]),
            float(data.qvel[self._v]),
            friction.total,
            friction.sticks,
            memory.minima + memory.maxima,
        )
        if self._samples and sample.time < self._samples[-1].time:
            self._samples.clear()
        if not self._samples or sample.time - self._samples[-1].time >= 0.999 * self._every:
            self._samples.append(sample)
        return sample

    def figures(self, viewport: mujoco.MjrRect) -> list[tuple[mujoco.MjrRect, mujoco.MjvFigure]]:
        """Torque over time and the hysteresis loop, in the lower corners of the viewport.

        The loop is drawn around the position where the joint last stuck.
        """
        position, torque = self._units
        width, height = viewport.width * 2 // 5, viewport.height * 2 // 5
        bottom = viewport.bottom
        left = mujoco.MjrRect(viewport.left, bottom, width, height)
        right = mujoco.MjrRect(viewport.left + viewport.width - width, bottom, width, height)
        now = self._samples[-1].time if self._samples else 0.0
        over_time = _figure(f"{self.joint}: friction, {torque}", "time, s")
        home = next((s.position for s in reversed(self._samples) if s.sticks), 0.0)
        loop = _figure(
            f"{self.joint}: hysteresis, {torque}", f"m{position} about {home:.4f} {position}"
        )
        _draw(over_time, [(s.time - now, s.torque, s.sticks) for s in self._samples])
        away = [(1e3 * (s.position - home), s.torque, s.sticks) for s in self._samples]
        reach = 1e3 * self._window
        _draw(loop, [p if abs(p[0]) <= reach else None for p in away])
        over_time.range[0] = (-self.seconds, 0.0)
        loop.range[0] = (-reach, reach)
        return [(left, over_time), (right, loop)]

    def text(self, sample: Sample) -> tuple[str, str]:
        """Names and values for an overlay, one line each."""
        position, torque = self._units
        rows = {
            self.joint: "sticks" if sample.sticks else "SLIPS",
            "friction": f"{sample.torque:.3f} {torque}",
            "position": f"{sample.position:.6f} {position}",
            "velocity": f"{sample.velocity:.6f} {position}/s",
            "remembered": f"{sample.depth} extrema",
        }
        return "\n".join(rows), "\n".join(rows.values())

    def mark(
        self, scene: mujoco.MjvScene, model: mujoco.MjModel, data: mujoco.MjData, sample: Sample
    ) -> None:
        """Add a disc across the joint's axis to a scene: green sticks, orange slips.

        A full scene is left as it is.
        """
        if scene.ngeom >= scene.maxgeom:
            return
        colour = STICK_COLOUR if sample.sticks else SLIP_COLOUR
        rgba = np.array([*colour, 0.5], dtype=np.float32)
        size = np.array([0.25, 0.002, 0.0]) * float(model.stat.extent)
        quaternion, frame = np.zeros(4), np.zeros(9)
        mujoco.mju_quatZ2Vec(quaternion, data.xaxis[self._id])
        mujoco.mju_quat2Mat(frame, quaternion)
        kind = mujoco.mjtGeom.mjGEOM_CYLINDER
        place = data.xanchor[self._id]
        mujoco.mjv_initGeom(scene.geoms[scene.ngeom], kind, size, place, frame, rgba)
        scene.ngeom += 1


def _figure(title: str, xlabel: str) -> mujoco.MjvFigure:
    figure = mujoco.MjvFigure()
    mujoco.mjv_defaultFigure(figure)
    figure.title, figure.xlabel = title, xlabel
    figure.figurergba[:] = (0.08, 0.09, 0.11, 0.85)
    figure.panergba[:] = (0.15, 0.16, 0.19, 0.85)
    figure.xformat, figure.yformat = "%.3g", "%.3g"
    figure.gridsize[:] = (5, 5)
    figure.flg_extend = 1
    figure.flg_legend = 1
    return figure


def _draw(figure: mujoco.MjvFigure, points: list[tuple[float, float, bool] | None]) -> None:
    """One line for every stretch of sticking or slipping; None is a gap.

    Where stretches are more than a figure holds the oldest are left out.
    """
    runs: list[tuple[bool, list[tuple[float, float]]]] = []
    previous = None
    for point in points:
        if point is not None:
            x, y, sticks = point
            if previous is None or previous[2] != sticks:
                # a stretch begins where the last one ended, so that the curve is whole
                runs.append((sticks, [] if previous is None else [previous[:2]]))
            runs[-1][1].append((x, y))
        previous = point
    named: set[bool] = set()
    for i, (sticks, run) in enumerate(runs[-mujoco.mjMAXLINE :]):
        figure.linedata[i, : 2 * len(run)] = np.array(run, dtype=np.float32).ravel()
        figure.linepnt[i] = len(run)
        figure.linergb[i] = STICK_COLOUR if sticks else SLIP_COLOUR
        if sticks not in named:
            figure.linename[i] = "stick" if sticks else "slip"
            named.add(sticks)
