"""Laws with numbers on made-up lines, where the right verdict is seen at a glance."""

import re
from decimal import Decimal

import numpy as np
import pytest
from scipy.stats import linregress, t

from solver import InputError
from studies.language.loader import loads
from studies.laws.case_rows import Grid
from studies.laws.judgement import Law, decide
from studies.laws.law_kinds import FINEST, fit_power, with_error

HEAD = 'title = "one"\nreading = "force-first/tension/paper"\n[units]\nlength = "cm"\nforce = "N"\n'
AXES = "[axes.E]\nvalues = [1e4, 2e4]\n[axes.beta]\nvalues = [0.3, 0.6]\n"


def test_a_power_law_has_the_exponent_and_interval_of_a_regression_of_logarithms() -> None:
    rng = np.random.default_rng(3)
    x = np.geomspace(1, 50, 12)
    y = 3 * x**-1.5 * np.exp(rng.normal(0, 0.02, 12))
    exponent, half, factor = fit_power(x, y)
    fit = linregress(np.log(x), np.log(y))
    assert exponent == pytest.approx(fit.slope, rel=1e-12)
    assert half == pytest.approx(t.ppf(0.975, 10) * fit.stderr, rel=1e-9)
    assert factor == pytest.approx(np.exp(fit.intercept), rel=1e-12)


def test_the_number_0_alone_fits_every_unit_as_a_bound() -> None:
    law = f"{HEAD}{AXES}[[laws]]\nclaim = 'a'\nobservable = 'height'\naxis = 'E'\nsource = 's'\nkind = 'bounded'\n"
    (read,) = loads(f"{law}least = '0'\nmost = '-(0)'\n").laws
    assert read.rule == {"least": "0", "most": "-(0)"}
    with pytest.raises(InputError, match="is a plain number, but height is in cm"):
        loads(f"{law}least = '0'\nmost = '-(1)'\n")


def test_the_place_of_a_boundary_on_an_axis_of_angles_may_be_text() -> None:
    said = "kind = 'boundary'\npasses = 1\nx = '30deg'\nwithin = 0.1\n"
    study = loads(f"{HEAD}{AXES}[[laws]]\nclaim = 'a'\nobservable = 'bends'\naxis = 'beta'\nsource = 's'\n{said}")
    assert study.laws[0].x == pytest.approx(np.pi / 6)


def test_a_law_may_be_held_to_the_estimated_error_of_what_its_study_stores() -> None:
    said = "kind = 'bounded'\nmost = 'height + {}_error'\n"
    law = f"{HEAD}{AXES}[[laws]]\nclaim = 'a'\nobservable = 'height'\naxis = 'E'\nsource = 's'\n{said}"
    loads(law.format("height"))
    with pytest.raises(InputError, match="no name 'pitch_error' in a formula"):
        loads(law.format("pitch"))


@pytest.mark.parametrize("error", [3.1e-9, 0.0997, 0.07, 0.43, 5.0, 97.2, 12345.0, 4.2e11])
@pytest.mark.parametrize("share", [0.0, -0.004, 0.62, -1.0, 8.7142, 2999.9996])
def test_a_number_and_its_error_have_the_same_last_place_and_the_error_is_not_rounded_down(error, share) -> None:
    value = share * error
    number, bound = re.sub(r"\((.*) ± (.*)\)(e.*)", r"\1\3 ± \2\3", with_error(value, error)).split(" ± ")
    last_places = [Decimal(text).as_tuple().exponent for text in (number, bound)]
    assert last_places[0] == last_places[1]
    assert error <= float(bound) < 1.1 * error
    assert len(bound.partition("e")[0].replace(".", "").strip("0")) <= 2
    assert abs(float(number) - value) < 0.051 * error
    assert not number.startswith("-0 ")


@pytest.mark.parametrize("error", [0.0, np.nan, np.inf, 1e-9])
def test_an_error_that_is_0_unknown_or_too_small_to_be_seen_is_left_out(error: float) -> None:
    assert with_error(-3.725, error) == "-3.725"
    assert with_error(10.0**FINEST, 0.9) == "1e+06"


def test_a_case_in_which_the_observable_is_not_defined_is_not_counted() -> None:
    law = Law(claim="a", kind="equals", observable="height", axis="E", formula=0.0, absolute=0.1, source="s")
    numbers, axes = {"height": np.array([0.05, np.nan, np.nan])}, {"E": [1.0, 2.0, 3.0]}
    row = decide(law, numbers, Grid(axes, known={"solved": np.ones(3, dtype=bool)}))
    assert (row["verdict"], row["reason"]) == ("true", "not defined in 2 of 3 cases")
    row = decide(law, numbers, Grid(axes, known={"solved": np.array([True, True, False])}))
    assert (row["verdict"], row["reason"]) == ("not decided", "1 of 2 cases has no value; not defined in 1 of 3 cases")
    nowhere = {"height": np.full(3, np.nan)}
    assert decide(law, nowhere, Grid(axes, known={"solved": np.ones(3, dtype=bool)}))["verdict"] == "not decided"
