"""The rod in plain Cartesian vectors, written anew: sharing nothing with `solver` but the case.

Kirchhoff's balances with r, t, t' and F as vectors, contact from the fourth derivative of x^2 + y^2 = rho^2. A discrete
rod of nodes, contact from its multipliers, is in `test_weight_in_space`.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solver import Case, Solution, solve
from tests.cases import GENERAL, TABLE_1
from tests.slow import slow_but

NAMES = (
    "force-first/tension/paper",
    "force-first/compression/solid",
    "twist-first/compression/paper",
    "shear/tension/solid",
    "compressed, symmetric",
    "strongly twisted",
    "inside, twisted",
    "going round backwards",
)
cases = pytest.mark.parametrize("name", slow_but(NAMES, "compressed, symmetric", "inside, twisted"))
EZ = np.array([0.0, 0.0, 1.0])


def named(name: str) -> Case:
    return (TABLE_1 | GENERAL)[name].case


@cache
def orbit(name: str) -> Solution:
    return solve(named(name), tol=1e-11, stations=401)


def flat(r: np.ndarray) -> np.ndarray:
    """Without the part along the axis."""
    return r * np.array([1.0, 1.0, 0.0])


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.sum(a * b, axis=-1, keepdims=True)


@dataclass(frozen=True)
class Marched:
    """At 401 stations: position, tangent, t', force, all (n, 3), contact (n,), a director of the section (n, 3)."""

    r: np.ndarray
    t: np.ndarray
    k: np.ndarray
    F: np.ndarray
    contact: np.ndarray
    d1: np.ndarray
    M3: float


def rates(A: float, M3: float, rho: float, r, t, k, F) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """t'', F' and the contact f, from A t x t'' + M3 t' + t x F = 0, F' = -f n, and (x^2 + y^2)'''' = 0."""
    n = flat(r) / rho
    k2 = -(k @ k) * t + (M3 * np.cross(t, k) - (F - (F @ t) * t)) / A
    rest = -A * (k @ k) * k + M3 * np.cross(t, k2) + (F @ t) * k  # what A t''' has along n, but for f
    f = -A * (3 * flat(k) @ k + 4 * flat(t) @ k2) / rho - n @ rest
    return k2, -f * n, f


def held(A: float, M3: float, rho: float, r, t, k, F) -> tuple[np.ndarray, ...]:
    """The same state put back on the cylinder: (x^2 + y^2) and its first three derivatives, t.t = 1 and t.k = 0.

    Rates are taken there, since a march off the cylinder runs away from it; what is marched is left alone.
    """
    n = flat(r) / np.linalg.norm(flat(r))
    t = t - (t @ n) * n
    t = t / np.linalg.norm(t)
    k = k - (k @ t) * t - (k @ n + flat(t) @ t / rho) * n
    normal = M3 * n @ np.cross(t, k) + 3 * A * flat(t) @ k / rho
    return rho * n + (r @ EZ) * EZ, t, k, F + (normal - F @ n) * n


def beginning(case: Case) -> tuple[np.ndarray, ...]:
    """r, t, t', F and M3 at s = 0."""
    g, rho, A = case.given, case.rho, case.rod.bending_stiffness
    n = np.array([np.cos(g.alpha), np.sin(g.alpha), 0.0])
    across = np.cross(EZ, n)
    t = np.sin(g.beta) * across + np.cos(g.beta) * EZ
    aside = -np.cos(g.beta) * across + np.sin(g.beta) * EZ
    k = -g.dbeta * aside - np.sin(g.beta) ** 2 / rho * n
    # r . t'' + 3 t . t' = 0 across the axis ties the normal force to the twisting moment
    if g.F1 is None:
        M3 = case.rod.torsional_stiffness * (g.dgamma + np.sin(g.beta) * np.cos(g.beta) / rho)
        normal = M3 * n @ np.cross(t, k) + 3 * A * flat(t) @ k / rho
    else:
        normal = -g.F1
        M3 = (normal - 3 * A * flat(t) @ k / rho) / (n @ np.cross(t, k))
    return rho * n, t, k, normal * n + g.F2 * aside + g.F3 * t, M3


@cache
def marched(name: str) -> Marched:
    case = named(name)
    A, C, rho = case.rod.bending_stiffness, case.rod.torsional_stiffness, case.rho
    *start, M3 = beginning(case)
    d1 = orbit(name).material_frame[0, 0]  # where the section's own mark stands is a convention

    def right(_: float, y: np.ndarray) -> np.ndarray:
        r, t, k, F, d = y.reshape(5, 3)
        r, t, k, F = held(A, M3, rho, r, t, k, F)
        k2, dF, _ = rates(A, M3, rho, r, t, k, F)
        turn = np.cross(t, k) + M3 / C * t
        return np.concatenate([t, k, k2, dF, np.cross(turn, d)])

    s = np.linspace(0, case.rod.L, 401)
    y = solve_ivp(right, (0, s[-1]), np.concatenate([*start, d1]), "DOP853", s, rtol=1e-12, atol=1e-12).y
    r, t, k, F, d = y.T.reshape(-1, 5, 3).transpose(1, 0, 2)
    contact = np.array([rates(A, M3, rho, *at)[2] for at in zip(r, t, k, F, strict=True)])
    return Marched(r, t, k, F, contact, d, float(M3))


@cases
def test_shape_forces_contact_section_and_loads_are_those_of_the_orbit_and_the_march_stays_on_the_cylinder(
    name: str,
) -> None:
    case, sol, found = named(name), orbit(name), marched(name)
    A, aside = case.rod.bending_stiffness, np.cross(found.t, sol.normal)
    moment = np.cross(found.r, found.F) + A * np.cross(found.t, found.k) + found.M3 * found.t
    np.testing.assert_allclose(found.M3, sol.M3, rtol=1e-12)
    for got, wanted in (
        (np.hypot(found.r[:, 0], found.r[:, 1]), np.full(401, case.rho)),
        (np.linalg.norm(found.t, axis=1), np.ones(401)),
        (sol.position, found.r),
        (sol.tangent, found.t),
        (sol.kappa, np.linalg.norm(found.k, axis=1)),
        (sol.F1, dot(found.F, sol.normal)[:, 0]),
        (sol.F2, dot(found.F, aside)[:, 0]),
        (sol.F3, dot(found.F, found.t)[:, 0]),
        (sol.contact, found.contact),
        (sol.material_frame[:, 0], found.d1),
        (found.F @ EZ, np.full(401, sol.FZ)),
        (moment @ EZ, np.full(401, sol.MZ)),
    ):
        # a march of 1e-12 a step over some hundreds of steps, grown by the condition; 2e-9 covers that for all of these
        atol = 2e-9 * sol.condition * max(1, np.abs(wanted).max())
        np.testing.assert_allclose(got, wanted, rtol=0, atol=atol)
