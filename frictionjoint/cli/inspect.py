"""The command `inspect`: the friction numbers of a model or of a parameter file."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from frictionjoint.cli.output import Json, print_json
from frictionjoint.cli.plain_help import argument
from frictionjoint.cli.terminal import console

if TYPE_CHECKING:  # the command line starts in a moment: what computes is imported by its command
    import mujoco

    from frictionjoint.joint_friction import JointFriction
    from frictionjoint.parameter_meanings import Value


def inspect(
    file: Annotated[Path, argument("MODEL|TOML", "MJCF, URDF, or a parameter file.")],
    as_json: Json = False,
) -> None:
    """Print the friction numbers of every joint, with units.

    Joints without friction of this package show MuJoCo's own frictionloss and damping.

    Examples:

    `frictionjoint inspect report/model.xml`

    `frictionjoint inspect elbow.toml`
    """
    from frictionjoint.files import read_parameters

    if file.suffix.lower() == ".toml":
        rows = [_carried(file.stem, read_parameters(file), None)]
    else:
        rows = _of_model(file)
    if as_json:
        print_json(rows)
        return
    for row in rows:
        lines = [f"{row['joint']}: {row['law']}"]
        width = max((len(x["meaning"]) for x in row["numbers"]), default=0)
        lines += [
            f"  {x['meaning']:<{width}}  {x['symbol']:<10} {x['text']}" for x in row["numbers"]
        ]
        lines += [f"  {text}" for text in row["effects"]]
        console().print("\n".join(lines), soft_wrap=True, markup=False, highlight=False)


def _of_model(file: Path) -> list[dict[str, Any]]:
    from frictionjoint.model_files import ONE_DOF, compile_model
    from frictionjoint.simulate.block import assumed, blocks
    from frictionjoint.simulate.carrier import read_friction

    model = compile_model(file)
    carried = read_friction(model) if blocks(model) else {}
    rows = []
    for j in range(model.njnt):
        if int(model.jnt_type[j]) not in ONE_DOF:
            continue
        name = model.joint(j).name
        slide = int(model.jnt_type[j]) == ONE_DOF[1]
        own, said = carried.get(name), assumed(model, name)
        rows.append(_carried(name, own, slide, said) if own else _native(model, j, slide))
    return rows


def _carried(
    name: str, joint: "JointFriction", slide: bool | None, assumptions: Sequence[str] = ()
) -> dict[str, Any]:
    """Friction of this package. A parameter file does not say whether the joint is a slide."""
    from frictionjoint.describe import effect_texts, law_values

    law = f"law {joint.parameters.law}"
    if joint.parameters.stiffness <= 0.0:
        law += ", which creeps under load instead of holding at rest"
    if slide is None:
        law += ", units of a hinge (for a slide read N for N m and m for rad)"
    return {
        "joint": name,
        "law": "; ".join([law, *assumptions]),
        "numbers": [_row(x) for x in law_values(joint.parameters, bool(slide))],
        "effects": list(effect_texts(joint, bool(slide))),
    }


def _native(model: "mujoco.MjModel", joint: int, slide: bool) -> dict[str, Any]:
    """MuJoCo's own friction."""
    from frictionjoint.parameter_meanings import Value, spelled

    dof = int(model.jnt_dofadr[joint])
    own = (
        ("frictionloss", "Coulomb friction", float(model.dof_frictionloss[dof]), "T"),
        ("damping", "viscous friction", float(model.dof_damping[dof].flat[0]), "T s/x"),
    )
    numbers = [_row(Value(s, m, x, spelled(unit, slide))) for s, m, x, unit in own if x]
    law = "MuJoCo's own friction" if numbers else "no friction"
    return {"joint": model.joint(joint).name, "law": law, "numbers": numbers, "effects": []}


def _row(x: "Value") -> dict[str, Any]:
    return x._asdict() | {"text": x.text}
