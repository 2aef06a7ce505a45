"""A number without a unit that looks like degrees is read in rad, with one notice that says so."""

import dataclasses
import math
import warnings

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Start, follow, solve
from solver.problem.field_values import doubt
from solver.problem.notices import AngleWarning
from studies import load
from studies.language.loader import loads, notices

HEAD = 'title = "One rod"\nunits = { length = "cm", force = "N" }\n'
ROD = "[base]\nE = 1e4\nnu = 0.25\na = 0.25\nL = 20.0\nR = 0.75\n"
FIVE = 'beta0 = 5 is read as 5 rad = 286.48 degrees; write "5 deg" if degrees are meant, or "5 rad"'


def said(make) -> list[str]:
    """The notices of a call, in order."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        make()
    assert all(one.category is AngleWarning for one in found)
    return [str(one.message) for one in found]


@pytest.mark.parametrize("value", [4, 5, -5, 22.5, 30, 63.43, 390, "5", "45.0", np.array([0.1, 30]), [0.0, 45]])
def test_what_looks_like_degrees_is_doubted(value) -> None:
    assert "is read as" in doubt("beta", value)


@pytest.mark.parametrize(
    "value",
    [0, 1, 3, -3.1, math.pi, 3.14, 6.28, 2 * math.pi, math.radians(390), "5 rad", "5deg", "7pi/2", None, math.inf],
)
def test_what_may_well_be_radians_or_has_a_unit_is_not_doubted(value) -> None:
    assert doubt("beta", value) == ""


def test_a_case_in_python_says_how_a_large_angle_is_read() -> None:
    assert said(lambda: Ends(beta0=5, betaL=0.5)) == [FIVE]
    assert said(lambda: Ends(beta0=np.linspace(0, 60, 7), betaL="5 rad")) == [FIVE.replace("5", "60", 2).replace(
        "286.48", "3437.75").replace('"5', '"60')]  # fmt: skip
    assert len(said(lambda: Start(beta=30.0, dbeta=0.1, M3=0.0))) == 1
    assert said(lambda: dataclasses.replace(Ends("5 rad", "30 deg"), betaL=0.2)) != []  # the text is gone by then


def test_follow_says_it_too_and_solving_says_nothing_more() -> None:
    case = Case(Rod(E=325.95, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.5))
    solution = solve(case)
    with pytest.warns(AngleWarning, match="betaL = 5 is read as 5 rad") as found, pytest.raises(InputError):
        follow(solution, betaL=[0.5, 5], points=0)
    assert len(found) == 1
    assert found[0].filename == __file__
    branch = follow(solution, betaL="30 deg")  # as the notice advises
    assert branch.values[-1] == math.pi / 6


def test_the_warning_is_at_the_line_of_the_program() -> None:
    with pytest.warns(AngleWarning) as found:
        Ends(beta0=5, betaL=0.5)
    assert found[0].filename == __file__


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (ROD + "betaL = 0.5\nbeta0 = 5\n", 10),
        (ROD + "betaL = 0.5\n[axes.beta0]\nvalues = [0.5, 5]\n", 10),
        (ROD + "betaL = 0.5\n[axes.beta0]\nfrom = 0\nto = 5\ncount = 3\n", 10),
        (ROD + "betaL = 0.5\n[zip]\nbeta0 = [0.5, 5]\n", 11),
        (ROD + "betaL = 0.5\n[sample]\nsize = 2\n[sample.beta0]\nfrom = 1\nto = 5\n", 12),
    ],
)
def test_a_study_says_it_once_with_its_line(text, line) -> None:
    told = said(lambda: loads(HEAD + text).case())
    assert told == [f"study, line {line}: {FIVE}"]
    assert notices(HEAD + text) == told


def test_a_study_with_units_beside_its_angles_is_silent() -> None:
    ends = 'beta0 = "5 rad"\n[axes.betaL]\nvalues = [0, 30]\nunit = "deg"\n'
    assert said(lambda: loads(HEAD + ROD + ends).case()) == []
    assert said(lambda: load("fig7_4_end_angle").case()) == []


def test_a_table_of_cases_is_read_in_rad_with_the_same_notice(tmp_path) -> None:
    (tmp_path / "cases.csv").write_text("beta0,betaL\n0.1,0.2\n5,30deg\n")
    (tmp_path / "s.toml").write_text(HEAD + ROD + '[table]\nfile = "cases.csv"\n')
    assert said(lambda: load(tmp_path / "s.toml")) == [f"s.toml, line 9: {FIVE}"]
