"""The loads and the end moments are observables: of held ends they are the reactions."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from solver import Case, Cylinder, Ends, Rod, Start, fit, observe, solve
from studies import Study
from studies.language.loader import loads
from studies.laws.line_verdicts import HOLDS
from tests.workbench import small
from workbench.run import in_memory
from workbench.run.run_and_resume import RunOptions, run_to_file
from workbench.stored import stored_verdicts

ROD, WALL = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75)
NAMES = ("FZ", "MZ", "M3", "M10", "M1L")
BASE = {**small.SHORT, "beta0": "20deg", "betaL": "20deg"}


@pytest.mark.parametrize(
    "ends",
    [
        Ends(beta0=0.3, betaL=0.5, height=4.2, rotation=0.4),
        Ends(beta0=0.3, M1L=2.0, height=4.2),
        Ends(beta0=0.3, betaL=0.6, FZ=-8.0, MZ=1.0, M3=3.0),
    ],
)
def test_the_loads_and_the_moments_at_the_ends_are_those_of_the_solution(ends: Ends) -> None:
    sol = solve(Case(ROD, WALL, ends))
    found = observe(sol, NAMES, errors=True)
    assert {name: found[name] for name in sol.reactions if name in NAMES} == {
        name: load for name, load in sol.reactions.items() if name in NAMES
    }
    assert [found[name] for name in NAMES[:3]] == [sol.FZ, sol.MZ, sol.M3]
    assert [found["M10"], found["M1L"]] == pytest.approx([sol.M1[0], sol.M1[-1]], rel=1e-14)
    assert 0 < found["M10_error"] < 1e-9
    assert "FZ_error" not in found


def test_the_moments_are_known_where_no_station_is_at_the_ends() -> None:
    case = Case(ROD, WALL, Start(beta=0.5, dbeta=0.4, F3=10.0, M3=2.0))
    part, whole = (observe(solve(case, stations=n), ["M10", "M1L"]) for n in ([2.0, 3.0], 5))
    assert part == pytest.approx(whole, rel=1e-9)


def test_the_error_of_a_moment_covers_its_difference_from_an_exact_solution() -> None:
    case = Case(ROD, WALL, Start(beta=0.5, dbeta=0.4, F3=10.0, M3=2.0))
    exact = observe(solve(case, tol=1e-13), ["M1L"])["M1L"]
    for tol in (1e-3, 1e-5, 1e-7):
        rough = observe(solve(case, tol=tol, method="dop853"), ["M1L"], errors=True)
        assert abs(rough["M1L"] - exact) <= rough["M1L_error"] + 1e-10


def test_a_held_force_answers_the_height_as_differences_say() -> None:
    def force(height: float) -> float:
        ends = Ends(beta0=0.3, betaL=0.5, height=height)
        return float(observe(solve(Case(ROD, WALL, ends), seed=first), ["FZ"])["FZ"])

    first = solve(Case(ROD, WALL, Ends(beta0=0.3, betaL=0.5, height=4.2)))
    slope = first.sensitivity(["height"], ["FZ"]).observables["FZ"][0]
    assert slope == pytest.approx((force(4.2 + 1e-4) - force(4.2 - 1e-4)) / 2e-4, rel=1e-6)


def test_a_fit_finds_the_end_angle_that_asks_for_a_moment() -> None:
    case = Case(ROD, WALL, Ends(beta0=0.3, betaL=0.5, FZ=-8.0))
    wanted = float(observe(solve(Case(ROD, WALL, Ends(beta0=0.3, betaL=0.45, FZ=-8.0))), ["M10"])["M10"])
    found = fit(case, ["betaL"], {"M10": wanted}, starts=1)
    assert float(found.solution.case.given.betaL) == pytest.approx(0.45, rel=1e-8)


def pushed(axis: str, values: tuple[float, float, int], observable: str) -> Study:
    tables = small.axis(axis, values) + small.law(observable, axis, "rises", says="rises")
    names = ["turns_around", "M10", "FZ"]
    return loads(small.text(BASE, tables, observables=names, outputs=[], stations=21), "text", "pushed")


def test_a_study_stores_reactions_and_judges_a_law_of_one(tmp_path: Path) -> None:
    study = pushed("height", (4.6, 4.4, 3), "FZ")
    run_to_file(study, tmp_path / "pushed.h5", RunOptions(workers=1))
    with xr.open_dataset(tmp_path / "pushed.h5") as ds:
        assert ds["M10"].attrs["units"] == "N cm" or ds["M10"].attrs["units"] == "cm N"
        assert list(ds["M10_error"].dims) == ["height"]
        assert (np.diff(ds["FZ"]) != 0).all()
        assert [row["verdict"] for row in stored_verdicts.verdicts(ds)] == [HOLDS]


def test_a_load_that_is_an_axis_is_not_stored_twice() -> None:
    ds = in_memory.run(pushed("FZ", (-9.0, -7.0, 3), "M10"))
    assert ds["FZ"].dims == ("FZ",)
    assert "M10" in ds.data_vars
