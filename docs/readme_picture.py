"""The picture on the front page: torque of the demo's held-out log, before and after.

    python docs/readme_picture.py docs/img

Two files: before_after.svg, and before_after_narrow.svg for a phone.
"""

import sys
from importlib.resources import files
from pathlib import Path

import matplotlib

from frictionjoint.diagnose.close_loop import close_loop
from frictionjoint.diagnose.report_data import Report
from frictionjoint.report import wording
from frictionjoint.report.picture import COLOURS

matplotlib.use("svg")
from matplotlib import pyplot as plt


def draw(report: Report, path: Path, narrow: bool = False) -> None:
    """Torque and residual over time, with the error in per cent of the measured torque."""
    c = next(c for c in report.curves if c.role == "held-out")
    whole = report.drive_rms("after").held_out
    size = (4.4, 5.0) if narrow else (9, 4.4)
    figure, (above, below) = plt.subplots(2, 1, figsize=size, sharex=True, layout="constrained")
    above.plot(c.time, c.measured, color=COLOURS["measured"], lw=2.6, label="measured")
    for name, stage, colour, rms in (
        ("friction law alone", "before", COLOURS["before"], report.before_torque.held_out),
        (f"with {wording.title(report.added[0].effect)}", "after", COLOURS["after"],
         report.after_torque.held_out),
    ):  # fmt: skip
        percent = wording.percentage(rms, whole)
        y = getattr(c, stage)
        above.plot(c.time, y, color=colour, lw=1.1, label=f"{name}: error {percent}")
        below.plot(c.time, c.measured - y, color=colour, lw=1.0)
    above.set(ylabel="torque, N m", title="A log that the fit has not seen", xlim=(0.0, c.time[-1]))
    below.set(ylabel="error, N m", xlabel="time, s")
    for axes in (above, below):
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    above.legend(frameon=False, ncols=1 if narrow else 3, loc="upper right")
    above.set_ylim(top=(2.3 if narrow else 1.35) * float(c.measured.max()))
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    demo = Path(str(files("frictionjoint.demo")))
    fitted = [demo / f"{name}.csv" for name in ("pick_and_place", "ramps")]
    found = close_loop(fitted, demo / "joint.xml", "joint", [demo / "multisine.csv"])
    draw(found, Path(sys.argv[1]) / "before_after.svg")
    draw(found, Path(sys.argv[1]) / "before_after_narrow.svg", narrow=True)
