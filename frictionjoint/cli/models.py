"""Commands on model files: `install`, `uninstall`, `check` and `view`."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from frictionjoint.cli.logs import by_name
from frictionjoint.cli.output import Force, Json, print_json, require_writable
from frictionjoint.cli.plain_help import argument, option
from frictionjoint.cli.terminal import show_table, warnings_afterwards
from frictionjoint.errors import FrictionJointError, ParameterError, few

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    import mujoco

    from frictionjoint.joint_friction import JointFriction

Out = Annotated[Path, option("MJCF", "Model to write.")]
Carrying = Annotated[Path, argument("MJCF", "Model that contains friction.")]


def install(
    mjcf: Annotated[Path, argument("MJCF", "MJCF or URDF to add friction to.")],
    out: Out,
    joint: Annotated[
        list[str] | None, option("NAME=TOML", "Joint and its parameters. Repeatable.")
    ] = None,
    every: Annotated[
        Path | None,
        option("TOML", "Parameters for all other named hinge and slide joints.", "--all"),
    ] = None,
    exclude: Annotated[
        list[str] | None, option("NAME", "Joint that --all leaves out. Repeatable.")
    ] = None,
    replace: Annotated[
        bool, typer.Option("--replace", help="Replace friction that a joint has already.")
    ] = False,
    clear_native: Annotated[
        bool,
        typer.Option(
            "--clear-native",
            help="Remove frictionloss, damping and springdamper from the joints that get friction.",
        ),
    ] = False,
    force: Force = False,
) -> None:
    """Add friction to a model and write it as an MJCF.

    Paths of meshes, textures and height fields are adapted to the folder of the new file.

    Examples:

    `frictionjoint install arm.xml --joint elbow=elbow.toml --out arm_friction.xml`

    `frictionjoint install arm.urdf --all gear.toml --clear-native --out arm_friction.xml`

    `frictionjoint install hand.xml --all gear.toml --exclude wrist --out hand_friction.xml`
    """
    from frictionjoint.files import read_parameters
    from frictionjoint.model_files import read_spec
    from frictionjoint.simulate.carrier import install as install_in_spec

    with warnings_afterwards():
        given = by_name("--joint", joint or [], "write NAME=params.toml")
        named = {name: Path(path) for name, path in given.items()}
        tables = [*named.values(), *([every] if every else [])]
        require_writable(out, [mjcf, *tables], force)
        carried = {name: read_parameters(path) for name, path in named.items()}
        spec = read_spec(mjcf, whole=True)
        if every:
            carried = _all_joints(spec, every, exclude or []) | carried
        elif exclude:
            raise ParameterError("--exclude requires --all TOML")
        if not carried:
            raise ParameterError("no joint is given: write --joint NAME=TOML, or --all TOML")
        friction = {name: x.parameters for name, x in carried.items()}
        effects = {name: x.effects for name, x in carried.items()}
        install_in_spec(spec, friction, effects, clear_native, replace)
        _write(spec, mjcf, out)
    typer.echo(f"Wrote {out} with friction in {', '.join(friction)}.")


def uninstall(mjcf: Carrying, out: Out, force: Force = False) -> None:
    """Remove the friction from a model and write it as an MJCF.

    Native friction that was cleared is not restored; a fitted armature and a motor stay.

    Example: `frictionjoint uninstall arm_friction.xml --out arm_without.xml`
    """
    from frictionjoint.model_files import read_spec
    from frictionjoint.simulate.uninstall import uninstall as uninstall_from_spec

    with warnings_afterwards():
        require_writable(out, [mjcf], force)
        spec = read_spec(mjcf, whole=True)
        joints = uninstall_from_spec(spec)
        _write(spec, mjcf, out)
    typer.echo(f"Wrote {out} without the friction of {', '.join(joints)}.")


def check(
    mjcf: Carrying,
    strict: Annotated[bool, typer.Option("--strict", help="Exit 1 if a problem is found.")] = False,
    as_json: Json = False,
) -> None:
    """List the friction of a model, what else acts on its joints, and whether the time step
    suffices.

    Examples:

    `frictionjoint check arm_friction.xml`

    `frictionjoint check report/model.xml --strict --json`
    """
    from frictionjoint.simulate.carrier import load_model
    from frictionjoint.simulate.check import check as check_model
    from frictionjoint.simulate.check import integrator_note

    model = load_model(mjcf)
    findings = check_model(model)
    outside = [(row["joint"], sentence) for row in findings for sentence in row["outside"]]
    if as_json:
        print_json(findings)
    else:
        cells = (
            (
                *(row["joint"], row["law"], f"{row['stiffness']:.4g} {row['unit']}"),
                *(f"{row['step_ratio']:.3g}", f"{row['damping_ratio']:.3g}"),
                ", ".join(row["effects"]) or "none",
                "problem, see below" if row["outside"] else row["remark"],
            )
            for row in findings
        )
        ratios = "h sqrt(K/J)", "h sigma/J"
        show_table(("joint", "law", "initial stiffness K", *ratios, "effects", "remark"), cells)
        typer.echo(integrator_note(model))
        for row in findings:
            for sentence in row["acts"]:
                typer.echo(f"{row['joint']}: {sentence}.")
        for joint, sentence in outside:
            typer.echo(f"{joint}: problem: {sentence}.")
    if strict and outside:
        raise typer.Exit(1)


def view(mjcf: Carrying) -> None:
    """Open MuJoCo's viewer with the friction of a model.

    Example: `frictionjoint view arm_friction.xml`
    """
    from frictionjoint.simulate.attach import view as open_viewer

    open_viewer(mjcf)


def _all_joints(
    spec: "mujoco.MjSpec", path: Path, exclude: list[str]
) -> "dict[str, JointFriction]":
    """The same parameters for every named hinge and slide of a model, without excluded ones."""
    from frictionjoint.files import read_parameters
    from frictionjoint.model_files import ONE_DOF
    from frictionjoint.simulate.mechanism import DEFLECTION
    from frictionjoint.simulate.uninstall import carrying

    found = read_parameters(path)
    joints = [joint for joint in spec.joints if int(joint.type) in ONE_DOF]
    names = [joint.name for joint in joints if joint.name]
    for name in exclude:
        if name not in names:
            what = f"no hinge or slide joint has this name, there are {few(names)}"
            raise FrictionJointError(f"--exclude {name}: {what}")
    deflections = {name + DEFLECTION for name in carrying(spec)}
    friction = {name: found for name in names if name not in exclude and name not in deflections}
    if not friction:
        raise FrictionJointError("--all: the model has no other hinge or slide joint with a name")
    unnamed = [joint.parent.name or "without a name" for joint in joints if not joint.name]
    if unnamed:
        joint = "1 joint has" if len(unnamed) == 1 else f"{len(unnamed)} joints have"
        text = f"--all: {joint} no name and no friction, of body {few(unnamed)}"
        fix = "name them in the model to give them friction"
        warnings.warn(f"{text}: {fix}", RuntimeWarning, stacklevel=2)
    return friction


def _write(spec: "mujoco.MjSpec", source: Path, out: Path) -> None:
    """Write a model with paths to its asset files, and check that it loads there."""
    from frictionjoint.model_text import model_text, placed, require_compiles
    from frictionjoint.report.write import write_files

    text = placed(model_text(spec, source), out.parent)
    write_files(out.parent, {out.name: text}, {out.name: require_compiles})
