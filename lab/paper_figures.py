"""Every claim of Ganseman et al. (1997) as a figure and as numbers.

python lab/paper_figures.py --out paper            PNGs and numbers.json
python lab/paper_figures.py --out paper --only whisker --only general
python lab/paper_figures.py --write                 writes lab/notes/paper.md and its figures
"""

import argparse
import importlib
import json
from pathlib import Path

from paper.claim import Claim

ROOT = Path(__file__).resolve().parents[1]
NAMES = (
    "constant_velocity",
    "whisker",
    "reversal",
    "presliding",
    "stick_slip",
    "general",
    "weaknesses",
    "accuracy",
)
HEAD = """# What the paper claims, and what is found

Every claim of Ganseman, Swevers, Prajogo and Al-Bender (1997), run with this package's law. The
curves of the paper survive only as pictures, so no figure here is a fit to them; what is compared
are the claims. This page is written by `python lab/paper_figures.py --write`;
`lab/tests/test_paper.py` and `lab/tests/test_weaknesses.py` hold its numbers to account.

"""


def page(claims: list[Claim]) -> str:
    """Markdown of all sections."""
    sections = [
        f"## {c.title}\n\n![{c.title}](img/paper/{c.name}.png)\n\n{c.text.rstrip()}\n"
        for c in claims
    ]
    return HEAD + "\n".join(sections)


def write_figures(claims: list[Claim], folder: Path) -> None:
    """PNGs of all claims."""
    folder.mkdir(parents=True, exist_ok=True)
    for c in claims:
        c.figure.savefig(folder / f"{c.name}.png", dpi=90, metadata={"Software": None})


def main() -> None:
    """Run the claims and write what was asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--out", type=Path, help="folder for PNGs and numbers.json")
    parser.add_argument("--only", action="append", choices=NAMES, help="repeatable")
    parser.add_argument("--write", action="store_true", help="write lab/notes/paper.md")
    given = parser.parse_args()
    if not given.out and not given.write:
        parser.error("give --out FOLDER, --write, or both")
    if given.write and given.only:
        parser.error("--write writes the whole page: leave out --only")
    claims = [importlib.import_module(f"paper.{name}").claim() for name in given.only or NAMES]
    numbers = {c.name: c.numbers for c in claims}
    if given.out:
        write_figures(claims, given.out)
        (given.out / "numbers.json").write_text(json.dumps(numbers, indent=2) + "\n")
    if given.write:
        write_figures(claims, ROOT / "lab" / "notes" / "img" / "paper")
        (ROOT / "lab" / "notes" / "paper.md").write_text(page(claims))


if __name__ == "__main__":
    main()
