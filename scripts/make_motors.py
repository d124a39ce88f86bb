"""The library of motors, frictionjoint/motors/*.toml, from a folder of public logs.

    python scripts/make_motors.py --data DIR --out DIR [--only xl330]

Each source is one command, `frictionjoint close-loop`; its report goes to a folder of --out, and
one that has a report is not run again. A motor's file holds friction from the report's model.xml
and a digest of its report.json. The logs themselves are not part of the package. docs/motors.md,
the table of the whole library, is written again each time.
"""

import argparse
import hashlib
import json
import math
import statistics
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import tomlkit
from motor_pages import page, remarks_page
from motor_sources import SOURCES, Presliding, Source

from frictionjoint.files import toml_document
from frictionjoint.joint_friction import JointFriction
from frictionjoint.motors.library import TEXTS, Motor, list_motors
from frictionjoint.parameters import FrictionParameters
from frictionjoint.report.numbers import effect_estimates, law_numbers, result_estimates, status_of
from frictionjoint.simulate.carrier import load_model, read_friction

ROOT = Path(__file__).resolve().parents[1]
LIBRARY = ROOT / "frictionjoint/motors"
PAGE = ROOT / "docs/motors.md"
REMARKS = ROOT / "lab" / "notes" / "motors.md"


def arguments(source: Source, logs: Sequence[str], held_out: Sequence[str]) -> list[str]:
    """Of `frictionjoint close-loop`, without --out; paths from the root of the checkout."""
    made = [*logs]
    for text in source.model:
        pattern, _, name = text.rpartition("=")
        made += ["--model", f"{pattern}=models/{name}" if pattern else f"models/{name}"]
    if source.joint:
        made += ["--joint", source.joint]
    if source.controller:
        file = source.controller.endswith(".toml")
        made += ["--controller", f"models/{source.controller}" if file else source.controller]
        made += [] if source.refine else ["--no-refine"]
    made += [x for column in source.columns for x in ("--column", column)]
    made += [x for log in held_out for x in ("--held-out", log)]
    return made


def found(data: Path, patterns: tuple[str, ...] | float) -> list[str]:
    """The logs of some patterns, in order; a fraction is itself.

    Raises:
        SystemExit: a pattern without a log.
    """
    if isinstance(patterns, float):
        return [f"{patterns:g}"]
    logs: list[str] = []
    for pattern in patterns:
        paths = sorted(data.glob(pattern))
        if not paths:
            raise SystemExit(f"{data / pattern}: no such log")
        logs += [str(path.resolve()) for path in paths]
    return logs


def digest(paths: Sequence[str]) -> str:
    """SHA-256 of files, and of what folders hold, in order."""
    whole = hashlib.sha256()
    for path in map(Path, paths):
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file():
                whole.update(file.read_bytes())
    return whole.hexdigest()


def run(source: Source, data: Path, out: Path) -> None:
    """The command, and next to its report the commit that ran it; what has a report stays."""
    if (out / "report.json").exists():
        return
    asked = arguments(source, found(data, source.logs), found(data, source.held_out))
    start = [sys.executable, "-c", "from frictionjoint.cli import main; main()", "close-loop"]
    subprocess.run([*start, *asked, "--out", str(out)], check=True, cwd=ROOT)
    asked_git = ["git", "rev-parse", "--short=12", "HEAD"]
    commit = subprocess.run(asked_git, check=True, cwd=ROOT, capture_output=True, text=True).stdout
    (out / "version.txt").write_text(commit)


def errors(report: dict[str, Any]) -> dict[str, float]:
    """What a report left, before and after, by name; four digits."""
    kept: dict[str, float] = {}
    kinds = {"torque_rms": "torque", "replay_rms": "replay", "closed_loop_mae": "closed_loop"}
    for key, name in kinds.items():
        for part in ("fit", "held_out"):
            for when, end in (("before", "_before"), ("after", "")):
                value = report[when].get(key, {}).get(part)
                if value is not None:
                    kept[f"{name}_{part}{end}"] = float(f"{value:.4g}")
    for part, value in report.get("drive", {}).get("rms", {}).get("after", {}).items():
        if value is not None:
            kept[f"drive_{part}"] = float(f"{value:.4g}")
    return kept


def parameters(report: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Value and standard error by name: the refined ones where the refinement was taken."""
    refined = report.get("refined", {"taken": False})
    found = refined if refined["taken"] else report["after"]
    return dict(found["parameters"])


def added(report: dict[str, Any]) -> dict[str, dict[str, float]]:
    """Numbers of the effects that a report added, and the motor's constant; four digits."""
    now = parameters(report)
    kept: dict[str, dict[str, float]] = {}
    for x in report["added"]:
        name = x["effect"]
        own = {key: y["value"] for key, y in x["parameters"].items()}
        own |= {k.removeprefix(f"{name} "): y["value"] for k, y in now.items() if name in k.split()}
        kept[name] = {key: float(f"{value:.4g}") for key, value in own.items()}
    if "gain" in now:
        kept["motor"] = {"gain": float(f"{now['gain']['value']:.4g}")}
    return kept


def remarks(
    source: Source, whole: dict[str, Any], report: dict[str, Any], friction: JointFriction
) -> str:
    """What to know before using a motor."""
    said = [source.remark] if source.remark else []
    acts = {effect.effect.name for effect in friction.effects}
    rest = [x["effect"] for x in report["added"] if x["effect"] not in acts]
    if rest:
        said.append(f"Other effects found (drive, load or log): {', '.join(rest)}.")
    causes = []
    for cause in whole.get("shared", []):
        place = " and ".join(cause[k] for k in ("body", "joint", "other_joint") if k in cause)
        causes.append(f"{cause['cause']}{f' of {place}' if place else ''}")
    if causes:
        said.append(f"The MJCF was also corrected: {', '.join(causes)}.")
    if report.get("refined", {"taken": False})["taken"]:
        said.append(
            "Refined by simulation: the loop error is that of the refined numbers, torque and "
            "replay errors are those of the fit before."
        )
    kept = errors(report)
    worse = [key for key in kept if f"{key}_before" in kept and kept[key] > kept[f"{key}_before"]]
    if worse:
        listed = ", ".join(worse).replace("_held_out", " (held-out logs)")
        listed = listed.replace("_fit", " (fitted logs)").replace("replay", "position")
        said.append(f"Errors larger than with the law alone: {listed}.")
    said += [f"{text}: {', '.join(names)}." for text, names in unsure(report).items() if names]
    return " ".join(said)


def unsure(report: dict[str, Any]) -> dict[str, list[str]]:
    """Names of the numbers that the logs do not determine, and of those that are assumed."""
    found: dict[str, list[str]] = {"Not determined by these logs": [], "Assumed": []}
    rows = [(row.name, row.status) for row in law_numbers(result_estimates(report))]
    for added in report["added"]:
        sizes = effect_estimates(report, added)
        rows += [(f"{added['effect']} {name}", status_of(name, sizes)) for name in sizes]
    for name, status in rows:
        if status == "not determined":
            found["Not determined by these logs"].append(name)
        elif status == "assumed":
            found["Assumed"].append(name)
    return found


def by_unit(source: Source) -> dict[str, Source]:
    """Each unit of a source as a source of its own; the source itself, without a name, if none."""
    units = source.units.items()
    return {j: replace(source, joint=j, logs=x or source.logs, units={}) for j, x in units} or {
        "": source
    }


def typical(units: Sequence[Motor]) -> Motor:
    """Of several units the one whose held-out torque is explained best, with the numbers of all.

    A unit without Coulomb friction, all of it found to grow with the load, holds nothing at rest
    and is listed only.
    """

    def number(motor: Motor, name: str) -> float:
        law = motor.friction.parameters.to_dict()
        return statistics.fmean(law[f"{name}_{side}"] for side in ("pos", "neg"))

    if len(units) == 1:
        return units[0]
    holding = [x for x in units if number(x, "Fc") > 1e-6]
    chosen = min(holding, key=lambda x: x.fit["torque_held_out"] / x.fit["drive_held_out"])
    table = {
        x.joint: {key: float(f"{number(x, key):.4g}") for key in ("Fs", "Fc", "sigma2")}
        for x in units
    }
    return replace(chosen, units=table)


def motors(name: str, source: Source, data: Path, folder: Path) -> Iterator[Motor]:
    """Of a finished report."""
    whole = json.loads((folder / "report.json").read_text())
    carried = read_friction(load_model(folder / "model.xml"))
    logs = found(data, source.logs)
    # a fraction of the same logs holds no other files
    other = [] if isinstance(source.held_out, float) else found(data, source.held_out)
    held = found(data, source.held_out) if isinstance(source.held_out, float) else source.held_out
    command = " ".join(arguments(source, source.logs, held))
    for joint, report in whole.get("joints", {whole.get("joint"): whole}).items():
        part = "" if source.joint else joint.replace("_", "")
        yield Motor(
            name="_".join(filter(None, (name, part))),
            title=source.title + (f", {joint}" if part else ""),
            joint=joint,
            model=source.model[0].rpartition("=")[2],
            source=source.address,
            licence=source.licence,
            command=f"frictionjoint close-loop {command} --out {name}",
            version=(folder / "version.txt").read_text().strip(),
            conditions=source.conditions,
            verdict=report.get("verdict", ""),
            logs=digest([*logs, *other]),
            remark=remarks(source, whole, report, carried[joint]),
            unit=report.get("units", whole.get("units", {})).get("torque", "N m"),
            fit=errors(report),
            stderr={
                key: float(f"{x['stderr']:.2g}")
                for key, x in parameters(report).items()
                if x["stderr"] is not None
            },
            found=added(report),
            friction=carried[joint],
        )


def with_presliding(motor: Motor, known: Presliding | None) -> Motor:
    """A motor with what is assumed of it before sliding; one that has it stays as it is."""
    law = motor.friction.parameters
    if known is None or "Assumed before sliding" in motor.remark:
        return motor
    assert isinstance(law, FrictionParameters)
    level = ""
    if known.flat:
        ratio = law.Fc_pos / law.Fs_pos
        knots = tuple((z * ratio, force * ratio) for z, force in law.knots)
        law = replace(law, Fs_pos=law.Fc_pos, Fs_neg=law.Fc_neg, knots=knots)
        level = "breakaway at the Coulomb level, "
    fitted = law.Fs_pos / law.stiffness
    length = known.length or fitted
    law = replace(law, knots=tuple((z * length / fitted, force) for z, force in law.knots))
    model = mujoco.MjModel.from_xml_path(str(ROOT / "models" / motor.model))
    inertia = 1.0 / float(model.dof_invweight0[model.joint(motor.joint).dofadr[0]])
    sigma1 = 2.0 * known.damping * math.sqrt(law.stiffness * inertia)
    stiffness = f"a stiffness of {law.stiffness:.3g} N m/rad and " if known.length else ""
    said = (
        f"Assumed before sliding: {level}{stiffness}a damping sigma1 of {sigma1:.3g} N m s/rad. "
        "These logs do not determine them, and as fitted the joint would ring under a load; the "
        "errors are those of the fit."
    )
    assumed = ("stiffness", "sigma1", *(("Fs_pos", "Fs_neg") if known.flat else ()))
    kept = {key: x for key, x in motor.stderr.items() if key not in assumed}
    friction = replace(motor.friction, parameters=replace(law, sigma1=sigma1))
    return replace(motor, friction=friction, stderr=kept, remark=f"{motor.remark} {said}")


def motor_text(motor: Motor) -> str:
    """The file of a motor."""
    document = tomlkit.document()
    table = tomlkit.table()
    for key in (*TEXTS, "unit"):
        table.add(key, getattr(motor, key))
    table.add("fit", motor.fit)
    table.add("stderr", motor.stderr)
    table.add("found", motor.found)
    if motor.units:
        table.add("units", motor.units)
    document.add("motor", table)
    friction = toml_document(motor.friction.parameters, motor.friction.effects)
    document.add("friction", tomlkit.item(friction.unwrap()))
    return tomlkit.dumps(document)


def main() -> None:
    """Run what has no report yet, write the files."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", action="append", choices=SOURCES)
    parser.add_argument(
        "--keep", action="append", default=[], help="a machine or a motor whose numbers stay"
    )
    asked = parser.parse_args()
    for name in asked.only or SOURCES:
        folder = asked.out.resolve() / name
        source = SOURCES[name]
        if name in asked.keep:
            made = [
                replace(motor, source=source.address, conditions=source.conditions)
                for motor in list_motors()
                if motor.name == name or motor.name.rpartition("_")[0] == name
            ]
        else:
            made = []
            for unit, own in by_unit(source).items():
                run(own, asked.data, folder / unit)
                made += motors(name, own, asked.data, folder / unit)
            made = [typical(made)] if source.units else made
            made = [motor for motor in made if motor.name not in asked.keep]
        for motor in made:
            out = LIBRARY / f"{motor.name}.toml"
            out.write_text(motor_text(with_presliding(motor, source.assumed.get(motor.joint))))
            print(f"Wrote {out.relative_to(ROOT)}", flush=True)
    PAGE.write_text(page(list_motors()))
    REMARKS.write_text(remarks_page(list_motors()))


if __name__ == "__main__":
    main()
