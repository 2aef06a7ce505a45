"""The rod in plain Cartesian vectors, written twice anew: sharing nothing with `solver` but the case.

Kirchhoff's balances with r, t, t' and F as vectors, contact from the fourth derivative of x^2 + y^2 = rho^2; and a
discrete rod of nodes, its edges of given length, its nodes at given radius, contact from the multipliers.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

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


# one: differential equations for vectors


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


def close(got: np.ndarray, wanted: np.ndarray, condition: float) -> None:
    # a march of 1e-12 a step over some hundreds of steps, grown by the condition; 2e-9 covers that for all of these
    np.testing.assert_allclose(got, wanted, rtol=0, atol=2e-9 * condition * max(1, np.abs(wanted).max()))


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
        close(got, wanted, sol.condition)


# two: nodes, edges and multipliers


@dataclass(frozen=True)
class Chain:
    """N edges of length h between two angles, dead loads at the far end. Columns of a state (N + 3, 5), a row a node
    from -1 to N + 1: x, y, z, the tension of the edge that follows, the contact."""

    A: float
    M3: float
    FZ: float
    MZ: float
    rho: float
    h: float
    first: np.ndarray
    aside: np.ndarray
    betaL: float

    def edges(self, r: np.ndarray) -> np.ndarray:
        return (r[1:] - r[:-1]) / self.h

    def moments(self, r: np.ndarray) -> np.ndarray:
        """At nodes 0..N: bending along t x t', and what has the component M3 along both edges."""
        t = self.edges(r)
        whole = 1 + dot(t[:-1], t[1:])
        return (2 * self.A / self.h * np.cross(t[:-1], t[1:]) + self.M3 * (t[:-1] + t[1:])) / whole

    def forces(self, state: np.ndarray) -> np.ndarray:
        """On the edges 0..N - 1: the shear that balances moments, and the multiplier of the length along the edge."""
        t = self.edges(state[:, :3])[1:-1]
        return np.cross(t, np.diff(self.moments(state[:, :3]), axis=0)) / self.h + state[1:-2, 3:4] * t

    def residual(self, state: np.ndarray) -> np.ndarray:
        r, tension, push = state[:, :3], state[:, 3], state[:, 4]
        F, M, t = self.forces(state), self.moments(r), self.edges(r)
        length = dot(t, t)[:, 0] - 1
        radius = dot(flat(r), flat(r))[:, 0] / self.rho**2 - 1
        out = np.zeros_like(state)
        # node -1: by length, radius, and the angle that it makes with node 1 across node 0
        out[0] = length[0], radius[0], (r[2] - r[0]) @ self.aside / self.h, tension[0], push[0]
        out[1, :3], out[1, 3], out[1, 4] = r[1] - self.first, length[1], push[1]
        # nodes 1..N - 1: forces balance; the edge that follows keeps its length, the node its radius
        out[2:-2, :3] = np.diff(F, axis=0) + self.h * push[2:-2, None] * flat(r[2:-2]) / self.rho
        out[2:-2, 3], out[2:-2, 4] = length[2:-1], radius[2:-2]
        # node N: at its radius, under the dead loads
        about = np.cross((r[-2] + r[-3]) / 2, F[-1]) + (M[-1] + M[-2]) / 2
        out[-2] = radius[-2], F[-1] @ EZ - self.FZ, about @ EZ - self.MZ, tension[-2], push[-2]
        aside = -np.cos(self.betaL) * np.cross(EZ, flat(r[-2])) / self.rho + np.sin(self.betaL) * EZ
        out[-1] = length[-1], radius[-1], (r[-1] - r[-3]) @ aside / self.h, tension[-1], push[-1]
        return out

    def jacobian(self, state: np.ndarray):
        """By complex steps, every fifth node at once: an equation sees no further than two nodes away."""
        rows, columns, values = [], [], []
        count = state.shape[0]
        for colour in range(5):
            node = np.arange(count)
            source = node + (colour - node + 2) % 5 - 2  # the node of this colour that each row sees
            seen = (source >= 0) & (source < count)
            for j in range(5):
                moved = state.astype(complex)
                moved[colour::5, j] += 1e-30j
                slope = self.residual(moved).imag / 1e-30
                for i in range(5):
                    rows.append(5 * node[seen] + i)
                    columns.append(5 * source[seen] + j)
                    values.append(slope[seen, i])
        triples = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        return coo_matrix(triples, shape=(5 * count, 5 * count)).tocsc()


def chain(name: str, count: int) -> Chain:
    """The ends and loads that the march of the start problem has."""
    case, found, A = named(name), marched(name), named(name).rod.bending_stiffness
    r, t, k, F, M3 = beginning(case)
    moment = np.cross(r, F) + A * np.cross(t, k) + M3 * t
    last = np.arctan2(found.t[-1] @ np.cross(EZ, flat(found.r[-1])) / case.rho, found.t[-1] @ EZ)
    aside = np.cross(t, -flat(r) / case.rho)
    return Chain(A, M3, F @ EZ, moment @ EZ, case.rho, case.rod.L / count, r, aside, last)


def guess(name: str, count: int) -> np.ndarray:
    """A state from the march, its nodes a little off it, no tension and no contact."""
    found = marched(name)
    s, at = np.linspace(0, 1, 401), np.linspace(-1 / count, 1 + 1 / count, count + 3)
    r = np.stack([np.interp(at, s, v) for v in found.r.T], axis=1)
    r[0], r[-1] = 2 * r[1] - r[2], 2 * r[-2] - r[-3]
    return np.column_stack([r + 1e-3 * np.sin(40 * at)[:, None], np.zeros((count + 3, 2))])


@cache
def settled(name: str, count: int) -> np.ndarray:
    """The chain at rest, by Newton's rule on positions and multipliers together; its rows 0..count."""
    rod, state = chain(name, count), guess(name, count)
    for _ in range(30):
        step = splu(rod.jacobian(state)).solve(-rod.residual(state).reshape(-1)).reshape(state.shape)
        state = state + step
        if np.abs(step[:, :3]).max() < 1e-10:
            return state[1:-1]
    raise AssertionError("Newton's rule did not settle")


@cases
def test_nodes_and_multipliers_converge_to_the_orbit_at_second_order(name: str) -> None:
    sol = orbit(name)
    off = []
    for count in (400, 800):
        rod = settled(name, count)[:: count // 400]
        position = np.abs(rod[:, :3] - sol.position).max()
        contact = np.abs(rod[1:-1, 4] - sol.contact[1:-1]).max()
        off.append([position / sol.case.rho, contact / np.abs(sol.contact).max()])
    order = np.log2(np.array(off[0]) / off[1])
    assert (np.abs(order - 2) < 0.1).all(), (order, off)
    assert np.max(off[1]) < 0.05, off  # at 800 edges of the sharpest bends
