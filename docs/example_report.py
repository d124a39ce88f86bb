"""The report that `frictionjoint demo` writes, for the page on reading one.

Run by mkdocs (gen-files) when the site is built; nothing it writes is committed.
"""

from importlib.resources import files
from pathlib import Path

import mkdocs_gen_files

from frictionjoint import close_loop
from frictionjoint.report.folder import made
from frictionjoint.report.page import render

DEMO = Path(str(files("frictionjoint"))) / "demo"

report = close_loop(
    [DEMO / "pick_and_place.csv", DEMO / "ramps.csv"],
    DEMO / "joint.xml",
    "joint",
    [DEMO / "multisine.csv"],
)
with mkdocs_gen_files.open("example/report.html", "w") as file:
    file.write(render(report, report.to_dict() | {"made": made("frictionjoint demo")}))
