"""An MJCF whose mesh files are missing, read for its dynamics alone.

Repositories often ship an MJCF without its meshes. A shape whose mesh is missing is left out where
the mass of its body does not depend on it.
"""

from collections.abc import Iterable
from pathlib import Path

import mujoco


def without_missing_meshes(
    spec: mujoco.MjSpec, folders: Iterable[Path]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Remove shapes whose mesh files are in none of the folders; the spec is changed in place.

    Returns:
        names of the files whose shapes were removed, and of those whose shapes give a body its mass
            and were kept.
    """
    places = list(folders)
    missing = {}
    for mesh in spec.meshes:
        own = Path(mesh.compiler.meshdir or "")
        names = (own / mesh.file, Path(mesh.file), own / Path(mesh.file).name)
        if mesh.file and not any((folder / n).is_file() for folder in places for n in names):
            missing[mesh.name or Path(mesh.file).stem] = mesh
    needed = {
        geom.meshname
        for geom in spec.geoms
        if geom.meshname in missing
        # the inertia of the body depends on the geom
        and not (geom.parent.explicitinertial or geom.mass == 0.0 or geom.density == 0.0)
        and _moves(geom.parent)
    }
    for geom in list(spec.geoms):
        if geom.meshname in missing and geom.meshname not in needed:
            spec.delete(geom)
    left_out = []
    for name, mesh in missing.items():
        if name not in needed:
            left_out.append(str(mesh.file))
            spec.delete(mesh)
    return tuple(left_out), tuple(str(missing[name].file) for name in needed)


def _moves(body: mujoco.MjsBody) -> bool:
    """Whether a joint moves the body, or one above it."""
    while body is not None and body.name != "world":
        if body.joints or body.freejoint is not None:
            return True
        body = body.parent
    return False
