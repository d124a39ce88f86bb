"""Pages of the documentation on the library of motors."""

import re
import statistics
from collections.abc import Sequence
from itertools import groupby

from frictionjoint.effects.catalogue import title
from frictionjoint.motors.library import Motor

HEAD = """# Library of motors

Motors and joints identified from public logs, each machine by one `frictionjoint close-loop`.

```
frictionjoint motors list
frictionjoint motors get ur10_j1 --out j1.toml
frictionjoint install ur10.xml --joint shoulder_pan=j1.toml --out ur10_with_friction.xml
```

Errors on held-out data, with the law alone and with the effects that were found:

* **torque**: rms error of the drive;
* **replay**: rms position error of free runs of half a second;
* **loop**: mean absolute position error of whole logs simulated from their target.

In a robot the second error is that of the MJCF with corrected bodies. Every motor holds a load at
rest. The verdict is that of the report; it is empty if it was not recorded.

`frictionjoint motors show NAME` prints the numbers of a motor with standard errors, the conditions
of the logs, what they do not determine, and what was assumed. The same remarks, and the variation
between units of one actuator, are in `lab/notes/motors.md` in the repository.

"""
TAIL = (
    "## How they were made",
    "",
    "`python scripts/make_motors.py --data DIR --out DIR` writes the library and its pages. If the",
    "controller is known, the numbers are refined by simulation: the error of whole logs (loop)",
    "of the XL330 is 0.0398 rad before; that of EMPS does not change. `--keep NAME` leaves the",
    "numbers of a machine or a motor as they are.",
    "",
)


def page(library: Sequence[Motor]) -> str:
    """The table of all motors, and what to know of each."""
    lines = [
        "| motor | effects | verdict | torque | replay | loop | licence of the logs |",
        "|---|---|---|---|---|---|---|",
    ]
    for motor in library:
        effects = ", ".join(title(x.effect.name) for x in motor.friction.effects) or "none"
        metre = "m" if motor.unit == "N" else "rad"
        verdict = motor.verdict.replace("-", " ")
        cells = [f"`{motor.name}`", effects, verdict]
        for kind, unit in (("torque", motor.unit), ("replay", metre), ("closed_loop", metre)):
            ends = [motor.fit.get(f"{kind}_held_out{when}") for when in ("_before", "")]
            shown = " to ".join(f"{x:.3g}" for x in ends if x is not None)
            cells.append(f"{shown} {unit}" if shown else "")
        lines.append(f"| {' | '.join([*cells, motor.licence])} |")
    return HEAD + "\n".join([*lines, "", *TAIL])


def remarks_page(library: Sequence[Motor]) -> str:
    """Remarks by machine: on all of its joints, then on single ones."""
    lines = [
        "# Remarks on the library of motors",
        "",
        "A number is not determined if its standard error is more than half of its value. Of "
        "several units of one actuator the entry is the one whose torque is explained best; their "
        "tables include different loads and the errors of the fits.",
        "",
    ]
    for machine, group in groupby(library, lambda x: x.title.removesuffix(f", {x.joint}")):
        joints = {motor.name: _sentences(motor.remark) for motor in group}
        of_all = [x for x in next(iter(joints.values())) if all(x in y for y in joints.values())]
        first = next(motor for motor in library if motor.name in joints)
        about = [f"[Logs]({first.source}).", first.conditions, *of_all]
        lines += [f"## {machine}", "", " ".join(filter(None, about)), ""]
        own = {name: [x for x in said if x not in of_all] for name, said in joints.items()}
        told = [f"* `{name}`: {' '.join(said)}" for name, said in own.items() if said]
        lines += [*told, ""] if told else []
        lines += _units(first)
    return "\n".join(lines)


def _units(motor: Motor) -> list[str]:
    """A table of the numbers of several units."""
    if not motor.units:
        return []
    symbols = list(next(iter(motor.units.values())))
    rows = [[unit, *(f"{x[key]:.3g}" for key in symbols)] for unit, x in motor.units.items()]
    spread = [[x[key] for x in motor.units.values()] for key in symbols]
    ends = [f"{statistics.fmean(x):.3g} ± {statistics.stdev(x):.2g}" for x in spread]
    rows.append(["mean ± deviation", *ends])
    head = f"| unit of `{motor.name}` | {' | '.join(symbols)} |"
    return [head, "|---" * (1 + len(symbols)) + "|", *(f"| {' | '.join(x)} |" for x in rows), ""]


def _sentences(remark: str) -> list[str]:
    """Each with its full stop."""
    return re.findall(r".+?\.(?=\s|$)", remark.replace(". ", ".\n"))
