"""Public measured data: addresses pinned to a commit, hashes, licences.

The package contains no such data. Files are fetched from their authors' repositories with pooch
into its cache folder. If the environment variable FRICTIONJOINT_DATA names a local folder with a
subfolder per data set, that is used instead, and never the network.
"""

import os
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from frictionjoint.errors import LogError

_RAW = "https://raw.githubusercontent.com"


@dataclass(frozen=True)
class DataSet:
    """Logs from one source.

    Attributes:
        name: argument of `get_data`, and name of its folder in a local copy.
        title: what was measured, by whom.
        licence: as its authors state it.
        source: page of the repository.
        address: of the folder with the files, including the commit.
        files: name -> sha256.
        logs: arguments of `read_log`, relative to the folder; ``.`` is the folder itself.
    """

    name: str
    title: str
    licence: str
    source: str
    address: str
    files: MappingProxyType[str, str]
    logs: tuple[str, ...]


_EMPS = DataSet(
    name="emps",
    title="electro-mechanical positioning system, a slide (Janot, Gautier, Brunot 2019)",
    licence="none stated for the data: ask its authors before you pass it on",
    source="https://github.com/forgi86/sysid-neural-continuous",
    address=f"{_RAW}/forgi86/sysid-neural-continuous/"
    "956aa7ecd73061b0321c6f6098d74c9e4a7ce67a/examples/EMPS/data",
    files=MappingProxyType(
        {
            "DATA_EMPS.mat": "6cf6814ae14618795da0101aae2bb97ff0c6351b0501b5492751b02b07facf7e",
        }
    ),
    logs=("DATA_EMPS.mat",),
)

_PANDA_FILES = MappingProxyType(
    {
        "exciting_traj_positions.txt": (
            "50bf82a082c439aff8220e8142985c8dd783f7ddc1415987cd75c9efb88bcf69"
        ),
        "exciting_traj_time.txt": (
            "031063612f297011dc005ab29830903e36f4bfeba77bce59c0fbde13620fb20d"
        ),
        "exciting_traj_torques.txt": (
            "11fda32785bb29ce444e14e0f45f4893aab7142dc6ee29576d828ab154852f9c"
        ),
        "exciting_traj_velocity.txt": (
            "3340f299e926c501b66d540fa461ea0a7184b8dda32e505ebed062db57860d49"
        ),
    }
)
_PANDA = DataSet(
    name="panda",
    title="Franka Emika Panda on an exciting trajectory (Gaz et al. 2019)",
    licence="GPL-3.0",
    source="https://github.com/marcocognetti/FrankaEmikaPandaDynModel",
    address=f"{_RAW}/marcocognetti/FrankaEmikaPandaDynModel/"
    "24d85ce4e648e2e894c832bfeee9b16711eb1a1a/matlab/data/Exciting_Traj/Trajectory_1/rbt_log",
    files=_PANDA_FILES,
    logs=(".",),
)

_XL330_FILES = MappingProxyType(
    {
        "2026-01-15_10h28m10.json": (
            "e58f3c2a08a5e0e37a2c5e930d0830a438bc102b8d21482767124f495b92f2ce"
        ),
        "2026-01-15_10h28m17.json": (
            "ef6507934ba465eb31529d7d98715ecc70bd5c87be049fd4618a94ce39290569"
        ),
        "2026-01-15_10h28m24.json": (
            "165b171df12b3e8b39504ce36d37e373ad105c0dddf4d3d073c747fd492e8bef"
        ),
        "2026-01-15_10h28m32.json": (
            "fdc255edae6995298af437f37582eb8cd0c4a5ddcec4f49fb7c4d6f3303aaa9c"
        ),
        "2026-01-15_10h28m42.json": (
            "1c6386bfa3be021c8ca8a96a7cbee93914f6271a050282b1c3b7d5ef373427db"
        ),
        "2026-01-15_10h28m49.json": (
            "e2223826274fca7799a2be0cb371e4269ead88cd9077fbb68498ef93e4e0de97"
        ),
        "2026-01-15_10h28m57.json": (
            "c10a350d9c7222d4d3499d140edd3ac4e63fe94f3b59a675116a34db7d66152c"
        ),
        "2026-01-15_10h29m04.json": (
            "7996c43314a9f60094a6119346b54ff9ff84cb6726c967f4a88a7175278f6515"
        ),
        "2026-01-15_10h29m14.json": (
            "016d15d21c464457aa30eaeab3977228b08cd5acf7542f24067440126c0bf480"
        ),
        "2026-01-15_10h29m21.json": (
            "fe68cff62e976c87a2fcab925a517fbff83be16c862693310fdc1eff743eddab"
        ),
        "2026-01-15_10h29m29.json": (
            "b9ce9fc0f396e6b03bd514e9254cb83b8a64e1a5df1728b9a10e3b4a5a9513ca"
        ),
        "2026-01-15_10h29m37.json": (
            "838d390b7190c4ce1608157cf629989648773b7336728a0931a61c6018c6700b"
        ),
        "2026-01-15_10h29m47.json": (
            "61ae8eeb881be5d8c09f6c7fba4cef39f66b1ff03e0148ef3bc0e314054513f5"
        ),
        "2026-01-15_10h29m54.json": (
            "b50055742ee553a8cb849b38d04d2b9bcf7143d0acefe6539f922984b93d958a"
        ),
        "2026-01-15_10h30m02.json": (
            "040e065f9885833fa909683f13665f90048ce5457d94dd2a3af056c21c36210d"
        ),
        "2026-01-15_10h30m10.json": (
            "01d32db99e7859f012a230aca59f1dda24219d6781472d356861b138526213e6"
        ),
    }
)
_XL330 = DataSet(
    name="xl330",
    title="Dynamixel XL330 swinging a pendulum, 16 logs (BAM, Rhoban)",
    licence="Apache-2.0",
    source="https://github.com/Rhoban/bam",
    address=f"{_RAW}/Rhoban/bam/0b0c5b4115e4d2cbdc178b1bc9f349724ba06837/bam/data.bak/raw",
    files=_XL330_FILES,
    logs=tuple(_XL330_FILES),
)

_SETS = {s.name: s for s in (_EMPS, _PANDA, _XL330)}


def list_data() -> tuple[DataSet, ...]:
    """All data sets that `get_data` can fetch."""
    return tuple(_SETS.values())


def get_data(name: str) -> Path:
    """Folder with the files of a data set, fetched if need be, hashes checked.

    Raises:
        LogError: an unknown name, a file missing or altered, or no network.
    """
    if name not in _SETS:
        raise LogError(f"no data set {name!r}, there are {', '.join(_SETS)}")
    data = _SETS[name]
    local = os.environ.get("FRICTIONJOINT_DATA")
    return _local(data, Path(local) / name) if local else _fetched(data)


def _local(data: DataSet, folder: Path) -> Path:
    import pooch

    for file, digest in data.files.items():
        path = folder / file
        if not path.is_file():
            raise LogError(f"{path}: missing, complete it or unset FRICTIONJOINT_DATA")
        if pooch.file_hash(str(path)) != digest:
            raise LogError(f"{path}: not the published file, its sha256 is not {digest[:12]}...")
    return folder


def _fetched(data: DataSet) -> Path:
    import pooch

    registry: dict[str, Any] = {file: f"sha256:{digest}" for file, digest in data.files.items()}
    folder = Path(pooch.os_cache("frictionjoint")) / data.name
    pooch.get_logger().setLevel("WARNING")  # its progress lines would hide our one line
    shelf = pooch.create(folder, f"{data.address}/", registry=registry, retry_if_failed=1)
    for file in data.files:
        try:
            shelf.fetch(file)
        except (OSError, ValueError) as error:  # requests' errors are OSErrors
            reason = " ".join(str(error).split())[:160]
            raise LogError(
                f"{data.name}: {file} could not be fetched from {data.source}: {reason}: check the "
                "network, or set FRICTIONJOINT_DATA to a local folder"
            ) from None
    return folder
