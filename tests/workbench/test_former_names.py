"""Names of 0.2.0 that are read until 0.5.0: in Python, in studies, on the command line, and in a file of 0.2.0."""

import gzip
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

import workbench.accessor  # noqa: F401
from solver import Case, Cylinder, Ends, Rod, Start, equilibria, fit, loops, observe, solve
from solver.observe.observables import OBSERVABLES
from solver.problem.notices import RenamedWarning
from solver.problem.quantities import RENAMED
from studies import loads
from workbench.run import in_memory

BENDS = "'turns' is now called 'bends'; the old name is read until 0.5.0"
AROUND = "'wraps' is now called 'turns_around'; the old name is read until 0.5.0"
ROD, CYLINDER = Rod(E=1.07e4, nu=0.25, a=0.1, L=10.0), Cylinder(R=0.9)
OLD = """
title = "turns and wraps"
units = { length = "cm", force = "N" }
reading = "force-first/tension/paper"
observables = ["turns", "wraps"]
outputs = []
[expressions]
share = "wraps/turns"
[axes.E]
values = [1e4, 2e4]
[refine]
watch = ["turns", "wraps"]
tolerance = 0.5
steps = { wraps = 0.1 }
[[laws]]
claim = "turns"
observable = "turns"
axis = "E"
direction = "falls"
source = "turns fall"
also = ["wraps"]
[[laws]]
claim = "(2)"
kind = "equals"
observable = "wraps"
axis = "E"
formula = "turns/100"
relative = 9.0
source = "turns"
"""


@pytest.fixture
def old_file(tmp_path: Path) -> Path:
    """A file that 0.2.0 wrote."""
    path = tmp_path / "old.h5"
    path.write_bytes(gzip.decompress((Path(__file__).parent / "of_0.2.0.h5.gz").read_bytes()))
    return path


def test_no_observable_has_a_former_name() -> None:
    assert RENAMED.keys().isdisjoint(OBSERVABLES)
    assert {*RENAMED.values()} <= {*OBSERVABLES, "turns_around_error"}


def call_with_notices(compute: Callable[[], Any], *notices: str) -> Any:
    """What a call returns, which gives these notices at its line."""
    with pytest.warns(RenamedWarning) as said:
        result = compute()
    assert {str(one.message) for one in said} == {*notices}
    assert {one.filename for one in said} == {__file__}
    return result


def test_python_of_0_2_0_runs_with_a_notice_for_each_name() -> None:
    sol = solve(Case(ROD, CYLINDER, Start(0.5, 0.5, M3=0.1)))
    seen = call_with_notices(lambda: observe(sol, ["turns", "wraps"], errors=True), BENDS, AROUND)
    assert list(seen) == ["bends", "turns_around", "turns_around_error"]
    for old, new in RENAMED.items():
        assert call_with_notices(lambda old=old: seen[old], BENDS if old == "turns" else AROUND) == seen[new]
    with pytest.raises(KeyError):
        seen["turn"]
    rates = call_with_notices(lambda: sol.sensitivity(["E"], ["wraps"]), AROUND).observables
    assert call_with_notices(lambda: rates["wraps"], AROUND) is rates["turns_around"]
    wanted = seen["turns_around"]
    assert call_with_notices(lambda: fit(sol.case, ["dbeta"], targets={"wraps": wanted}, starts=0), AROUND).groups
    (one, *_) = equilibria(Case(ROD, CYLINDER, Ends(0.5, 0.8)))
    assert call_with_notices(lambda: one.turns, BENDS) == one.bends
    (loop, *_) = call_with_notices(lambda: loops(ROD, CYLINDER, wraps=1, folds=1), AROUND)
    assert call_with_notices(lambda: loop.wraps, AROUND) == loop.turns_around == 1


def test_a_study_with_former_names_is_the_one_with_names_of_today_and_its_prose_stays() -> None:
    today = OLD.replace("wraps/turns", "turns_around/bends").replace("{ wraps =", "{ turns_around =")
    for key in ("observables = ", "watch = ", "observable = ", "also = ", "formula = "):
        lines = (line.replace("turns", "bends").replace("wraps", "turns_around") if line.startswith(key) else line
                 for line in today.split("\n"))  # fmt: skip
        today = "\n".join(lines)
    study = call_with_notices(lambda: loads(OLD), BENDS, AROUND)
    assert study.model_dump() == loads(today).model_dump()
    assert (study.title, study.laws[0].claim, study.laws[1].source) == ("turns and wraps", "turns", "turns")
    assert loads(study.text).laws == study.laws  # without a notice, which would be an error here
    assert {"bends", "turns_around", "share"} == {*in_memory.run(study).rod.observables}


def test_a_file_of_0_2_0_has_the_names_of_today(old_file: Path, call: Any) -> None:
    status, told, notices = call("summary", old_file)
    assert (status, "turns_around" in told, "wraps" in told) == (0, True, False)
    assert notices == f"workbench: notice: {BENDS}\nworkbench: notice: {AROUND}\n"
    assert call("plot", old_file, "--show", "turns,wraps", "--out", old_file.with_suffix(".png"))[0] == 0
    with xr.open_dataset(old_file) as ds:
        stored = call_with_notices(lambda: ds.rod, BENDS, AROUND)
        assert stored.observables == ["bends", "turns_around", "share"]
        assert stored.verdicts[0]["observable"] == "bends"
        assert stored["share"].attrs["expression"] == "turns_around/bends"
        for name in ("turns_around", "turns_around_error"):
            assert "wraps" not in "".join(map(str, stored[name].attrs.values()))
        assert call_with_notices(lambda: stored.at(E=1e4), BENDS, AROUND).solved.all()
        assert call_with_notices(lambda: stored.boundary("turns"), BENDS).sizes["pair"] == 1


def test_the_command_line_takes_a_former_name_with_one_line(call: Any) -> None:
    effects = ("sensitivity", "fig7_1_modulus", "--at", "E=5000", "--show", "wraps")
    for words in (("loops", "--wraps", 1, "--folds", 2), effects):
        status, told, notices = call(*words)
        assert (status, "turns_around" in told) == (0, True)
        assert notices == f"workbench: notice: {AROUND}\n"
