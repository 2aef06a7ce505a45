"""A number with its unit is the same number wherever it stands, and is converted by the dimension of its field."""

import math

import pytest
import xarray as xr

from solver import InputError
from solver.problem.quantities import QUANTITIES, unit_of
from solver.problem.units import FORCES, LENGTHS, dimension_of, number_in, unit_size
from studies.language.loader import loads
from tests.workbench import small
from workbench.commands import tables
from workbench.stored.chosen_cases import index
from workbench.words import unit_habits

INCHES = {"length": "in", "force": "lbf"}
NUMBERS = [name for name, row in QUANTITIES.items() if row.dimension not in ("text", (0, 0))]


@pytest.mark.parametrize(
    ("field", "text", "units", "number"),
    [
        ("a", "2.5in", "m N", 0.0635),
        ("E", "30e6 psi", "in lbf", 30e6),
        ("E", "210 GPa", "mm N", 210e3),
        ("weight", "19.5 lb/ft", "ft lbf", 19.5),
        ("FZ", "-40 klbf", "ft lbf", -40e3),
        ("FZ", "-40kip", "ft klbf", -40),
        ("MZ", "5 ft-lbf", "in lbf", 60),
        ("dbeta0", "3 deg/100 ft", "ft N", math.radians(0.03)),
        ("dbeta0", "3deg/(100ft)", "ft N", math.radians(0.03)),
        ("EI", "2 N m^2", "mm N", 2e6),
        ("EI", "2 N*m**2", "mm N", 2e6),
        ("kappa_max", "0.5/m", "km N", 500),
        ("nu", "30 percent", "m N", 0.3),
    ],
)
def test_a_number_with_its_unit_is_converted(field: str, text: str, units: str, number: float) -> None:
    length, force = units.split()
    assert number_in(field, text, {"length": length, "force": force}) == pytest.approx(number, rel=1e-14)


@pytest.mark.parametrize("name", NUMBERS)
def test_each_quantity_takes_its_unit_in_every_system_of_units(name: str) -> None:
    for length in LENGTHS:
        for force in FORCES:
            units = {"length": length, "force": force}
            unit = unit_of(name, units)
            assert number_in(name, f"2.5 {unit}", units) == 2.5
            assert number_in(name, f"2.5 {unit}", INCHES) == pytest.approx(
                2.5 / number_in(name, f"1 {unit_of(name, INCHES)}", units), rel=1e-12
            )


@pytest.mark.parametrize("name", NUMBERS)
def test_the_unit_in_which_a_quantity_is_stated_is_one_of_that_quantity(name: str) -> None:
    for length in LENGTHS:
        for force in FORCES:
            units = {"length": length, "force": force}
            unit = unit_habits.unit_shown(name, units)
            assert unit_size(unit)[1][:2] == dimension_of(name)[:2]
            stated = f"{3 * unit_habits.size_shown(name, units)!r} {unit}"
            assert number_in(name, stated, units) == pytest.approx(3, rel=1e-12)


@pytest.mark.parametrize(
    "text", ["in", "2.5 psi", "2.5 inn", "2.5 in^", "2.5 in/", "2.5 (in", "1,000 in", "x", "", "2in^99"]
)
def test_a_text_that_is_no_length_is_refused_in_one_sentence(text: str) -> None:
    with pytest.raises(InputError) as refused:
        number_in("a", text, INCHES)
    assert "\n" not in str(refused.value)


def test_a_study_in_other_units_is_the_same_study() -> None:
    plain = small.text({**small.ROD, "beta0": 0.5, "betaL": 0.5}, "[axes.FZ]\nvalues = [-20.0, -10.0]\n")
    axes = '[axes.FZ]\nvalues = ["-20 N", "-10000 mN"]\n'
    fields = {name: f"{value!r} cm" if name in ("a", "L", "R") else value for name, value in small.ROD.items()}
    given = small.text({**fields, "E": f"{small.ROD['E'] / 100!r} MPa", "beta0": 0.5, "betaL": "0.5 rad"}, axes)
    own = small.text({**small.ROD, "beta0": 0.5, "betaL": 0.5}, '[axes.FZ]\nvalues = [-20e3, -10e3]\nunit = "mN"\n')
    cases = [loads(text).case() for text in (plain, given, own)]
    for case in cases[1:]:
        for part in ("rod", "cylinder", "given"):
            mine, other = vars(getattr(case, part)), vars(getattr(cases[0], part))
            for name in ("E", "a", "L", "R", "FZ", "beta0"):
                if name in mine:
                    assert mine[name] == pytest.approx(other[name], rel=1e-14)


def test_numbers_are_stated_without_an_exponent() -> None:
    for value in (12345.678, 3e7, 0.00123456, -98765.4, 1.0, 0.5, 99999.9):
        assert "e" not in unit_habits.plain(value)
        assert float(unit_habits.plain(value)) == pytest.approx(value, rel=5e-4)
    assert unit_habits.plain(-12345.678) == "-12346"


def test_a_number_in_a_table_has_five_digits_whatever_the_command() -> None:
    cells = [tables.text_of(value) for value in (347.29612, 34440.44, 0.004854369, -78.826276, 3.0, 3, None)]
    assert cells == ["347.3", "34440", "0.0048544", "-78.826", "3", "3", "-"]


def test_a_stored_value_is_named_in_any_unit_of_its_axis() -> None:
    axis = xr.DataArray([-20.0, -10.0], dims="FZ", name="FZ", attrs={"units": "N"})
    assert [index(axis, text) for text in ("-20 N", "-0.02kN", "-1 daN", "-10")] == [0, 0, 1, 1]
    with pytest.raises(InputError, match="psi is a unit of stress"):
        index(axis, "-20 psi")
