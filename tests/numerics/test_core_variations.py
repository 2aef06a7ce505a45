"""Variations of orbits and of equilibria by the compiled core, against a march and against differences."""

import numpy as np
import pytest

from solver import solve
from solver.core.library import widest
from solver.observe import motions
from solver.observe.observables import OBSERVABLES, is_count
from solver.orbits import variations as orbit_variations
from solver.orbits.periodic_orbit import HELIX, TIGHT, solve_orbit
from solver.orbits.variations import Variations, variations_on
from solver.problem.dimensionless import StartProblem
from tests.cases import in_units_of_rho
from tests.equation import march_with_variations


def variations(seed: int, size: int) -> Variations:
    """The variations of random orbits."""
    rng = np.random.default_rng(seed)
    loads, ends = rng.normal(size=(3, size)) * [[2.0], [1.0], [2.0]], rng.uniform(-4, 4, size)
    problem = StartProblem(*loads, 10 ** rng.uniform(0, 2, size), ends, 1.5 * rng.normal(size=size))
    orbit = solve_orbit(problem, TIGHT)
    assert not (orbit.kind == HELIX).any()
    return variations_on(orbit)


def test_variations_are_those_of_a_march_of_the_variational_equation() -> None:
    """eta'' + H' eta = -H_q, and the integrals of H_q eta."""
    found = variations(2, 12)
    p = found.orbit.problem
    rows = np.flatnonzero(p.span < 12)[:4]
    change = found.change(p.span[:, None], found.directions)
    assert rows.size == 4
    for i in rows:
        loads = float(p.lam[i]), float(p.mu[i]), float(p.phi[i])
        _, by, _ = march_with_variations(loads, float(p.beta0[i]), float(p.dbeta0[i]), float(p.span[i]), 1e-11)
        beta, rate, alpha, z, turn = by[..., -1]
        marched = np.stack([beta, rate, alpha, -turn, z], axis=1)
        own = np.column_stack([change.beta[i, 0], change.rate[i, 0], change.integrals[i, 0]])
        assert own == pytest.approx(marched, rel=1e-8, abs=1e-8 * np.abs(marched).max())


def test_derivatives_in_lanes_are_those_of_one_number_at_a_time_to_the_bit(monkeypatch) -> None:
    """At more stations than are read together, and at so few that a group of them lies on one panel seldom."""
    rng, B = np.random.default_rng(5), 12
    numbers = *rng.normal(size=(3, B)), rng.uniform(1, 80, B), rng.uniform(-2, 2, B), rng.normal(size=B)
    case, fields = in_units_of_rho(*numbers), ("R", "a", "beta0", "F3")
    names = [name for name, row in OBSERVABLES.items() if not (is_count(name) or row.free)]

    def bits(lanes: int) -> list[bytes]:
        monkeypatch.setattr(motions, "HOW", motions.HOW._replace(lanes=lanes))
        monkeypatch.setattr(orbit_variations, "widest", lambda: lanes)
        found = [solve(case, stations=n).sensitivity(fields, wanted) for n, wanted in ((301, ()), (30, names))]
        arrays = [getattr(one, name) for one in found for name in ("beta", "dbeta", "alpha", "z", "gamma")]
        return [np.asarray(array).tobytes() for array in (*arrays, *found[1].observables.values())]

    scalar = bits(1)
    for lanes in (2, 4, 8):
        if lanes <= widest():
            assert bits(lanes) == scalar, lanes


def test_panels_are_so_short_that_shorter_ones_change_no_derivative_by_more_than_rounding(monkeypatch) -> None:
    """Rods of some radii: the derivatives by R are small differences of large ones, where panels of 0.45 left 1e-10."""
    rods = np.array([
        [0.11259806, 0.42855351, 1.38307826, 1.88801224, 0.50798591, 0.81829713],
        [-1.80731611, -1.60594555, -0.88150770, 1.17842668, -2.42874905, -3.72461464],
        [-0.11148006, 1.03398362, 1.38768966, 3.15175289, -0.45442750, -3.11673005],
        [2.78686374, 0.20378568, -0.16318965, 4.35195908, 2.46575669, -4.67727449],
    ]).T  # fmt: skip

    def rates() -> np.ndarray:
        found = solve(in_units_of_rho(*rods), tol=1e-12, stations=41).sensitivity(("R", "beta0", "dbeta0"))
        return np.stack([getattr(found, name) for name in ("beta", "dbeta", "alpha", "z", "gamma")])

    own = rates()
    monkeypatch.setattr(motions, "HOW", motions.HOW._replace(length=0.2))
    finer = rates()
    assert (np.abs(own - finer).max(axis=-1) <= 1e-11 * np.abs(finer).max(axis=-1)).all()
