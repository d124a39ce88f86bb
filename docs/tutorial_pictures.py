"""The pictures of the tutorial, drawn by the package from the recording that it uses.

python docs/tutorial_pictures.py docs/img/tutorial
"""

import io
import sys
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

from frictionjoint import close_loop, plot, read_log
from frictionjoint.report.picture import picture

RECORDING = Path(__file__).resolve().parents[1] / "examples" / "recording"
COLUMNS = {"time_s": "stamp", "position_rad": "q_meas", "torque_nm": "tau_meas"}


def write(file: Path, figure: Figure) -> None:
    """At most 1000 pixels wide and high, 64 colours: a fifth of the bytes."""
    image = Image.open(io.BytesIO(picture(figure, "png"))).convert("RGB")
    image.thumbnail((1000, 1000))
    image.quantize(64).save(file, optimize=True)


def main(folder: Path) -> None:
    """Draw the first log and the report."""
    ramps, moves, sines = (
        read_log(RECORDING / f"{name}.csv", "elbow", COLUMNS)
        for name in ("ramps", "pick_and_place", "multisine")
    )
    write(folder / "plot.png", plot(ramps))
    report = close_loop([ramps, moves], RECORDING / "arm.xml", "elbow", held_out=[sines])
    write(folder / "predicted.png", report.plot())


if __name__ == "__main__":
    main(Path(sys.argv[1]))
