"""Mutate the law, one small edit at a time, and see whether its tests notice.

Every mutant is a copy of the package in a temporary folder; the checkout is never edited. Prints a
table, Markdown as it stands, and ends with code 1 where a mutant survives that is not proven to be
equivalent to the law.
Usage: python lab/mutate_law.py [--mutants 48] [--seed 0] [--json]
Example: python lab/mutate_law.py --mutants 12 --seed 3
"""

import argparse
import ast
import copy
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(os.environ.get("FRICTIONJOINT_ROOT", Path(__file__).resolve().parents[1]))
TESTS = Path(__file__).resolve().parents[1] / "tests"
FILES = ("transition", "stribeck", "relaxation", "memory", "integrated")
SUBSET = ("transition", "memory", "relaxation", "law_against_reference")
SWAPS = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.And: ast.Or,
    ast.Or: ast.And,
    ast.USub: ast.UAdd,
}

# Mutants that are the same program, by file and edit, and why.
EQUIVALENT = {
    ("stribeck", "d + FS  ->  d - FS"): "FS is 0",
    ("integrated", "p + LAMPAERT  ->  p - LAMPAERT"): "LAMPAERT is 0",
    ("stribeck", "Fs == Fc or speed == 0.0  ->  Fs == Fc and speed == 0.0"): (
        "a shortcut: at Fs = Fc the formula gives Fc + 0 * exp(-x), at no speed "
        "Fc + (Fs - Fc) * exp(-0), both Fs"
    ),
}


def sites(tree: ast.Module) -> list[ast.AST]:
    """Operators, comparisons and nonzero numbers inside function bodies."""
    found = []
    for function in (x for x in tree.body if isinstance(x, ast.FunctionDef)):
        for statement in function.body:
            for node in ast.walk(statement):
                number = isinstance(node, ast.Constant) and type(node.value) in (int, float)
                if number or isinstance(node, ast.BinOp | ast.BoolOp | ast.Compare | ast.UnaryOp):
                    found.append(node)
    return found


def mutate(node: ast.AST) -> str:
    """Edit the node in place; returns what was done, or nothing where no edit applies."""
    before = ast.unparse(node)
    if isinstance(node, ast.Constant):
        node.value = node.value * 2 if node.value else 1
    elif isinstance(node, ast.Compare):
        swap = SWAPS.get(type(node.ops[0]))
        if swap is None:
            return ""
        node.ops[0] = swap()
    else:
        swap = SWAPS.get(type(node.op))
        if swap is None:
            return ""
        node.op = swap()
    return f"line {node.lineno}: {before}  ->  {ast.unparse(node)}"


def mutants(count: int, seed: int) -> list[tuple[str, str, str]]:
    """(file, what, source) of `count` mutants spread evenly over the files."""
    draw, made = random.Random(seed), []
    for place, name in enumerate(FILES):
        tree = ast.parse((ROOT / f"frictionjoint/law/{name}.py").read_text())
        numbers = list(range(len(sites(tree))))
        draw.shuffle(numbers)
        wanted = (count + place) // len(FILES)
        for number in numbers:
            edited = copy.deepcopy(tree)
            what = mutate(sites(edited)[number])
            if what and wanted > 0:
                made.append((name, what, ast.unparse(edited)))
                wanted -= 1
    return made


def verdict(name: str | None, source: str) -> str:
    """ "killed", "killed (hangs)" or "survived" for the package with one file replaced."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(
            ROOT / "frictionjoint",
            Path(folder, "frictionjoint"),
            ignore=shutil.ignore_patterns("__pycache__", "demo"),
        )
        if name:
            Path(folder, f"frictionjoint/law/{name}.py").write_text(source)
        env = os.environ | {
            "PYTHONPATH": f"{folder}{os.pathsep}{TESTS}",
            "FRICTIONJOINT_PYTHON": "1",
            "FRICTIONJOINT_MOTIONS": "100",
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        files = [str(TESTS / f"test_{x}.py") for x in SUBSET]
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-x",
            "-q",
            "-p",
            "no:cacheprovider",
            "-o",
            "addopts=",
            *files,
        ]
        try:
            done = subprocess.run(command, env=env, cwd=folder, capture_output=True, timeout=300)
        except subprocess.TimeoutExpired:
            return "killed (hangs)"
    if done.returncode not in (0, 1, 2):
        raise SystemExit(done.stdout.decode() + done.stderr.decode())
    return "survived" if done.returncode == 0 else "killed"


def judged(name: str, what: str, source: str) -> tuple[str, str]:
    """The verdict on a mutant, and the proof where it is equivalent."""
    found = verdict(name, source)
    proof = EQUIVALENT.get((name, what.partition(": ")[2]), "")
    if found == "survived" and proof:
        return "equivalent", proof
    return found, ""


def main() -> int:
    """Run, print the table, count."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mutants", type=int, default=48)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    if verdict(None, "") != "survived":
        raise SystemExit("the law as it stands fails its tests: mend that first")
    rows = []
    if not given.json:
        print("| verdict | file | edit | why equivalent |\n| --- | --- | --- | --- |", flush=True)
    for name, what, source in mutants(given.mutants, given.seed):
        found, proof = judged(name, what, source)
        rows.append((found, name, what, proof))
        if not given.json:
            print(f"| {found} | {name} | `{what}` | {proof} |", flush=True)
    survived = sum(row[0] == "survived" for row in rows)
    equivalent = sum(row[0] == "equivalent" for row in rows)
    killed = len(rows) - survived - equivalent
    summary = f"{killed} of {len(rows)} killed, {equivalent} equivalent, {survived} survived"
    print(json.dumps(rows) if given.json else f"\n{summary}")
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
