"""Each method states its order; here the slope of its error against its step is measured, on the elliptic case."""

import numpy as np
import pytest

from solver import Case, Ends, solve
from tests.cases import EXACT, elliptic, in_units_of_rho

ELLIPTIC = EXACT["elliptic k=0.25 L=20"]


def slopes(errors: list[float]) -> np.ndarray:
    """Orders measured between steps of which each is half the one before."""
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def marched(steps: int, extrapolate: bool, what: str) -> float:
    sol = solve(ELLIPTIC.case, method="verlet", stations=101, steps=steps, extrapolate=extrapolate)
    exact = dict(zip(("beta", "alpha", "z"), ELLIPTIC.exact(sol.s), strict=True))[what]
    return float(np.abs(getattr(sol, what) - exact).max())


@pytest.mark.parametrize("what", ("beta", "alpha", "z"))
@pytest.mark.parametrize("extrapolate, order", [(False, 2), (True, 4)])
def test_the_difference_equation_marched_is_of_order_two_and_extrapolated_of_order_four(
    extrapolate: bool, order: int, what: str
) -> None:
    measured = slopes([marched(steps, extrapolate, what) for steps in (2, 4, 8)])
    np.testing.assert_allclose(measured, order, atol=0.15)  # the next power of h^2 still shows


def test_the_error_that_the_march_reports_is_the_error_it_has() -> None:
    for extrapolate in (False, True):
        sol = solve(ELLIPTIC.case, method="verlet", stations=101, steps=4, extrapolate=extrapolate)
        true = max(marched(4, extrapolate, "beta"), marched(4, extrapolate, "alpha") / 20)
        # the difference to half the step: 3/4 of the error of order 2, 15/16 of that of order 4
        assert 0.5 * true < sol.error < 2 * true


def test_the_step_of_the_march_is_found_from_the_tolerance() -> None:
    """A tenth of the tolerance of an order 4 method costs 1.8 times the steps; doubling makes that 1 or 2."""
    work = [solve(ELLIPTIC.case, tol=tol, method="verlet", stations=101).evaluations for tol in (1e-4, 1e-6, 1e-8)]
    assert work[0] < work[1] < work[2] <= 32 * work[0]


def ends() -> Case:
    """The elliptic rod by its two ends; without any load."""
    beta0, betaL = (float(b) for b in elliptic(np.array([0.0, 20.0]))[0])
    return Case(ELLIPTIC.case.rod, ELLIPTIC.case.cylinder, Ends(beta0, betaL))


def differenced(nodes: int, extrapolate: bool) -> float:
    """Largest error of beta at the nodes."""
    sol = solve(ends(), method="difference", stations=nodes, nodes=nodes, extrapolate=extrapolate, seed=0.0)
    return float(np.abs(sol.beta - ELLIPTIC.exact(sol.s)[0]).max())


# physics.md, section 4, to one digit; extrapolated, n counts the finer mesh
@pytest.mark.parametrize("nodes, error", [(201, 8e-4), (801, 5e-5), (3201, 3e-6)])
def test_the_papers_scheme_has_the_error_that_was_measured_for_it(nodes: int, error: float) -> None:
    assert differenced(nodes, False) == pytest.approx(error, rel=0.25)


@pytest.mark.parametrize("nodes, error", [(201, 1e-5), (801, 4e-8), (3201, 2e-10)])
def test_the_papers_scheme_extrapolated_has_the_error_that_was_measured_for_it(nodes: int, error: float) -> None:
    # on the finest mesh Newton's rule must not stop before rounding, eps n^2 = 1e-9 at worst, is all that is left
    assert differenced((nodes + 1) // 2, True) == pytest.approx(error, rel=0.5, abs=3e-10)


def test_the_adaptive_reference_follows_its_tolerance() -> None:
    """An integrator of order 8: a thousandth of rtol for 1000^(1/8) = 2.4 times the work."""
    work = []
    for rtol in (1e-7, 1e-10, 1e-13):
        sol = solve(ELLIPTIC.case, method="dop853", stations=101, rtol=rtol)
        error = np.abs(sol.beta - ELLIPTIC.exact(sol.s)[0]).max()
        assert error < 30 * rtol * sol.condition  # steps add up
        assert error < sol.error
        work.append(int(sol.evaluations))
    assert work[2] < 2.4**2 * work[0]


def test_orbit_converges_geometrically() -> None:
    """Six more digits for less than three times the evaluations."""
    loose = solve(ELLIPTIC.case, tol=1e-4, method="orbit")
    tight = solve(ELLIPTIC.case, tol=1e-12, method="orbit")
    assert tight.evaluations <= 3 * loose.evaluations
    assert np.abs(tight.beta - ELLIPTIC.exact(tight.s)[0]).max() < 1e-12
    assert np.abs(loose.beta - ELLIPTIC.exact(loose.s)[0]).max() < 1e-4


def test_the_work_of_orbit_does_not_grow_with_the_length() -> None:
    from tests.cases import in_units_of_rho

    few, many = (
        int(solve(in_units_of_rho(0, 0, 0, span, np.pi / 6, 0.0), tol=1e-8).evaluations) for span in (20.0, 2e6)
    )
    assert many <= 3 * few


@pytest.mark.parametrize("phi, nodes", [(-1e4, 101), (-1e6, 801), (-1e8, 2001)])
def test_a_mesh_that_does_not_resolve_the_swings_is_no_solution(phi: float, nodes: int) -> None:
    """Two meshes with less than six nodes a swing can agree on the same false, slower wave."""
    start = in_units_of_rho(0.0, 0.0, phi, 20.0, 0.1, 0.0)
    far = float(solve(start, stations=[start.rod.L]).beta[0])
    FZ = phi * start.rod.bending_stiffness / start.rho**2
    case = Case(start.rod, start.cylinder, Ends(0.1, far, FZ=FZ))
    assert not solve(case, method="difference", nodes=nodes, tol=0.5, seed=0.0).solved
