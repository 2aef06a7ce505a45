"""Forces and moments in space balance; everything is rebuilt from positions and derivatives of the answer itself."""

import numpy as np
import pytest

from solver import Solution, solve
from tests.cases import GENERAL, TABLE_1, Named, table_1
from tests.differentiation import chebyshev, differentiated

SHAPES: dict[str, Named] = {
    **TABLE_1,
    "force-first/compression/solid, inside": Named(
        "", "", table_1("force-first", "compression", "solid", side="inside")
    ),
    **{name: GENERAL[name] for name in ("going round", "inside, twisted", "strongly twisted", "compressed, symmetric")},
}

# One stretch of the rod on Chebyshev points. Differentiation multiplies errors of 1e-14 by n^2/stretch.
POINTS, STRETCH = 40, 1.25


@pytest.fixture(scope="module", params=SHAPES)
def sol(request: pytest.FixtureRequest) -> Solution:
    answer = solve(SHAPES[request.param].case, tol=1e-13, stations=chebyshev(POINTS, 0.3, 0.3 + STRETCH))
    assert answer.solved, answer.outcome
    return answer


def force(sol: Solution) -> np.ndarray:
    """Of the section, in space, (n, 3)."""
    T, N = sol.tangent, sol.normal
    return sol.F1[:, None] * N + sol.F2[:, None] * np.cross(T, N) + sol.F3[:, None] * T


def moment(sol: Solution) -> np.ndarray:
    """Of the section, in space, (n, 3)."""
    T, N = sol.tangent, sol.normal
    return sol.M1[:, None] * N + sol.M2[:, None] * np.cross(T, N) + sol.M3 * T


def outward(sol: Solution) -> np.ndarray:
    """The cylinder's outward normal at the contact, from the position alone, (n, 3)."""
    flat = sol.position * [1, 1, 0]
    return flat / np.linalg.norm(flat, axis=1, keepdims=True)


def largest(values: np.ndarray) -> float:
    """The largest size of any of these numbers."""
    return float(np.abs(values).max())


def test_forces_balance(sol: Solution) -> None:
    dF = differentiated(force(sol), sol.s)
    assert largest(dF + sol.contact[:, None] * outward(sol)) <= 1e-9 * largest(dF)  # one derivative: 1e-14 n^2/stretch


def test_moments_balance(sol: Solution) -> None:
    dM = differentiated(moment(sol), sol.s)
    assert largest(dM + np.cross(sol.tangent, force(sol))) <= 1e-9 * largest(dM)  # one derivative


def test_moment_is_bending_stiffness_times_curvature_and_the_twisting_moment(sol: Solution) -> None:
    M, t = moment(sol), differentiated(sol.position, sol.s)
    A = sol.case.rod.bending_stiffness
    bent = A * np.cross(t, differentiated(t, sol.s)) + sol.M3 * t
    assert largest(M - bent) <= 1e-7 * largest(M)  # two derivatives: 1e-14 n^4/stretch^2


def test_contact_is_what_keeps_the_rod_at_its_distance(sol: Solution) -> None:
    """Without eq. (34): bend the curve, ask the moments which force they need, and the force which push it needs.

    F = t x M' + F3 t with F3 + A kappa^2/2 constant; the push is what of F' the constraint must take.
    """
    A, t = sol.case.rod.bending_stiffness, sol.tangent
    dt = differentiated(t, sol.s)
    dM = differentiated(A * np.cross(t, dt), sol.s) + sol.M3 * dt
    across = np.cross(t, dM)
    tension = -A / 2 * np.sum(dt**2, axis=1)
    # its constant, from the axial force
    at = np.argmax(np.abs(t[:, 2]))
    tension += (sol.FZ - across[at, 2]) / t[at, 2] - tension[at]
    dF = differentiated(across + tension[:, None] * t, sol.s)
    push = -np.sum(dF * outward(sol), axis=1)
    assert largest(push - sol.contact) <= 1e-5 * largest(sol.contact)  # three derivatives: 1e-14 n^6/stretch^3


def test_the_constraint_fixes_the_curvature_towards_the_axis(sol: Solution) -> None:
    """x^2 + y^2 = rho^2, differentiated twice: r.r'' + r'.r' = 0 across the axis."""
    r = sol.position
    t = differentiated(r, sol.s)
    dt = differentiated(t, sol.s)
    held = np.sum((r * dt + t * t)[:, :2], axis=1)
    np.testing.assert_allclose(held, 0, atol=1e-6)  # two derivatives
    np.testing.assert_allclose(sol.kappa, np.linalg.norm(dt, axis=1), atol=1e-6 * sol.kappa.max())


def test_tangent_is_the_derivative_of_the_position(sol: Solution) -> None:
    t = differentiated(sol.position, sol.s)
    np.testing.assert_allclose(t, sol.tangent, atol=1e-9)  # one derivative
    np.testing.assert_allclose(np.linalg.norm(t, axis=1), 1, atol=1e-9)


def test_the_centreline_stays_at_its_distance_from_the_axis(sol: Solution) -> None:
    distance = np.hypot(*np.moveaxis(sol.position[:, :2], 1, 0))
    np.testing.assert_allclose(distance, sol.case.rho, rtol=1e-15)


def test_material_frame_is_orthonormal_and_right_handed(sol: Solution) -> None:
    Q = sol.material_frame
    np.testing.assert_allclose(Q @ np.swapaxes(Q, 1, 2), np.broadcast_to(np.eye(3), Q.shape), atol=1e-14)  # rounding
    np.testing.assert_allclose(np.linalg.det(Q), 1, atol=1e-14)
    np.testing.assert_array_equal(Q[:, 2], sol.tangent)


def test_material_frame_turns_with_the_curvature(sol: Solution) -> None:
    """d_i' = omega x d_i with omega = t x t' + twist t."""
    t = sol.tangent
    omega = np.cross(t, differentiated(t, sol.s)) + sol.M3 / sol.case.rod.torsional_stiffness * t
    for i in range(3):
        d = sol.material_frame[:, i]
        residual = differentiated(d, sol.s) - np.cross(omega, d)
        np.testing.assert_allclose(residual, 0, atol=1e-9 * (1 + np.abs(omega).max()))  # one derivative
