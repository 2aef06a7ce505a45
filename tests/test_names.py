"""Names: a verb for a function that acts, a noun for one that returns a thing, a participle for data; a variable says
what it holds."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

ROOT = Path(__file__).parents[1]
PARTICIPLE = re.compile(r"[a-z]{2,}(?:ed|ing)|told|shown|drawn|kept|begun|found|made|grown")
# Nouns, and adjectives that begin a noun: `bending_stiffness`, `held_index`.
NOUNS = "arriving bending buckling meaning reading refusing"

# They name nothing: say what it is (`equilibrium`, `sentence`, `problem`).
VAGUE = "asked both found given_back here made one own some there thing told wanted"


@cache
def syntax_trees() -> dict[Path, ast.Module]:
    files = (file for part in ("solver", "studies", "workbench") for file in (ROOT / part).rglob("*.py"))
    return {file.relative_to(ROOT): ast.parse(file.read_text(encoding="utf-8")) for file in files}


def python_files() -> Iterator[Path]:
    """The Python files of the product and of its tests."""
    return (file for part in ("solver", "studies", "workbench", "tests") for file in (ROOT / part).rglob("*.py"))


def is_record(owner: ast.ClassDef) -> bool:
    above = [ast.unparse(node) for node in (*owner.decorator_list, *owner.bases)]
    return any(word in name for name in above for word in ("dataclass", "NamedTuple"))


def is_data(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    decorators = map(ast.unparse, function.decorator_list)
    return any(word in decorator for decorator in decorators for word in ("property", "setter", "overload"))


@cache
def names_with_a_participle() -> set[str]:
    names, beside = set(), (ROOT / "benchmarks").glob("*.py")
    for tree in [*syntax_trees().values(), *(ast.parse(file.read_text(encoding="utf-8")) for file in beside)]:
        for node in ast.walk(tree):
            if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) or node.name.startswith("__"):
                continue
            first = node.name.strip("_").split("_")[0]
            if not is_data(node) and first not in NOUNS.split() and PARTICIPLE.fullmatch(first):
                names.add(node.name)
    return names


def vague_names(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """The line and the name of each variable and function that bears a vague word; fields and properties are data."""
    fields = {
        id(node.target)
        for owner in ast.walk(tree)
        if isinstance(owner, ast.ClassDef)
        for node in owner.body
        if isinstance(node, ast.AnnAssign)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and id(node) not in fields:
            name = node.id
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and not is_data(node):
            name = node.name
        else:
            continue
        if name.strip("_") in VAGUE.split():
            yield node.lineno, name


def test_no_function_is_named_by_a_participle() -> None:
    assert names_with_a_participle() == set()


def test_variables_and_functions_say_what_they_are() -> None:
    places = [f"{file}:{line} {name}" for file, tree in syntax_trees().items() for line, name in vague_names(tree)]
    places += [
        f"{file}:{node.lineno} {node.arg}"
        for file, tree in syntax_trees().items()
        if file.parts[0] == "solver" and len(file.parts) > 2
        for node in ast.walk(tree)
        if isinstance(node, ast.arg) and node.arg in {*VAGUE.split()} - {"wanted"}
    ]
    assert places == [], f"these words name nothing: {VAGUE}"


def test_a_record_that_one_module_alone_names_is_private_to_it() -> None:
    """Methods are public; so are the modules directly in the solver, with their results."""
    named = {file: set(re.findall(r"\b[A-Z]\w+", file.read_text(encoding="utf-8"))) for file in python_files()}
    records = [
        (file, node.name)
        for file, tree in syntax_trees().items()
        if file.parts[0] == "solver" and len(file.parts) > 2 and file.parts[1] != "methods"
        for node in tree.body
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_") and is_record(node)
    ]
    alone = [f"{file} {name}" for file, name in records if not any(name in named[o] for o in named if o != ROOT / file)]
    assert records
    assert alone == []


def test_no_two_modules_of_the_solver_share_a_name() -> None:
    names = sorted(file.stem for file in (ROOT / "solver").rglob("*.py") if file.stem != "__init__")
    assert [name for name, after in pairwise(names) if name == after] == []


def test_no_module_shares_the_name_of_a_package() -> None:
    packages = {file.parent.name for file in syntax_trees() if file.name == "__init__.py" and len(file.parts) > 2}
    assert packages
    assert [str(file) for file in syntax_trees() if file.stem in packages] == []


# Numbers of mathematics, of units and of layout, which nobody chose.
NOT_TUNED = {
    "numerics/arrays": "EPS",
    "numerics/complex_step": "STEP",
    "problem/declared_fields": "_POSITIVE _NOT_NEGATIVE _INCLINED _TILTED",
    "problem/errors": "LARGEST_SEED",
    "problem/units": "_POUND",
    "core/tuning": "ROUNDS SETTLED SMALL CONTRACTION",
    "orbits/potential": "TAU",
    "orbits/variations": "PAIRS",
    "nodes/local_waves": "EQUAL LIFTED LAST",
    "free/discrete_rod": "EDGE ENDS CONDITIONS",
    "methods/method": "TOLERANCES",
    "observe/measurement": "MIDDLE",
    "observe/motions": "LOST",
}


def constants_of(module: str) -> dict[str, str]:
    """The constants in the head of a module of the solver, each with its line and its comment."""
    text = (ROOT / "solver" / f"{module}.py").read_text(encoding="utf-8")
    lines, constants = text.splitlines(), {}
    for node in ast.parse(text).body:
        if isinstance(node, ast.Assign):
            first = node.lineno - 1
            while lines[first - 1].startswith("#"):
                first -= 1
            names = [part.id for part in ast.walk(node.targets[0]) if isinstance(part, ast.Name)]
            constants |= dict.fromkeys(names, " ".join(lines[first : node.end_lineno]))
    return constants


def test_a_tuned_constant_says_what_may_change_if_it_is_ten_times_larger() -> None:
    """Those of which `benchmarks/scaled.txt` says how many answers stay."""
    record = (ROOT / "benchmarks" / "scaled.txt").read_text(encoding="utf-8").partition("\n\n")[2]
    modules = re.findall(r"^([\w/]+): (.*(?:\n  .*)*)", record, re.MULTILINE)
    silent = []
    for module, measured in modules:
        constants = constants_of(module)
        for name in re.findall(r"(\w+)(?:\.\w+)? (?:\d+/\d+|-)", measured):
            is_told = "x10: " in constants.get(name, "").replace(" # ", " ")
            if not is_told and name not in NOT_TUNED.get(module, "").split():
                silent.append(f"{module} {name}" + ("" if name in constants else " is not there"))
    assert len(modules) > 60
    assert silent == []
