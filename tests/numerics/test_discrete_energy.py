"""The energy of shapes on a mesh: against exact equilibria, differences, and dense matrices."""

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, equilibria
from solver.branches.given_numbers import Given
from solver.branches.held_index import held_energy
from solver.branches.path_correction import state_of
from solver.held.bordered_bands import Bordered, times
from solver.held.discrete_energy import DiscreteEnergy, EnergyMesh
from solver.held.energy_minima import energy_minima, refinement
from solver.orbits.boundary import path_of
from solver.problem.dimensionless import reduce_held

SHORT, DRUM = Rod(EI=1.0, GJ=0.8, a=0.1, L=5.0), Cylinder(R=0.9)  # rho = 1, A = 1
ENDS = (
    Ends(0.4, -0.3, height=4.0, MZ=0.2, M3=-0.3),
    Ends(0.4, -0.3, height=4.0, azimuth=0.8, rotation=2.0),
    Ends(0.4, M1L=0.3, height=4.0, MZ=0.2, rotation=-1.0),
    Ends(M10=-0.2, betaL=0.1, azimuth=0.5, FZ=0.3),
)


def given_of(ends: Ends) -> Given:
    return Given.of(reduce_held(Case(SHORT, DRUM, ends)))


def shape_on(land: DiscreteEnergy) -> np.ndarray:
    """Some shape that meets the constraints."""
    u = land.mesh.nodes
    beta = land.meet(land.shape(0.4 - 0.7 * u + 1.2 * np.sin(np.pi * u) + 0.3 * np.sin(2 * np.pi * u)), 20)
    assert beta is not None
    return beta


@pytest.mark.parametrize("ends", ENDS)
def test_slope_and_curvature_are_those_of_differences_of_the_energy(ends: Ends) -> None:
    """Along the constraints, on which the energy and not a Lagrangian is measured."""
    land = DiscreteEnergy(given_of(ends), EnergyMesh.with_layers(2, 1.0), 1.0)
    beta, u = shape_on(land), land.mesh.nodes
    slopes = land.slopes(beta)
    assert slopes is not None
    free = slice(int("beta0" in land.given.names), u.size - int("betaL" in land.given.names))
    step = np.sin(2 * np.pi * u)[free] + 0.5 * np.cos(3 * u)[free]
    borders = slopes.curved.borders[: len(land.held)]
    step -= borders.T @ np.linalg.lstsq(borders @ borders.T, borders @ step, rcond=None)[0]
    h = 1e-3
    sides = [land.meet(land.move(beta, way * step), 20) for way in (-h, h)]
    below, above = (land.energy(side) for side in sides if side is not None)
    assert (above - below) / (2 * h) == pytest.approx(slopes.slope @ step, abs=1e-5)  # of the order of h^2
    # E = E0 + g t + c t^2/2 on the constraints, whose second order is in the multipliers of the curvature
    bent = step @ times(slopes.curved.band, step)
    if "turn" in land.given.names:
        bent += (slopes.curved.borders[-1] @ step) ** 2 / -slopes.curved.corner[-1]
    aside = sum(side - beta for side in sides if side is not None)[free]  # of second order, across the constraints
    assert above + below - 2 * land.energy(beta) == pytest.approx(h * h * bent + slopes.slope @ aside, rel=1e-4)


@pytest.mark.parametrize("ends", ENDS)
def test_a_minimum_has_the_loads_and_the_energy_of_a_stable_equilibrium(ends: Ends) -> None:
    case = Case(SHORT, DRUM, ends)
    given = given_of(ends)
    lowest = min((refinement(minimum) for minimum in energy_minima(given)), key=lambda minimum: minimum.energy)  # type: ignore[union-attr]
    stable = [one for one in equilibria(case, values=4, tries=0) if one.index == 0]
    best = min(stable, key=lambda one: one.energy)
    assert lowest is not None
    assert lowest.energy == pytest.approx(best.energy, rel=1e-8)
    if not case.has_hinge:  # else it is a shape on nodes
        state = state_of(best.solution.problem, path_of(best.path, 0))
        assert held_energy(state, given) == pytest.approx(best.energy, rel=1e-10)
    numbers = {name: float(getattr(best.solution.problem, name)[0]) for name in lowest.numbers}
    assert lowest.numbers == pytest.approx(numbers, abs=1e-6)


def test_a_long_rod_has_its_mesh_refined_where_it_turns() -> None:
    given = Given.of(reduce_held(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=60.0), DRUM, Ends(0.7, 0.4, height=32.0))))
    coarse = min(energy_minima(given), key=lambda minimum: minimum.energy)
    fine = refinement(coarse)
    assert fine is not None
    assert fine.land.mesh.breaks.size > coarse.land.mesh.breaks.size
    assert fine.energy <= coarse.energy + 1e-9  # a finer mesh has every shape of a coarser one


@pytest.mark.parametrize("shift", [0.0, 3.0])
def test_a_bordered_band_is_solved_and_counted_as_the_dense_matrix(shift: float) -> None:
    """Of indefinite bands, and with 3 added of positive ones; the borders leave what is orthogonal to the first two."""
    rng = np.random.default_rng(1)
    k, d = 30, 4
    band, borders, corner = rng.normal(size=(d, k)), rng.normal(size=(3, k)), np.array([0.0, 0.0, -2.0])
    band[0] += shift
    dense = np.diag(band[0])
    for i in range(1, d):
        dense += np.diag(band[i, : k - i], i) + np.diag(band[i, : k - i], -i)
    whole = dense + np.outer(borders[2], borders[2]) / 2
    keep = np.linalg.qr(borders[:2].T, mode="complete")[0][:, 2:]
    left = keep.T @ whole @ keep
    right = rng.normal(size=k)
    matrix = Bordered(band, borders, corner)
    assert matrix.negative == int((np.linalg.eigvalsh(left) < 0).sum())
    np.testing.assert_allclose(matrix.solve(right), keep @ np.linalg.solve(left, keep.T @ right), atol=1e-9)
    np.testing.assert_allclose(times(band, right), dense @ right, atol=1e-12)
