"""The names of functions: a verb for one that acts, a noun for one that returns a thing; a participle is for data."""

import ast
import re
from functools import cache
from itertools import pairwise
from pathlib import Path

ROOT = Path(__file__).parents[1]
PARTICIPLE = re.compile(r"[a-z]{2,}(?:ed|ing)|told|shown|drawn|kept|begun|found|made|grown")
# Nouns, and adjectives that begin a noun: `bending_stiffness`, `held_energy`.
NOUNS = """
    arriving attached beginning bending branching buckling ceasing closed crossing dataset drawing embedding
    failed feed following given heading held hinged holding judging lacking lying meaning missing need
    needed encoding finding nothing overlapping packing reading refusing ring rounding running seed spacing
    speed standing steepening straightening string swing touching turning twisted unchecked unsolved varying
    wanted wording
"""


@cache
def names_with_a_participle() -> set[str]:
    found = set()
    for file in (file for part in ("solver", "studies", "workbench") for file in (ROOT / part).rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) or node.name.startswith("__"):
                continue
            is_data = any(
                word in ast.unparse(decorator)
                for decorator in node.decorator_list
                for word in ("property", "setter", "overload")
            )
            first = node.name.strip("_").split("_")[0]
            if not is_data and first not in NOUNS.split() and PARTICIPLE.fullmatch(first):
                found.add(node.name)
    return found


def test_no_function_is_named_by_a_participle() -> None:
    assert names_with_a_participle() == set()


def test_no_two_modules_of_the_solver_share_a_name() -> None:
    names = sorted(file.stem for file in (ROOT / "solver").rglob("*.py") if file.stem != "__init__")
    assert [name for name, after in pairwise(names) if name == after] == []
