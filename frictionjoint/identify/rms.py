"""A pair of errors."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Rms:
    """An error on fitted logs and on held-out logs."""

    fit: float | None
    held_out: float | None

    def worse_than(self, before: "Rms") -> bool:
        """Whether the error on held-out logs is larger; without held-out logs, False."""
        if self.held_out is None or before.held_out is None:
            return False
        return self.held_out > before.held_out

    @property
    def only_fitted(self) -> bool:
        """Whether the error on fitted logs is less than half of that on held-out logs, which the
        model then predicts badly, however small it is on fitted logs."""
        if self.fit is None or self.held_out is None:
            return False
        return self.fit < 0.5 * self.held_out

    def to_dict(self) -> dict[str, float | None]:
        """As in report.json."""
        return {"fit": self.fit, "held_out": self.held_out}
