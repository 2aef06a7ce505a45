"""The example of each public name of the site's Python reference gives what it shows; `solver` has its own test."""

import doctest
import inspect

import pytest

from docs.website import api_pages

PATHS = ["solver.Solution", *(path for package in ("studies", "workbench") for path in api_pages.PUBLIC[package])]
METHODS = {"solver.Solution": ("sensitivity", "to_dataset"), "workbench.accessor.RodAccessor": ("sel", "at", "plot")}


def examples(path: str) -> list[doctest.DocTest]:
    """The examples of a public name, and of those of its methods that have one."""
    finder, thing = doctest.DocTestFinder(recurse=False), api_pages.found(path)
    if not (inspect.isclass(thing) or callable(thing)):
        return []
    things = [thing, *(getattr(thing, name) for name in METHODS.get(path, ()))]
    return [one for each in things for one in finder.find(each, path) if one.examples]


def failures(test: doctest.DocTest) -> str:
    told: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE, verbose=False).run(test, out=told.append)
    return "".join(told)


@pytest.mark.parametrize("path", [path for path in PATHS if examples(path)])
def test_the_example_of_a_public_name_gives_what_it_shows(path: str) -> None:
    for example in examples(path):
        assert failures(example) == ""


def test_every_public_function_and_most_classes_have_an_example() -> None:
    without = {path for path in PATHS if not examples(path)}
    assert without == {"studies.READINGS", "studies.TABLE_1", "workbench.export.base.Options"}  # the first two are data


def test_an_example_that_shows_another_value_is_found() -> None:
    (test,) = doctest.DocTestFinder().find(type("Wrong", (), {"__doc__": ">>> 1 + 1\n3\n", "__module__": __name__}))
    assert "Expected" in failures(test)
