"""Observables where their value is known: on exact cases, on mirror images, on rods of many bends."""

import numpy as np
import pytest
from scipy.integrate import quad

from solver import Case, Cylinder, Ends, Rod, solve
from solver.observe.observables import OBSERVABLES, is_count, observe
from solver.problem.quantities import QUANTITIES
from tests.cases import ELLIPTIC_PERIOD, EXACT, GENERAL, NOWHERE, elliptic, in_units_of_rho, table_1


def seen(case: Case, name: str, method: str = "orbit", stations: int = 2001) -> float:
    return float(observe(solve(case, tol=1e-7, method=method, stations=stations), [name])[name])


def unloaded(span: float) -> Case:
    """beta swings between 30 and 150 degrees; beta'^2 = sin^4 - 1/16."""
    return in_units_of_rho(0, 0, 0, span, np.pi / 6, 0.0)


METHODS = ("orbit", "dop853")
by_both = pytest.mark.parametrize("method", METHODS)


def test_every_observable_has_a_row_of_its_own() -> None:
    assert set(OBSERVABLES) <= set(QUANTITIES)


def test_whole_numbers_and_the_loads_of_the_far_end_alone_have_no_error_and_each_error_covers_a_finer_solve() -> None:
    pipe = Rod(EI=1.0, GJ=0.8, a=0.05, L=8.0, weight=0.3)
    wall = Cylinder(R=0.3, side="inside", inclination=1.2, friction=0.1, sliding="rotating")
    case = Case(pipe, wall, Ends(beta0=0.3, betaL=0.2, FZ=-0.5, MZ=0.1, M3=0.2))
    names = [name for name, row in OBSERVABLES.items() if row.needs != "E"]
    rough, fine = (observe(solve(case, tol=tol), names, errors=True) for tol in (1e-4, 1e-12))
    known = {name for name in names if not is_count(name)} - {"FZ", "MZ", "M3", *NOWHERE[1:]}
    assert {name.removesuffix("_error") for name in rough if name.endswith("_error")} == known
    for name in known:
        off = abs(rough[name] - fine[name])
        assert np.isnan(off) or off <= rough[f"{name}_error"] + fine[f"{name}_error"] + 1e-12, name  # rounding


@by_both
@pytest.mark.parametrize("periods, turns", [(0.4, 0), (0.6, 1), (1.4, 2), (3.6, 7)])
def test_turns_counts_the_bends_between_the_ends(method: str, periods: float, turns: int) -> None:
    assert seen(unloaded(periods * ELLIPTIC_PERIOD), "bends", method) == turns


def test_turns_counts_every_bend_of_a_rod_however_long() -> None:
    assert seen(unloaded(12345.3 * ELLIPTIC_PERIOD), "bends", stations=201) == 24690


def test_bend_number_is_the_length_over_half_a_period() -> None:
    for periods in (0.3, 2.7):
        assert seen(unloaded(periods * ELLIPTIC_PERIOD), "bend_number") == pytest.approx(2 * periods, rel=1e-9)


@by_both
def test_a_rod_that_goes_round_has_loops_and_no_turns(method: str) -> None:
    case = GENERAL["going round"].case
    sol = solve(case, tol=1e-7, method=method, stations=2001)
    got = observe(sol, ["bends", "loops", "amplitude"])
    assert got["bends"] == 0
    assert got["loops"] == np.floor((sol.beta[-1] - sol.beta[0]) / (2 * np.pi))
    assert got["amplitude"] == pytest.approx(sol.beta[-1] - sol.beta[0], abs=1e-6)


def test_a_rod_that_swings_widely_has_no_loops() -> None:
    """Amplitude may exceed a turn without the tangent ever going round between two ends that agree."""
    got = observe(solve(unloaded(20.0), tol=1e-9), ["loops", "amplitude"])
    assert got["loops"] == 0
    assert got["amplitude"] == pytest.approx(2 * np.pi / 3, abs=1e-8)


@by_both
def test_mean_curvature_and_mean_contact_are_integrals_over_the_exact_shape(method: str) -> None:
    """With no load both follow from beta alone: by adaptive quadrature of the closed form."""
    span = 1.7 * ELLIPTIC_PERIOD
    sin = lambda t: np.sin(elliptic(t)[0])  # noqa: E731
    kappa = quad(lambda t: np.sqrt(2 * sin(t) ** 4 - 1 / 16), 0, span, limit=400)[0] / span
    assert seen(unloaded(span), "kappa_mean", method) == pytest.approx(kappa, rel=1e-5)

    def push(t: float) -> float:
        """-sin^4 + 3/2 sin(2b) H - 3 beta'^2 cos(2b) with H = -2 cos sin^3: f where there is no load."""
        b = float(elliptic(t)[0])
        s, c = np.sin(b), np.cos(b)
        return -(s**4) - 6 * c * c * s**4 - 3 * (s**4 - 1 / 16) * np.cos(2 * b)

    size = quad(lambda t: abs(push(t)), 0, span, limit=400)[0] / span
    assert seen(unloaded(span), "contact_size_mean", method) == pytest.approx(size, rel=1e-7)  # tol


def test_wraps_and_height_do_not_depend_on_where_the_rod_starts_or_is_read() -> None:
    case = in_units_of_rho(0, 0, 0, 20.0, np.pi / 6, 0.0, alpha=3.0)
    sol = solve(case, tol=1e-9, stations=[5.0, 6.0])
    got = observe(sol, ["turns_around", "height"])
    assert got["turns_around"] == pytest.approx(13.9907069662832906 / (2 * np.pi), abs=1e-8)
    assert got["height"] == pytest.approx(0.0705173405892741653, abs=1e-8)


@pytest.mark.parametrize("side", ("outside", "inside"))
def test_push_extremes_bound_the_push_on_either_side(side: str) -> None:
    sol = solve(table_1("shear", "tension", "solid", side), tol=1e-9, stations=4001)
    got = observe(sol, ["push_min", "push_max"])
    width = np.ptp(sol.push)
    assert got["push_min"] == pytest.approx(sol.push.min(), abs=1e-4 * width)  # the stations' spacing squared
    assert got["push_max"] == pytest.approx(sol.push.max(), abs=1e-4 * width)
    assert got["push_min"] <= sol.push.min() + 1e-9 * width
    assert got["push_max"] >= sol.push.max() - 1e-9 * width


@pytest.mark.parametrize("name", ("force-first", "twist-first"))
@pytest.mark.parametrize("load", ("tension", "compression"))
def test_what_the_orbit_gives_is_what_stations_give(name: str, load: str) -> None:
    """Two ways to each observable: from the orbit's own points, and from two thousand stations of another method."""
    case = table_1(name, load, "solid")
    a = observe(solve(case, tol=1e-9, method="orbit"), OBSERVABLES)
    b = observe(solve(case, tol=1e-7, method="dop853", stations=4001), OBSERVABLES)
    for key in OBSERVABLES:
        if key == "bend_number":  # stations do not know the period
            continue
        nowhere = key in NOWHERE  # no force that changes along the rod
        assert a[key] == pytest.approx(b[key], rel=2e-4, abs=2e-3, nan_ok=nowhere), key  # attached: at each change


def test_a_mirror_image_has_the_same_observables_but_winds_the_other_way() -> None:
    a = in_units_of_rho(0.3, 0.2, -0.5, 20.0, 0.5, 0.3)
    b = in_units_of_rho(-0.3, -0.2, -0.5, 20.0, -0.5, -0.3)
    left, right = (observe(solve(case, tol=1e-10), OBSERVABLES) for case in (a, b))
    for name in OBSERVABLES:
        sign = -1 if name in ("turns_around", "MZ", "MZ0", "M3", "M30", "surface_torque", "M10", "M1L") else 1
        assert right[name] == pytest.approx(sign * left[name], rel=1e-9, abs=1e-9, nan_ok=name in NOWHERE), name


HELICES = (
    "helix at a centre",
    "helix at a centre, inside",
    "helix at a saddle",
    "buckled pipe 10 deg",
    "buckled pipe 70 deg",
)


@by_both
@pytest.mark.parametrize("name", HELICES)
def test_a_helix_has_no_bends_though_rounding_makes_it_tremble(name: str, method: str) -> None:
    assert seen(EXACT[name].case, "bends", method) == 0
