"""Byte offsets of the mjModel and mjData fields that the native callback uses.

They are computed from `mujoco.introspect`, which lists the C structures of the running build, and
verified against a live model.
"""

import ctypes
import re
from functools import cache
from typing import Any

import mujoco
import numpy as np
from mujoco.introspect import ast_nodes, structs

# names of MuJoCo's numbers in ctypes, where they differ from those in C
_SCALARS = {
    **{"mjtNum": "double", "mjtSize": "int64", "mjtByte": "uint8", "mjtBool": "bool"},
    **{"uintptr_t": "size_t", "uint64_t": "uint64"},
}
_MODEL_FIELDS = """nv nnumeric nuserdata numeric_adr numeric_data opt jnt_bodyid jnt_axis M_rowadr
M_rownnz dof_invweight0 dof_M0 dof_armature nu actuator_trntype actuator_trnid actuator_group
actuator_gear actuator_gainprm actuator_biasprm actuator_ctrllimited actuator_ctrlrange nbody"""
_OPTION_FIELDS = """timestep integrator solver noslip_iterations disableflags disableactuator
gravity"""
_DATA_FIELDS = """time qpos qvel qacc qfrc_passive qfrc_constraint userdata sensordata M xmat xaxis
xipos xfrc_applied ctrl arena parena nefc efc_AR efc_AR_rownnz"""
# what only some versions have: actuators that need not have one control and one output; from MuJoCo
# 3.11 on efc_Y; until then the mass matrix in a second format, and copies by island
_SOME_MODEL_FIELDS = "nactuator actuator_ctrladr actuator_ctrlnum actuator_outadr dof_Madr"
_SOME_DATA_FIELDS = """efc_Y efc_Y_rownnz qM iM iLD iLDiagInv qLD qLDiagInv iM_rowadr map_idof2dof
nidof"""
MODEL_NAMES = tuple(f"{_MODEL_FIELDS} {_OPTION_FIELDS} {_SOME_MODEL_FIELDS}".split())
DATA_NAMES = tuple(f"{_DATA_FIELDS} {_SOME_DATA_FIELDS}".split())


class LayoutMismatchError(RuntimeError):
    """The structures of this MuJoCo build differ from its own listing."""


def _ctype(declared: Any) -> Any:
    if isinstance(declared, ast_nodes.PointerType):
        return ctypes.c_void_p
    if isinstance(declared, ast_nodes.ArrayType):
        result = _ctype(declared.inner_type)
        for extent in reversed(declared.extents):
            result = result * extent
        return result
    if hasattr(declared, "fields"):
        return _structure(declared.fields)
    name = re.sub(r"^(const|struct|enum) ", "", declared.name)
    scalar = getattr(ctypes, f"c_{_SCALARS.get(name, name)}", None)
    if scalar is not None:
        return scalar
    if name in structs.STRUCTS:
        return structure(name)
    if name.startswith("mjt"):
        return ctypes.c_int  # an enumeration
    raise LayoutMismatchError(f"unknown C type {name!r}")


def _structure(fields: Any) -> Any:
    pairs = [(f.name, _ctype(f.type)) for f in fields]
    return type("Layout", (ctypes.Structure,), {"_fields_": pairs})


@cache
def structure(name: str) -> Any:
    """A structure of MuJoCo, e.g. "mjModel", as a ctypes structure."""
    return _structure(structs.STRUCTS[name].fields)


@cache
def _model_extents() -> dict[str, tuple[Any, tuple[int | str, ...]]]:
    """The arrays of mjModel by name: C type of a number, and extents or their fields."""
    return {
        field.name: (_ctype(field.type.inner_type), field.array_extent)
        for field in structs.STRUCTS["mjModel"].fields
        if field.array_extent
    }


class ModelView:
    """An mjModel by its address, as a C callback receives it: fields under their names in
    `mujoco.MjModel`, arrays as views of the model's memory, which must outlive them.
    """

    def __init__(self, address: int) -> None:
        self._fields = structure("mjModel").from_address(address)

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._fields, name)
        extents = _model_extents().get(name)
        if extents is None:
            return value
        kind, sizes = extents
        shape = [size if isinstance(size, int) else getattr(self._fields, size) for size in sizes]
        if value is None or 0 in shape:
            return np.zeros(shape, dtype=kind)
        array = (kind * int(np.prod(shape))).from_address(value)
        return np.ctypeslib.as_array(array).reshape(shape)


@cache
def offsets() -> tuple[dict[str, int], dict[str, int]]:
    """Byte offsets in mjModel and mjData by field name; fields of some versions only if they exist.

    Raises:
        LayoutMismatchError: a live model contradicts the offsets.
    """
    model = _offsets("mjModel", _MODEL_FIELDS, _SOME_MODEL_FIELDS)
    data = _offsets("mjData", _DATA_FIELDS, _SOME_DATA_FIELDS)
    model |= {x: model["opt"] + at for x, at in _offsets("mjOption", _OPTION_FIELDS).items()}
    _check(model, data)
    return model, data


def _offsets(name: str, fields: str, some: str = "") -> dict[str, int]:
    kind = structure(name)
    names = [*fields.split(), *(x for x in some.split() if hasattr(kind, x))]
    return {x: getattr(kind, x).offset for x in names}


def _check(model_at: dict[str, int], data_at: dict[str, int]) -> None:
    # without springs and dampers MuJoCo calls no passive callback while it compiles: a user's own
    # one knows nothing of this model
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><size nuserdata='3'/>"
        "<option timestep='0.00137' integrator='implicitfast' gravity='0.3 0 -9' solver='PGS' "
        "jacobian='sparse' noslip_iterations='7' actuatorgroupdisable='3'>"
        "<flag warmstart='disable' spring='disable' damper='disable'/></option>"
        "<worldbody><body><joint name='j' frictionloss='1'/><geom size='1'/></body></worldbody>"
        "<actuator><motor joint='j'/></actuator><sensor><clock/></sensor>"
        "<custom><numeric name='a' data='1'/><numeric name='b' data='2 3'/></custom></mujoco>"
    )
    data = mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, data)
    data.time = 0.731
    for owner, kind, at in ((model, "mjModel", model_at), (data, "mjData", data_at)):
        fields = structure(kind).from_address(owner._address)
        for name in at:
            inside, shown = (fields, owner) if hasattr(fields, name) else (fields.opt, model.opt)
            value: Any = getattr(shown, name, None)
            found = getattr(inside, name)
            if isinstance(found, ctypes.Array):
                value, found = value[0], found[0]
            elif isinstance(value, np.ndarray):
                value = value.ctypes.data
            elif not isinstance(value, int | float):
                continue  # Python shows it in another form, or not at all
            if value != (found or 0):
                raise LayoutMismatchError(
                    f"MuJoCo {mujoco.__version__} lays out its structures differently than expected"
                )
