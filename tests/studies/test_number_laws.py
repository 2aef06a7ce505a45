"""Laws with numbers on made-up lines, where the right verdict is seen at a glance."""

import numpy as np
import pytest
from scipy.stats import linregress, t

from solver import InputError
from studies.language.loader import loads
from studies.laws.line_verdicts import fit_power

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


def test_the_number_0_fits_every_unit_as_a_bound() -> None:
    said = "kind = 'bounded'\nleast = '0'\nmost = '-(0)'\n"
    loads(f"{HEAD}{AXES}[[laws]]\nclaim = 'a'\nobservable = 'height'\naxis = 'E'\nsource = 's'\n{said}")


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
