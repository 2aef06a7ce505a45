"""`workbench solve` far from every ordinary rod: no traceback, no warning of NumPy, and reasons in words."""

import json

import pytest

from tests.workbench.command import exit_status

ROD = ["solve", "--E", "1e4", "--nu", ".25", "--a", ".25", "--L", "5"]
ENDS = ["--beta0", "20deg", "--betaL", "20deg"]
PITCH = "pitch is not defined: the rod does not turn about the axis in its middle third"


@pytest.mark.parametrize("far", [["--R", "1e110"], ["--R", "1e308"], ["--R", ".75", "--a", "1e308"]])
def test_a_cylinder_whose_radius_has_no_cube_gets_an_outcome(
    far: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_status(*[*ROD, *ENDS, *far]) == 1
    assert "failed: " in capsys.readouterr().out


def test_a_push_that_underflows_is_not_said_to_be_checked(capsys: pytest.CaptureFixture[str]) -> None:
    start = ["--beta", "30deg", "--dbeta", "0", "--M3", "0"]
    exit_status(*[*ROD, *start, "--R", "1e110"])
    told = capsys.readouterr().out
    assert "caution: The rod was not checked for lift-off." in told, told


def test_a_straight_rod_is_told_why_it_has_no_pitch(capsys: pytest.CaptureFixture[str]) -> None:
    straight = [*ROD, "--R", ".75", "--beta", "0", "--dbeta", "0", "--M3", "0"]
    assert exit_status(*straight) == 0
    assert f"solved; {PITCH} (" in capsys.readouterr().out
    assert exit_status(*[*straight, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["outcome"] == f"solved; {PITCH}"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "far", [["--E", "1e-300", "--beta", "30deg", "--dbeta", ".5", "--M3", "1"], ["--L", "1e-320", *ENDS]]
)
def test_numbers_beyond_floats_give_an_outcome_and_no_warning(
    far: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_status(*[*ROD, "--R", ".75", *far]) == 1
    shown = capsys.readouterr()
    assert "failed: " in shown.out
    assert "Warning" not in shown.err


def test_an_angle_without_finite_degrees_is_shown_in_radians_alone(capsys: pytest.CaptureFixture[str]) -> None:
    exit_status(*[*ROD, *ENDS, "--R", ".75", "--alpha", "1e308"])
    assert "inf" not in capsys.readouterr().out


def test_an_observable_beyond_floats_is_named_in_the_outcome(capsys: pytest.CaptureFixture[str]) -> None:
    """A/(rho^3 L) is beyond 1e308 there, and the mean pull is computed with it."""
    exit_status(*["solve", "--E", "1e4", "--nu", ".25", "--a", "1e-61", "--R", "1e-60", "--L", "1e-250",
            "--beta", "30deg", "--dbeta", "0", "--M3", "0"])  # fmt: skip
    assert "pull_mean is beyond floats in these units" in capsys.readouterr().out
