"""What is refused at the door: one sentence that holds the value and, where there are any, the choices."""

import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Start, equilibria, loops, observe, solve
from solver.observe.observables import OBSERVABLES
from solver.problem.case import from_fields
from solver.problem.quantities import QUANTITIES, quantity, unit_of

ROD: dict[str, Any] = {"E": 1.07e4, "nu": 0.25, "a": 0.25, "L": 20.0}
START: dict[str, Any] = {"beta": 0.5, "dbeta": 0.5, "F3": 10.0, "dgamma": 0.5}


def case(**start: Any) -> Case:
    return Case(Rod(**ROD), Cylinder(0.75), Start(**{**START, **start}))


def refused(*words: Any) -> Any:
    """`pytest.raises` for one sentence that names all of the words."""
    return pytest.raises(InputError, match="(?s)^(?!.*\n)" + "".join(f"(?=.*{re.escape(str(w))})" for w in words))


@pytest.mark.parametrize("field", ("E", "a", "L"))
@pytest.mark.parametrize("value", (0.0, -1.0, np.nan, np.inf))
def test_a_rod_needs_positive_finite_sizes(field: str, value: float) -> None:
    with refused(f"Rod.{field}", value):
        Rod(**{**ROD, field: value})


@pytest.mark.parametrize("nu", (-1.0, -1.5, 0.50001, np.nan))
def test_poisson_ratio_lies_in_its_range(nu: float) -> None:
    with refused("Rod.nu", nu):
        Rod(**{**ROD, "nu": nu})


@pytest.mark.parametrize("nu", (-0.999, 0.0, 0.5))
def test_poisson_ratio_may_reach_one_half(nu: float) -> None:
    assert Rod(**{**ROD, "nu": nu}).torsional_stiffness > 0


@pytest.mark.parametrize("value", (0.0, -0.75, np.nan))
def test_a_cylinder_needs_a_positive_radius(value: float) -> None:
    with refused("Cylinder.R", value):
        Cylinder(value)


@pytest.mark.parametrize("R", (0.25, 0.1))
def test_a_rod_inside_needs_room(R: float) -> None:
    with refused("Cylinder.R", R, "Rod.a = 0.25", "inside"):
        Case(Rod(**ROD), Cylinder(R, "inside"), Start(**START))
    assert Case(Rod(**ROD), Cylinder(R, "outside"), Start(**START)).rho == R + 0.25


@pytest.mark.parametrize("field", ("beta", "dbeta", "F2", "F3", "dgamma", "alpha", "gamma"))
@pytest.mark.parametrize("value", (np.nan, -np.inf))
def test_a_start_needs_finite_numbers(field: str, value: float) -> None:
    with refused(f"Start.{field}", value):
        Start(**{**START, field: value})


@pytest.mark.parametrize("field", ("beta0", "betaL", "FZ", "MZ", "M3"))
def test_ends_need_finite_numbers(field: str) -> None:
    with refused(f"Ends.{field}", "nan"):
        Ends(**{"beta0": 0.1, "betaL": 0.2, field: np.nan})


@pytest.mark.parametrize("value", ("five", [None], [1.0, "x"], [[1.0], [1.0, 2.0]], 1 + 2j, {}))
def test_numbers_are_numbers(value: Any) -> None:
    with refused("Rod.E"):
        Rod(**{**ROD, "E": value})


def test_an_empty_axis_is_no_axis() -> None:
    with refused("Rod.E", "empty"):
        Rod(**{**ROD, "E": []})


def test_the_first_bad_value_of_many_is_named() -> None:
    with refused("Rod.E", -3.0, "2 invalid values among 4"):
        Rod(**{**ROD, "E": [1.0, -3.0, 2.0, -5.0]})


def test_the_twist_comes_from_exactly_one_of_three() -> None:
    with refused("F1=5.0", "dgamma=0.5"):
        Start(0.5, 0.5, F1=5.0, dgamma=0.5)
    with refused("dgamma=0.5", "M3=0.0"):
        Start(0.5, 0.5, dgamma=0.5, M3=0.0)
    with refused("F1=None", "dgamma=None", "M3=None"):
        Start(0.5, 0.5)


@pytest.mark.parametrize("dbeta", (0.0, -0.0, [0.5, 0.0]))
def test_the_normal_force_cannot_fix_the_twist_without_a_slope(dbeta: Any) -> None:
    with refused("F1=5.0", "dbeta", "dgamma", "M3"):
        Start(0.5, dbeta, F1=5.0)


def test_names_are_refused_with_the_choices() -> None:
    with refused("stiffness", "hollow", "solid", "paper"):
        Rod(**ROD, stiffness="hollow")
    with refused("side", "within", "outside", "inside"):
        Cylinder(1.0, "within")
    with refused("method", "rk5", "orbit", "dop853", "verlet"):
        solve(case(), method="rk5")
    with refused("observable", "bends", *OBSERVABLES):
        observe(solve(case()), ["turns", "bends"])
    with refused("quantity", "young", "kappa"):
        quantity("young")
    with refused("young", "Rod", "E, nu, a, L, stiffness"):
        from_fields(Rod, {**ROD, "young": 1.0})
    with refused("Rod", "nu"):
        from_fields(Rod, {"E": 1.0, "a": 0.25, "L": 1.0})


def test_from_fields_makes_what_the_class_makes() -> None:
    assert from_fields(Rod, ROD).bending_stiffness == Rod(**ROD).bending_stiffness


def test_a_method_says_which_problems_it_solves() -> None:
    ends = Case(Rod(**ROD), Cylinder(0.75), Ends(0.5, 0.6))
    with refused("orbit", "ends problems", "difference"):
        solve(ends, method="orbit")
    with refused("difference", "start problems", "orbit", "verlet"):
        solve(case(), method="difference")


@pytest.mark.parametrize("tol", (0.0, -1e-8, 1.0, np.nan, np.inf, "small", None, [1e-8, 1e-9]))
def test_a_tolerance_is_a_small_positive_number(tol: Any) -> None:
    with refused("tol", tol):
        solve(case(), tol=tol)


@pytest.mark.parametrize("stations", (1, 0, -5, 10**12, True, "many", None, [], [2.0, 1.0], [-1.0, 1.0], [0.0, 21.0]))
def test_stations_rise_within_the_rod(stations: Any) -> None:
    with refused("stations"):
        solve(case(), stations=stations)


@pytest.mark.parametrize("method", ("orbit", "verlet", "dop853"))
def test_a_misspelt_knob_is_refused(method: str) -> None:
    with refused("step_s"):
        solve(case(), method=method, step_s=4)


@pytest.mark.parametrize(
    "method, knob, value",
    [
        ("verlet", "steps", 0), ("verlet", "steps", -4), ("verlet", "steps", 2.5), ("dop853", "rtol", -1.0),
        ("dop853", "rtol", np.nan), ("difference", "nodes", 2), ("difference", "nodes", 0.5),
    ],
)  # fmt: skip
def test_a_knob_has_its_range(method: str, knob: str, value: Any) -> None:
    problem = Case(Rod(**ROD), Cylinder(0.75), Ends(0.5, 0.6)) if method == "difference" else case()
    with refused(knob, value):
        solve(problem, method=method, **{knob: value})


def test_fields_must_broadcast() -> None:
    with refused("broadcast", "Rod.E", "(3,)", "Start.beta", "(2,)"):
        Case(Rod(**{**ROD, "E": [1.0, 2.0, 3.0]}), Cylinder(0.75), Start(**{**START, "beta": [0.1, 0.2]}))


def test_the_parts_of_a_case_are_what_they_should_be() -> None:
    with refused("Case.given", "Start or Ends", 5):
        Case(Rod(**ROD), Cylinder(0.75), 5)
    with refused("Case.rod", "Rod"):
        Case(ROD, Cylinder(0.75), Start(**START))


def test_a_case_keeps_its_values() -> None:
    E = np.array([1.0, 2.0])
    rod = Rod(**{**ROD, "E": E})
    E[0] = -1.0
    assert rod.E[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        rod.E[0] = -1.0
    with pytest.raises(AttributeError):
        rod.E = 3.0


def test_equilibria_are_sought_for_one_ends_problem() -> None:
    with refused("Ends", "Start"):
        equilibria(case())
    with refused("one case", "(2,)"):
        equilibria(Case(Rod(**ROD), Cylinder(0.75), Ends([0.5, 0.6], 0.7)))


def test_a_start_problem_takes_no_seed() -> None:
    with refused("seed"):
        solve(case(), seed=0.5)


def test_a_unit_system_names_both_units() -> None:
    assert unit_of("E", {"length": "cm", "force": "N"}) == "N/cm^2"
    assert unit_of("M1", {"length": "m", "force": "kN"}) == "kN m"
    assert unit_of("kappa", {"length": "m", "force": "kN"}) == "1/m"
    assert unit_of("dbeta", {"length": "m", "force": "kN"}) == "rad/m"
    with refused("force"):
        unit_of("E", {"length": "cm"})
    assert all(unit_of(name, {"length": "cm", "force": "N"}) is not None for name in QUANTITIES)


@pytest.mark.parametrize("a", [5e-324, 1e-90, 1e100, 1e308])
def test_a_rod_whose_stiffness_no_float_holds_is_told_by_its_outcome(a: float) -> None:
    for given in (Start(0.5, 0.1, F1=1.0, F3=1.0), Start(0.5, 0.1, dgamma=0.1), Start(0.5, 0.1, M3=0.1)):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            sol = solve(Case(Rod(E=1e4, nu=0.25, a=a, L=20.0), Cylinder(R=0.75), given))
        assert sol.solved or str(sol.outcome).startswith("failed: ")
        assert sol.solved <= np.isfinite(sol.beta).all()


def test_a_field_too_large_for_floats_is_named_with_its_value() -> None:
    forces = np.array([10.0, 1e300, -1e250])
    sol = solve(case(F3=forces))
    assert list(sol.solved) == [True, False, False]
    assert [str(text).split("; ")[-1] for text in sol.outcome] == [
        "solved", "the most extreme field is F3 = 1e+300", "the most extreme field is F3 = -1e+250",
    ]  # fmt: skip
    assert "field is E = 1e+300" in str(solve(Case(Rod(**{**ROD, "E": 1e300}), Cylinder(0.75), Start(**START))).outcome)
    for ends in (Ends(0.5, 0.7, FZ=1e300), Ends(0.5, 0.7, height=3.0, MZ=1e300)):
        name = "FZ" if ends.height is None else "MZ"
        one = Case(Rod(**ROD), Cylinder(0.75), ends)
        assert f"the most extreme field is {name} = 1e+300" in str(solve(one).outcome)
        found = equilibria(one)
        assert not found
        assert f"the most extreme field is {name} = 1e+300" in found.remark
        assert "by degree" not in found.remark
        assert "searched over" not in found.remark


BIG, HUGE = 10**400, int("f" * 5000, 16)  # Python writes no integer of more than 4300 digits
PLAIN = Rod(**ROD)

REFUSALS: dict[str, tuple[Callable[[], Any], str]] = {
    "an unknown field": (lambda: Rod(e=1.0), "no field 'e' in Rod, did you mean 'E'; choose from E, nu"),
    "a missing field": (lambda: Start(beta=0.5), "Start needs dbeta; got beta"),
    "a field twice": (
        lambda: Cylinder(2.0, R=3.0),
        "Cylinder takes each of R, side, inclination, friction, sliding once, got R, R",
    ),
    "a wrong value beside missing fields": (lambda: Rod(E=-1.0), "Rod.E must be positive and finite, got -1.0"),
    "no start and no ends": (lambda: Case(PLAIN, Cylinder(0.75)), "Case needs given; got rod, cylinder"),
    "no case": (lambda: solve(PLAIN, Cylinder(0.75)), "write solve(Case(rod, cylinder, Start(...) or Ends(...)))"),
    "a long integer": (lambda: Rod(**{**ROD, "L": BIG}), "Rod.L must be a number that a float can hold, got 1000"),
    "a longer integer": (lambda: Rod(**{**ROD, "L": HUGE}), "got an integer of more than 4300 digits"),
    "a long double": (lambda: Rod(**{**ROD, "L": np.longdouble("1e4000")}), "Rod.L must be finite, got inf"),
    "a long tolerance": (lambda: solve(case(), tol=HUGE), "tol must be a number between 0 and 1"),
    "long stations": (lambda: solve(case(), stations=HUGE), "stations must be a whole number from 2 to 10000000"),
    "shapes inside": (
        lambda: Case(Rod(**{**ROD, "E": [1.0, 2.0]}), Cylinder([1, 2, 3], "inside"), Start(**START)),
        "must broadcast, got shapes {'Rod.E': (2,), 'Cylinder.R': (3,)}",
    ),
    "an unhashable side": (lambda: Cylinder(2.0, side=["in"]), "no side ['in']; choose from outside, inside"),
    "an unhashable stiffness": (lambda: Rod(**ROD, stiffness={}), "no stiffness {}; choose from solid, paper"),
    "an unhashable method": (lambda: solve(case(), method=["rk4"]), "no method ['rk4'], did you mean"),
    "an unhashable observable": (lambda: observe(solve(case()), [["turns"]]), "no observable ['turns'], did"),
    "a misspelt observable": (lambda: observe(solve(case()), "heigth"), "'heigth', did you mean 'height'; choose"),
    "no name of a field": (lambda: solve(case()).sensitivity(5), "no field 5 in this case; choose from E"),
    "no weight": (
        lambda: solve(Case(Rod(**ROD, weight=0.0), Cylinder(0.75), Start(**START))).sensitivity("weight"),
        "the derivative by weight of a rod without weight is not known",
    ),
    "no radius that floats hold": (
        lambda: loops(Rod(1.0, 0.25, 1e-251, 1e-249), Cylinder(9e-251)),
        "beyond 1e290 or 1e-290 in these units; the most extreme field is a = 1e-251",
    ),
    **{
        f"equilibria: {name} = {value}": (lambda more={name: value}: equilibria(ends(), **more), f"{name} must be")
        for name, values in {
            "stations": (-1, 0, 1, 10**12, 2.5), "tol": (np.nan, -1, "x"), "most_swings": (-1, np.nan, "x"),
            "tries": ("x",), "values": (1, 10**9), "within": (5,),
        }.items()
        for value in values
    },
}  # fmt: skip


def ends(**more: Any) -> Case:
    return Case(PLAIN, Cylinder(0.75), Ends(**{"beta0": 0.5, "betaL": 0.6, **more}))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("wrong", REFUSALS)
def test_a_wrong_call_is_refused_in_one_sentence(wrong: str) -> None:
    call, sentence = REFUSALS[wrong]
    with refused(sentence):
        call()


def test_a_rod_between_ends_has_a_greatest_length() -> None:
    for given in ({}, {"height": 0.0}):
        outcome = str(solve(Case(Rod(1.07e4, 0.25, 0.25, 1e17), Cylinder(0.75), ends(**given).given)).outcome)
        assert outcome.startswith("failed: L/rho of a problem between two ends must be below 1e16"), given
