"""Public names: each has a docstring in numpydoc form, with an example that runs, and shows itself under its name."""

import doctest
import inspect
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

import solver
import studies
import workbench
from docs.website import api_pages
from tests.slow import slow_but
from tests.workbench.command import output_of

SOLVER = [f"solver.{name}" for name in solver.__all__]
PATHS = [*SOLVER, *(path for package in ("studies", "workbench") for path in api_pages.PUBLIC[package])]
METHODS = {
    "solver.Solution": ("sensitivity", "to_dataset"),
    "workbench.stored.stored_study.StoredStudy": ("sel", "at", "plot"),
}
SLOW = {"solver.region_map", "solver.fold_curves", "solver.trace_fold"}  # more than a second each


def examples(path: str) -> list[doctest.DocTest]:
    """The examples of a public name, and of those of its methods that have one."""
    finder, thing = doctest.DocTestFinder(recurse=False), api_pages.object_at(path)
    if not (inspect.isclass(thing) or callable(thing)):
        return []
    things = [thing, *(getattr(thing, name) for name in METHODS.get(path, ()))]
    return [one for each in things for one in finder.find(each, path) if one.examples]


def failures(test: doctest.DocTest) -> str:
    told: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE, verbose=False).run(test, out=told.append)
    return "".join(told)


WITH_EXAMPLES = [path for path in PATHS if examples(path)]


@pytest.mark.parametrize("path", slow_but(WITH_EXAMPLES, *{*WITH_EXAMPLES} - SLOW))
def test_the_example_of_a_public_name_gives_what_it_shows(path: str) -> None:
    for example in examples(path):
        assert failures(example) == ""


def test_every_public_function_and_most_classes_have_an_example() -> None:
    data = {
        "studies.READINGS",
        "studies.TABLE_1",
        "workbench.export.file_format.ExportOptions",
    }  # the first two are data
    assert {*PATHS} - {*WITH_EXAMPLES} == data


def test_an_example_that_shows_another_value_is_found() -> None:
    (test,) = doctest.DocTestFinder().find(type("Wrong", (), {"__doc__": ">>> 1 + 1\n3\n", "__module__": __name__}))
    assert "Expected" in failures(test)


@pytest.mark.parametrize("name", solver.__all__)
def test_the_docstring_of_a_public_name_has_the_sections_of_numpydoc(name: str) -> None:
    thing = getattr(solver, name)
    sections = re.findall(r"^ *(\w+)\n *-{4,}$", thing.__doc__, re.MULTILINE)
    assert sections[-1] == "Examples"
    assert set(sections) <= {"Parameters", "Attributes", "Returns", "Raises", "Notes", "Examples"}
    is_error = isinstance(thing, type) and issubclass(thing, ValueError)
    assert is_error or {"Parameters", "Attributes"} & set(sections)


def test_each_package_shows_its_public_names_and_its_version() -> None:
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for package in (solver, studies, workbench):
        assert package.__version__ == project["version"]
    for public in (solver, studies):
        assert set(dir(public)) == {*public.__all__, "__version__"}


def test_a_name_that_a_function_shares_with_its_module_is_the_function_whatever_was_imported_before() -> None:
    names = ["equilibria", "follow", "loops", "observe", "region_map", "solve", "switch"]
    code = f"""
import solver.follow, solver.solve, solver.observe.observables
from solver.region_map import regions_of
import solver
print(*[getattr(solver, name).__name__ for name in {names}])
"""
    assert output_of(code) == names


def test_a_patch_of_a_public_name_ends_with_the_patch(monkeypatch) -> None:
    with monkeypatch.context() as patched:
        patched.setattr(sys.modules["solver.loops"], "loops", "patched")
        assert solver.loops == "patched"
    assert callable(solver.loops)


def test_what_plots_shows_or_runs_has_the_type_of_what_it_gives() -> None:
    """A type checker, and an editor, know what ``study.run().verdicts`` is.

    A dataset is of xarray, which these packages do not name.
    """
    given = {}
    for path in PATHS:
        kind = api_pages.object_at(path)
        methods = (
            [(name, method) for name, method in vars(kind).items() if inspect.isfunction(method)]
            if inspect.isclass(kind)
            else []
        )
        for name, method in methods:
            if name != "to_dataset" and {"make", "import_module"} & {*method.__code__.co_names}:
                given[f"{path}.{name}"] = inspect.signature(method).return_annotation
    assert {"studies.Study.run", "solver.Solution.plot", "solver.Solution.scene"} <= {*given}
    assert [path for path, annotation in given.items() if annotation in (Any, "Any", inspect.Signature.empty)] == []
