"""A pair of errors."""

from dataclasses import dataclass

from frictionjoint.diagnose.decisions import APART


@dataclass(frozen=True)
class Rms:
    """A pair of errors, on the logs fitted and on those held out."""

    fit: float | None
    held_out: float | None

    def worse_than(self, before: "Rms") -> bool:
        """Whether held-out logs have more of it; where there are none, they contradict nothing."""
        if self.held_out is None or before.held_out is None:
            return False
        return self.held_out > before.held_out

    @property
    def only_fitted(self) -> bool:
        """Whether logs fitted have less than half of what logs held out have: it predicts them
        badly, however little is left where it was fitted."""
        if self.fit is None or self.held_out is None:
            return False
        return self.fit < APART * self.held_out

    def to_dict(self) -> dict[str, float | None]:
        """As in report.json."""
        return {"fit": self.fit, "held_out": self.held_out}
