"""Many searches at once, one row of a JSON-lines file each: for `balance_grid`, `null_p_values`."""

import argparse
import json
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any


def options(about: str, count: str, n: int) -> argparse.Namespace:
    """Options of the command line.

    Args:
        about: help of the script. count: name of the option that says how many. n: its default.
    """
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument(f"--{count}", type=int, default=n)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True, help="file of rows, written anew")
    return parser.parse_args()


def search_all(
    one: Callable[..., dict[str, Any]], work: Iterable[tuple[Any, ...]], jobs: int, out: Path
) -> list[dict[str, Any]]:
    """What `one` makes of the arguments of each search, written as it is ready, in their order."""
    found = []
    with ProcessPoolExecutor(jobs) as pool, out.open("w") as file:
        for done in [pool.submit(one, *arguments) for arguments in work]:
            found.append(done.result())
            file.write(json.dumps(found[-1]) + "\n")
            file.flush()
    return found
