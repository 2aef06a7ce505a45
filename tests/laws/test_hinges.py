"""Rods between hinges, where the dead-load problem between the same two angles is singular: they are solved, followed,
differentiated and counted as what they are. Shapes are marched by SciPy, apart from the solver."""

from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, Solution, equilibria, follow, solve
from tests.equation import loads_of, march
from tests.laws.test_held_ends import discrete_index

TURNING = {"GJ": 0.9, "L": 2.4, "FZ": 1.9, "MZ": 1.8, "M3": -0.5}
AT_ONE_END = {"GJ": 0.5, "L": 5.7, "betaL": -1.118, "FZ": 0.84, "MZ": 0.91, "M3": -2.954}


def between_hinges(GJ: float, L: float, **given: float) -> Case:
    free = {} if "betaL" in given else {"M1L": 0.0}
    return Case(Rod(EI=1.0, GJ=GJ, a=0.2, L=L), Cylinder(R=0.8), Ends(M10=0.0, **free, **given))


def marched(solution: Solution) -> Any:
    """beta and beta_t at the far end, marched from the start of a solution; rho = A = 1."""
    problem = solution.problem
    loads = [float(getattr(problem, name)[0]) for name in ("lam", "mu", "phi")]
    return march(loads, problem.beta0, 0.0, float(problem.span[0])).y[:, -1]


def names_of(case: Case) -> tuple[str, ...]:
    return ("dbeta0", "dbetaL" if case.given.betaL is None else "betaL", "phi", "lam", "mu")  # type: ignore[union-attr]


def test_mirror_images_have_the_derivatives_that_differences_of_solved_rods_have() -> None:
    found = [one.solution for one in equilibria(between_hinges(**TURNING), values=5, tries=2)]
    bent = [one for one in found if np.ptp(one.beta)]
    assert len(bent) == 4
    for one in bent:
        steps = [solve(between_hinges(**TURNING | {"FZ": 1.9 + d}), seed=one, tol=1e-11) for d in (1e-4, -1e-4)]
        wanted = float(steps[0].z[-1] - steps[1].z[-1]) / 2e-4
        rates = one.sensitivity(["FZ"], ["height"])
        assert rates.solved, rates.outcome
        assert rates.observables["height"][0] == pytest.approx(wanted, abs=1e-6)
        assert np.abs(marched(one) - [one.beta[-1], 0]).max() < 1e-10
    heights = sorted(float(one.sensitivity(["FZ"], ["height"]).observables["height"][0]) for one in bent)
    assert heights[2:] == pytest.approx([-0.0267450] * 2, abs=1e-7)


def test_a_held_azimuth_has_no_derivative_by_a_load() -> None:
    case = between_hinges(1.4, 2.9, betaL=1.9229, FZ=2.77, M3=0.2474, azimuth=-1.5757)
    found = solve(case).sensitivity(["FZ", "azimuth"], ["wraps"])
    assert found.observables["wraps"] == pytest.approx([0, 1 / (2 * np.pi)], abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("M3", (-4.954, -0.954))
def test_every_point_of_a_branch_with_a_hinge_is_an_equilibrium_of_its_index(M3: float) -> None:
    branch = follow(solve(between_hinges(**AT_ONE_END)), M3=M3)
    for point in branch.points[:: max(len(branch) // 8, 1)]:
        end = marched(point.solution)
        assert point.solution.solved, point.solution.outcome
        assert end[0] == pytest.approx(-1.118, abs=1e-6)  # a march from a start next to a saddle grows its rounding
        mesh = discrete_index(point.problem, point.solution.trajectory.orbit, names_of(point.case), 2.0)
        assert point.index == mesh or any(branch.points[one.position] is point for one in branch.special)


@pytest.mark.parametrize("given", (
    {"GJ": 0.8, "L": 3.6, "FZ": 1.2, "MZ": -1.2, "M3": 0.8},
    pytest.param({"GJ": 1.4658755695561991, "L": 5.170419536228204, "FZ": 0.3129545991362497,
                  "MZ": -0.009387661996193952, "M3": -1.5223550219450055}, marks=pytest.mark.slow),
))  # fmt: skip
def test_equilibria_between_hinges_have_their_index_and_none_of_two_images_is_missing(given: dict[str, float]) -> None:
    case = between_hinges(**given)
    found = equilibria(case)
    starts = sorted(round(float(one.solution.beta[0]), 5) for one in found)
    for one in found:
        mesh = discrete_index(one.solution.problem, one.solution.trajectory.orbit, names_of(case), 1 / given["GJ"])
        assert one.index == mesh
        if np.ptp(one.solution.beta):
            assert np.abs(marched(one.solution) - [one.solution.beta[-1], 0]).max() < 1e-9
    if given["L"] > 5:
        assert 1.16749 in starts


def test_a_helix_between_two_hinges_is_its_own_seed_and_leads_to_the_next_one() -> None:
    case = between_hinges(**TURNING)
    helix = solve(case)
    assert not np.ptp(helix.beta)
    assert solve(case, seed=helix).beta == pytest.approx(helix.beta, abs=1e-14)
    later = solve(between_hinges(**TURNING | {"FZ": 2.5}), seed=helix)
    assert later.solved, later.outcome
    end = follow(helix, FZ=2.5).end.reason
    assert "helix" in end


@pytest.mark.parametrize("betaL", (pytest.param(None, marks=pytest.mark.slow), 1.4))
def test_the_list_between_hinges_is_that_of_a_fine_march(betaL: float | None) -> None:
    free = {} if betaL is None else {"betaL": betaL}
    case = between_hinges(GJ=0.5275591, L=4.890809, FZ=0.6906972, MZ=-0.6810731, M3=1.1537148, **free)
    angles = np.linspace(-np.pi, np.pi, 4001) + 1e-7

    y = march(loads_of(case), angles, 0 * angles, 4.890809, 1e-9).y[:, -1].reshape(2, -1)
    off = y[1] if betaL is None else np.sin((y[0] - betaL) / 2)
    roots = angles[:-1][off[1:] * off[:-1] < 0]
    search = equilibria(case).search  # type: ignore[attr-defined]
    assert len(equilibria(case)) + search.outside == roots.size
    assert search.problems == 0
