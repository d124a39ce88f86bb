"""What built wheels hold: tags, the library for the platform they name, every kernel in it.

    python scripts/inspect_wheels.py WHEEL...

Ends with exit code 1 and a line on what is wrong.
"""

import json
import struct
import sys
import zipfile
from pathlib import Path

FOLDER = "frictionjoint/_native/"
# bytes: Python files, data and the library of one platform
LARGEST = 3_000_000


def platform(library: bytes) -> str:
    """Operating system and processor that a shared library is for, by its header."""
    if library[:4] == b"\x7fELF":
        (machine,) = struct.unpack_from("<H", library, 18)
        return {0x3E: "linux x86_64", 0xB7: "linux aarch64"}.get(machine, "linux, another")
    if library[:4] == b"\xcf\xfa\xed\xfe":
        (machine,) = struct.unpack_from("<I", library, 4)
        return {0x0100000C: "macosx arm64", 0x01000007: "macosx x86_64"}.get(machine, "macosx")
    if library[:2] == b"MZ":
        (header,) = struct.unpack_from("<I", library, 0x3C)
        (machine,) = struct.unpack_from("<H", library, header + 4)
        return {0x8664: "win amd64", 0xAA64: "win arm64"}.get(machine, "win, another")
    return "unknown"


def inspect(file: Path) -> str:
    """A line on a wheel.

    Raises:
        ValueError: something in it is wrong.
    """
    python, abi, tag = file.stem.split("-")[-3:]
    if (python, abi) != ("py3", "none"):
        raise ValueError(f"{file.name}: for {python}-{abi}, not for every Python 3")
    with zipfile.ZipFile(file) as wheel:
        listed = json.loads(wheel.read(f"{FOLDER}kernels.json"))
        inside = [name for name in wheel.namelist() if name.startswith(FOLDER)]
        library = wheel.read(FOLDER + listed["library"])
    if len(inside) != 2:
        raise ValueError(f"{file.name}: {', '.join(inside)} instead of one library and its list")
    made_for = platform(library)
    if not all(part in tag for part in made_for.split()):
        raise ValueError(f"{file.name}: its library is for {made_for}")
    missing = [
        symbol for symbol, *_ in listed["kernels"].values() if symbol.encode() not in library
    ]
    if missing:
        raise ValueError(f"{file.name}: {len(missing)} kernels are missing, {missing[0]} first")
    size = file.stat().st_size
    if size > LARGEST:
        raise ValueError(f"{file.name}: {size} bytes, over {LARGEST}")
    count, kilobytes = len(listed["kernels"]), len(library) / 1e3
    held = f"{count} kernels in {kilobytes:.0f} kB, {size / 1e6:.2f} MB in all"
    return f"{file.name}: {made_for}, {held}"


if __name__ == "__main__":
    try:
        for name in sys.argv[1:]:
            print(inspect(Path(name)))
    except ValueError as error:
        sys.exit(str(error))
