"""Which floor may import what, decided by reading the source and not by running it."""

import ast
import subprocess
import sys
from collections.abc import Iterator, Set
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

SOLVER = {"numpy", "scipy", "heyoka", "unopy"}  # the last two are optional, imported where their methods run
STUDIES = SOLVER | {
    "solver", "tomllib", "pydantic", "tomli_w",
    "pyarrow",  # optional: reads tables of cases in Parquet, imported where it reads
}  # fmt: skip
WORKBENCH = STUDIES | {
    "studies", "xarray", "h5netcdf", "h5py", "filelock", "pyvista", "matplotlib", "trimesh", "typer", "rich", "jinja2",
    "distributed",  # optional: the engine of a cluster, imported where it runs
    "imageio",  # optional: films
    "PIL",  # Matplotlib needs it
    "SALib",  # optional: Sobol' indices, imported where they are computed
    "OCP",  # optional: Open Cascade, imported where a STEP file is written
    "aiohttp",  # optional: the live page
    "pandas",  # xarray brings it
}  # fmt: skip
FLOORS = {"solver": SOLVER, "studies": STUDIES, "workbench": WORKBENCH}

# The parts of a package in order: each imports only from those before it, and from itself.
LISTS = {
    "solver": [
        "numerics", "problem", "core", "orbits", "branches", "nodes", "held", "free", "methods", "observe",
        "solution", "each_case", "solve", "equilibria_result", "equilibria", "follow_result", "follow", "switch",
        "trace_fold", "region_map", "loops", "fits",
    ],
    "studies": ["tenants", "grammar", "laws", "language", "paper"],
    "workbench": [
        "words", "geometry", "stored", "run", "branches", "influence", "fitting", "figures", "scene", "export",
        "web", "notebook", "commands", "lab", "paper", "accessor", "cli",
    ],
}  # fmt: skip

FUNCTIONS = ast.FunctionDef | ast.AsyncFunctionDef
STDLIB = sys.stdlib_module_names - {"tomllib"}  # file formats are no business of the mechanics
HEAVY = {
    "numpy", "scipy", "pandas", "xarray", "h5netcdf", "h5py", "pyvista", "vtk", "vtkmodules", "matplotlib", "OCP",
    "aiohttp",
}  # fmt: skip


def is_for_type_checkers_only(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test) in {"TYPE_CHECKING", "typing.TYPE_CHECKING"}


def imported(node: ast.AST, package: str, at_start_only: bool = False) -> Iterator[str]:
    """Absolute dotted names that `node` imports; relative ones are resolved against `package`.

    `from a import b` gives both `a` and `a.b`, as b may be a module. With `at_start_only`, function bodies
    and `if TYPE_CHECKING` are left out: what remains runs when the module is first imported.
    """
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
        base = ".".join([*above, *([node.module] if node.module else [])])
        yield base
        yield from (f"{base}.{alias.name}" for alias in node.names)
    elif at_start_only and is_for_type_checkers_only(node):
        assert isinstance(node, ast.If)
        for child in node.orelse:
            yield from imported(child, package, at_start_only)
    elif not isinstance(node, ast.expr) and not (at_start_only and isinstance(node, FUNCTIONS)):
        for child in ast.iter_child_nodes(node):
            yield from imported(child, package, at_start_only)


@cache
def tree_of(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


@cache
def imports_of(file: Path, at_start_only: bool = False) -> frozenset[str]:
    package = ".".join(file.relative_to(ROOT).parent.parts)
    return frozenset(imported(tree_of(file), package, at_start_only))


def tops(names: Set[str]) -> set[str]:
    return {name.partition(".")[0] for name in names}


def reaches(names: set[str], modules: set[str]) -> set[str]:
    """Those of `names` that are one of `modules` or lie inside one."""
    return {name for name in names if any(f"{name}.".startswith(f"{module}.") for module in modules)}


def files_of(*patterns: str) -> list[Path]:
    found = sorted(file for pattern in patterns for file in ROOT.glob(pattern))
    assert found, f"no file matches {patterns}: this test would pass by looking at nothing"
    return found


@pytest.mark.parametrize("floor", FLOORS)
def test_a_floor_imports_only_what_lies_below_it(floor: str) -> None:
    allowed = FLOORS[floor] | STDLIB | {floor}
    breaches = {
        str(file.relative_to(ROOT)): sorted(tops(imports_of(file)) - allowed) for file in files_of(f"{floor}/**/*.py")
    }
    assert {file: names for file, names in breaches.items() if names} == {}


def test_the_solver_names_the_workbench_only_where_a_solution_is_shown() -> None:
    named = {module_of(file) for file in files_of("solver/**/*.py") if '"workbench' in file.read_text(encoding="utf-8")}
    shows = {"solver.problem.shown", "solver.follow_result"}  # load it by name
    assert named == shows | {"solver.problem.notices"}  # tells the workbench's own calls from those of a user
    code = "import sys; from solver import *; print([n for n in sys.modules if n.partition('.')[0] == 'workbench'])"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["[]"]


def test_methods_see_dimensionless_numbers_and_never_a_case() -> None:
    for file in files_of("solver/methods/*.py"):
        seen = reaches(imports_of(file), {"solver.problem.case", "solver.Case", "solver.Rod", "solver.Cylinder"})
        assert not seen, f"{file.name} can see E and R"


def module_of(file: Path) -> str:
    return ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def arrows(top: str) -> set[tuple[str, str]]:
    """Pairs of modules: each module of a package and what it imports of the same package, inside functions too."""
    files = files_of(f"{top}/**/*.py")
    modules = {module_of(file) for file in files}
    found = set()
    for file in files:
        for name in imports_of(file):
            target = name if name in modules else name.rpartition(".")[0]
            if target in modules and target != top and not file.name.startswith("__main__"):
                found.add((module_of(file), target))
    return found


def part_of(module: str, parts: list[str]) -> str:
    """The sub-package, or the module at the top, in which a module lies."""
    (found,) = [part for part in parts if f"{module}.".startswith(f"{part}.")]
    return found


@pytest.mark.parametrize("top", ("solver", "workbench"))
def test_a_sub_package_imports_only_from_those_above_it_in_the_list(top: str) -> None:
    parts = [f"{top}.{part}" for part in LISTS[top]]
    upward = {
        (module, target)
        for module, target in arrows(top)
        if module != top and parts.index(part_of(target, parts)) > parts.index(part_of(module, parts))
    }
    assert upward == set()


def test_what_draws_and_exports_is_given_a_stored_study_and_never_its_dataset() -> None:
    """Makers of new datasets, in the report, return them and take none."""
    found = []
    for file in files_of(*(f"workbench/{part}/**/*.py" for part in ("figures", "scene", "geometry", "export", "web"))):
        for node in ast.walk(tree_of(file)):
            asks = isinstance(node, ast.Attribute) and node.attr == "ds" and isinstance(node.ctx, ast.Load)
            takes = (
                isinstance(node, ast.arg) and node.annotation is not None and "Dataset" in ast.unparse(node.annotation)
            )
            if asks or takes:
                found.append(f"{file.relative_to(ROOT)}:{node.lineno}")
    assert found == []


def test_drawing_loads_no_method_of_the_solver() -> None:
    parts = ("words", "geometry", "figures", "scene")
    assert methods_loaded_by([file for part in parts for file in files_of(f"workbench/{part}/**/*.py")]) == []


def test_the_solver_loads_its_methods_only_when_a_case_is_solved() -> None:
    files = [file for file in files_of("solver/**/*.py") if not reaches({module_of(file)}, {"solver.methods"})]
    assert methods_loaded_by(files) == []


def methods_loaded_by(files: list[Path]) -> list[str]:
    """The modules of `solver.methods` that a new process holds after it imported these files."""
    code = (
        f"import importlib, sys\nfor name in {[module_of(file) for file in files]}: importlib.import_module(name)\n"
        "print(*[name for name in sys.modules if f'{name}.'.startswith('solver.methods.')])"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout.split()


def test_only_commands_print_or_know_an_exit_status() -> None:
    def speaks(node: ast.AST) -> bool:
        if isinstance(node, ast.Attribute):
            return (
                node.attr in ("exit", "stdout", "stderr")
                and isinstance(node.value, ast.Name)
                and node.value.id == "sys"
            )
        return isinstance(node, ast.Name) and node.id in ("print", "SystemExit", "exit")

    found = {
        module_of(file)
        for file in files_of("workbench/**/*.py", "studies/*.py", "solver/**/*.py")
        if {"typer", "rich"} & tops(imports_of(file)) or any(speaks(node) for node in ast.walk(tree_of(file)))
    }
    of_tenants = {"workbench.paper.reproduce", "workbench.lab.trade"}
    allowed = {name for name in found if name.startswith("workbench.commands.")} | {"workbench.cli"} | of_tenants
    assert found - allowed == set()


def test_the_command_line_imports_what_is_heavy_only_inside_functions() -> None:
    (cli,) = files_of("workbench/cli.py")
    assert tops(imports_of(cli, at_start_only=True)) & HEAVY == set()


def test_importing_the_solver_and_the_studies_loads_no_part_of_scipy() -> None:
    code = (
        "import sys, solver, studies\n"
        "for name in solver.__all__: name == 'fit' or getattr(solver, name)\n"  # a fit is a search of scipy
        "print(*[name for name in sys.argv[1:] if name in sys.modules])"
    )
    words = [sys.executable, "-c", code, "scipy.optimize", "scipy.special", "scipy.linalg", "scipy.stats"]
    ran = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    assert ran.stdout.split() == []


def test_the_names_and_the_units_of_quantities_need_no_numerics() -> None:
    code = "import sys, solver.problem.quantities; print(*{'numpy', 'scipy', 'solver.solve'} & set(sys.modules))"
    ran = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert ran.stdout.split() == []


def test_importing_the_command_line_loads_nothing_heavy_through_a_back_door() -> None:
    code = f"import sys, workbench.cli; print(*sorted({HEAVY!r} & set(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == []


def test_the_reader_finds_imports_wherever_they_hide() -> None:
    source = """
import os.path as p, numpy
from . import near
from ..case import Rod
if TYPE_CHECKING:
    import xarray
else:
    import rich
try:
    import h5py
except ImportError:
    pass
class A:
    import pyvista
def f():
    import scipy.special
    async def g():
        from matplotlib import pyplot
"""
    at_start = {
        "os.path", "numpy", "solver.methods", "solver.methods.near", "solver.case", "solver.case.Rod", "rich",
        "h5py", "pyvista",
    }  # fmt: skip
    later = {"xarray", "scipy.special", "matplotlib", "matplotlib.pyplot"}
    tree = ast.parse(source)
    assert set(imported(tree, "solver.methods", at_start_only=True)) == at_start
    assert set(imported(tree, "solver.methods")) == at_start | later
