"""Each public name of the solver has a docstring in numpydoc form, with an example that runs."""

import doctest
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import solver
import studies
import workbench
from tests.slow import slow_but

RUNNER_FLAGS = doctest.NORMALIZE_WHITESPACE


SLOW = {"region_map", "fold_curves", "trace_fold"}  # more than a second each


def examples(name: str) -> list[doctest.DocTest]:
    finder = doctest.DocTestFinder(recurse=False)
    return [one for one in finder.find(getattr(solver, name), name) if one.examples]


@pytest.mark.parametrize("name", slow_but(solver.__all__, *{*solver.__all__} - SLOW))
def test_the_example_of_a_public_name_gives_what_it_shows(name: str) -> None:
    (example,) = examples(name)
    told: list[str] = []
    runner = doctest.DocTestRunner(optionflags=RUNNER_FLAGS, verbose=False)
    runner.run(example, out=told.append)
    assert runner.failures == 0, "".join(told)


@pytest.mark.parametrize("name", solver.__all__)
def test_the_docstring_of_a_public_name_has_the_sections_of_numpydoc(name: str) -> None:
    text = getattr(solver, name).__doc__
    sections = re.findall(r"^ *(\w+)\n *-{4,}$", text, re.MULTILINE)
    assert sections[-1] == "Examples"
    assert set(sections) <= {"Parameters", "Attributes", "Returns", "Raises", "Notes", "Examples"}
    if not issubclass(getattr(solver, name), ValueError) if isinstance(getattr(solver, name), type) else True:
        assert {"Parameters", "Attributes"} & set(sections)


def test_each_package_shows_its_public_names_and_its_version() -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for package in (solver, studies, workbench):
        assert package.__version__ == project["version"]
    for public in (solver, studies):
        assert set(dir(public)) == {*public.__all__, "__version__"}


def test_a_name_that_a_function_shares_with_its_module_is_the_function_whatever_was_imported_before() -> None:
    code = """
import solver.follow, solver.solve, solver.observe.observables
from solver.region_map import regions_of
import solver
from solver import equilibria, follow, loops, observe, region_map, solve, switch
named = equilibria, follow, loops, observe, region_map, solve, switch
print(*[value.__name__ for value in named], solver.solve is solve)
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.split() == ["equilibria", "follow", "loops", "observe", "region_map", "solve", "switch", "True"]


def test_a_patch_of_a_public_name_ends_with_the_patch(monkeypatch) -> None:
    with monkeypatch.context() as patched:
        patched.setattr(sys.modules["solver.loops"], "loops", "patched")
        assert solver.loops == "patched"
    assert callable(solver.loops)
