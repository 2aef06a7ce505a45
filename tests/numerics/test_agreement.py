"""Every method on every named case against a reference of another family: forty-digit Taylor series."""

import numpy as np
import pytest

from solver import Case, Ends, Solution, solve
from tests.cases import EXACT, START
from tests.reach import TOLERANCES, matrix
from tests.references import Reference, references

STATIONS = 201  # the eight shares of the references are among these
ROUNDING = 2e-15  # of the loads and of the start, grown by the condition number


def error_against(reference: Reference, sol: Solution, *, of: str = "beta alpha z") -> float:
    """As `Solution.error` is meant: beta, and alpha and z/rho over max(1, L/rho)."""
    at = np.rint(reference.u * (STATIONS - 1)).astype(int)
    rho = sol.case.rho
    span = max(1, float(sol.case.rod.L) / rho)
    off = {
        "beta": np.abs(sol.beta[at] - reference.beta),
        "alpha": np.abs(sol.alpha[at] - sol.alpha[0] - reference.alpha) / span,
        "z": np.abs(sol.z[at] - reference.z) / rho / span,
    }
    return float(max(off[name].max() for name in of.split()))


def test_there_is_a_reference_for_every_case() -> None:
    assert set(references()) == set(START)


@pytest.mark.parametrize("name", EXACT)
def test_the_references_agree_with_the_closed_forms(name: str) -> None:
    """Two families that judge each other before either judges a method."""
    named, reference = EXACT[name], references()[name]
    beta, alpha, z = named.exact(reference.u * named.L)
    # the closed forms know loads without rounding: 1e-16, grown
    atol = 1e-15 * (10 + reference.condition)
    np.testing.assert_allclose(reference.beta, beta, atol=atol)
    np.testing.assert_allclose(reference.alpha, alpha, atol=named.L * atol)
    np.testing.assert_allclose(reference.z, z, atol=named.L * atol)


@pytest.mark.parametrize("name, method, tol", matrix("start", list(START)))
def test_start_problems_agree_with_the_reference(name: str, method: str, tol: float) -> None:
    named = START[name]
    if method == "verlet" and references()[name].condition > 1e5:
        pytest.skip("so near a separatrix a march of order 4 needs more than 2^20 steps")
    if method not in TOLERANCES and tol * references()[name].condition > 1:
        pytest.skip("what is asked for allows a whole radian")
    sol = solve(named.case, tol=tol, method=method, stations=STATIONS)
    if method not in TOLERANCES and not sol.solved:
        assert sol.outcome.startswith("failed")
        pytest.skip(f"out of reach, and it says so: {sol.outcome}")
    assert sol.solved, sol.outcome
    reference = references()[named.name]
    allowed = tol * max(1, reference.condition) + ROUNDING * reference.condition
    error = error_against(reference, sol)
    assert error <= allowed
    # the estimate is honest: it may not be far below the truth
    assert error <= 10 * sol.error + ROUNDING * reference.condition
    at = np.rint(reference.u * (STATIONS - 1)).astype(int)
    fastest = 1 + np.abs(sol.dbeta).max() * sol.case.rho
    assert np.abs(sol.dbeta[at] - reference.dbeta).max() * sol.case.rho <= 20 * fastest**2 * allowed
    twist = sol.M3 / sol.case.rod.torsional_stiffness * sol.s[at]
    gamma = sol.case.given.gamma + twist - reference.swirl
    assert np.abs(sol.gamma[at] - gamma).max() <= 20 * sol.case.rod.L / sol.case.rho * allowed


def with_ends(case: Case, reference: Reference) -> Case:
    """The same rod asked for by its two end angles and its loads."""
    FZ, MZ, M3 = case.loads
    given = Ends(case.given.beta, reference.beta[-1], FZ, MZ, M3, case.given.alpha, case.given.gamma)
    return Case(case.rod, case.cylinder, given)


# on the first mesh of its own choice Newton's rule does not see these rods' quick turns between long rests
MESHES = {("difference", "elliptic k=0.01 L=60"): 1025, ("difference", "turning 0.01 before a saddle"): 1025}
ENDS = [name for name in START if references()[name].condition < 1e3 and START[name].L < 100]


@pytest.mark.parametrize("name, method, tol", matrix("ends", ENDS))
def test_ends_problems_agree_with_the_reference(name: str, method: str, tol: float) -> None:
    """Seeded with the slope at the start, a method for two ends finds the rod that the start problem has."""
    named, reference = START[name], references()[name]
    seed = float(named.case.given.dbeta)
    knobs = {"nodes": MESHES[method, name]} if (method, name) in MESHES else {}
    sol = solve(with_ends(named.case, reference), tol=tol, method=method, stations=STATIONS, seed=seed, **knobs)
    if method not in TOLERANCES and not sol.solved:
        pytest.skip(f"out of reach, and it says so: {sol.outcome}")
    assert sol.solved, sol.outcome
    assert sol.dbeta[0] == pytest.approx(seed, abs=1e-3)  # the same one of the many
    assert error_against(reference, sol) <= (tol + ROUNDING) * max(1, float(sol.condition), reference.condition)
    np.testing.assert_allclose(sol.beta[[0, -1]], [named.case.given.beta, reference.beta[-1]], atol=1e-9)
