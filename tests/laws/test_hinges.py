"""Rods between hinges, where the dead-load problem between the same two angles is singular: they are solved, followed,
differentiated and counted as what they are. Shapes are marched by SciPy, apart from the solver."""

from typing import Any

import numpy as np
import pytest

from solver import Branch, Case, Cylinder, Ends, Rod, Solution, equilibria, follow, region_map, solve
from solver.branches.given_numbers import Given
from solver.branches.helices import helices_of
from solver.follow_result import SpecialPoint
from solver.numerics.arclength import END
from solver.problem.dimensionless import reduce_held
from tests.equation import force, loads_of, march
from tests.laws.test_held_ends import discrete_index

TURNING = {"GJ": 0.9, "L": 2.4, "FZ": 1.9, "MZ": 1.8, "M3": -0.5}
AT_ONE_END = {"GJ": 0.5, "L": 5.7, "betaL": -1.118, "FZ": 0.84, "MZ": 0.91, "M3": -2.954}


def between_hinges(GJ: float, L: float, **given: float) -> Case:
    free = {} if "betaL" in given else {"M1L": 0.0}
    return Case(Rod(EI=1.0, GJ=GJ, a=0.2, L=L), Cylinder(R=0.8), Ends(M10=0.0, **free, **given))


def marched(solution: Solution) -> Any:
    """beta and beta_t at the far end, marched from the start of a solution; rho = A = 1."""
    problem = solution.problem
    return march(problem_loads(solution), problem.beta0, 0.0, float(problem.span[0])).y[:, -1]


def problem_loads(solution: Solution) -> list[float]:
    return [float(getattr(solution.problem, name)[0]) for name in ("lam", "mu", "phi")]


def miss(solution: Solution) -> float:
    """How far two marches from the middle of a solution end from its own ends, in beta and beta_t.

    Next to a saddle a march over the whole rod would grow the rounding of its start to the square of this.
    """
    rho, middle = float(solution.case.rho), solution.beta.size // 2
    beta, rate = solution.beta, solution.dbeta * rho
    half = float(solution.t[0, middle])
    ahead, back = (march(problem_loads(solution), beta[middle], sign * rate[middle], half).y[:, -1] for sign in (1, -1))
    off = [ahead[0] - beta[-1], ahead[1] - rate[-1], back[0] - beta[0], back[1] + rate[0]]
    return float(np.abs(off).max())


def names_of(case: Case) -> tuple[str, ...]:
    return ("dbeta0", "dbetaL" if case.given.betaL is None else "betaL", "phi", "lam", "mu")  # type: ignore[union-attr]


def test_mirror_images_have_the_derivatives_that_differences_of_solved_rods_have() -> None:
    found = [one.solution for one in equilibria(between_hinges(**TURNING), values=5, tries=2)]
    bent = [one for one in found if np.ptp(one.beta) > 1e-9]
    assert len(bent) == 6
    for one in bent:
        steps = [solve(between_hinges(**TURNING | {"FZ": 1.9 + d}), seed=one, tol=1e-11) for d in (1e-4, -1e-4)]
        wanted = float(steps[0].z[-1] - steps[1].z[-1]) / 2e-4
        rates = one.sensitivity(["FZ"], ["height"])
        assert rates.solved, rates.outcome
        assert rates.observables["height"][0] == pytest.approx(wanted, abs=1e-6)
        assert np.abs(marched(one) - [one.beta[-1], 0]).max() < 1e-10
    heights = sorted(float(one.sensitivity(["FZ"], ["height"]).observables["height"][0]) for one in bent)
    assert heights[2:4] == pytest.approx([-0.0267450] * 2, abs=1e-7)


def test_a_held_azimuth_has_no_derivative_by_a_load() -> None:
    case = between_hinges(1.4, 2.9, betaL=1.9229, FZ=2.77, M3=0.2474, azimuth=-1.5757)
    found = solve(case).sensitivity(["FZ", "azimuth"], ["turns_around"])
    assert found.observables["turns_around"] == pytest.approx([0, 1 / (2 * np.pi)], abs=1e-9)  # differences on nodes


@pytest.mark.slow
@pytest.mark.parametrize("M3", (-4.954, -0.954))
def test_every_point_of_a_branch_with_a_hinge_is_an_equilibrium_of_its_index(M3: float) -> None:
    branch = follow(solve(between_hinges(**AT_ONE_END)), M3=M3)
    for point in branch.points[:: max(len(branch) // 8, 1)]:
        assert point.solution.solved, point.solution.outcome
        assert miss(point.solution) < 1e-8
        assert point.solution.beta[-1] == pytest.approx(-1.118, abs=1e-12)
        mesh = discrete_index(point.problem, point.solution.trajectory, names_of(point.case), 2.0)
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
        mesh = discrete_index(one.solution.problem, one.solution.trajectory, names_of(case), 1 / given["GJ"])
        assert one.index == mesh
        if np.ptp(one.solution.beta) > 1e-9:
            assert np.abs(marched(one.solution) - [one.solution.beta[-1], 0]).max() < 1e-9
    if given["L"] > 5:
        assert 1.16749 in starts


def test_a_helix_between_two_hinges_is_its_own_seed_and_leads_to_the_next_one() -> None:
    case = between_hinges(**TURNING)
    helix = solve(case)
    assert np.ptp(helix.beta) < 1e-14
    assert solve(case, seed=helix).beta == pytest.approx(helix.beta, abs=1e-14)
    later = solve(between_hinges(**TURNING | {"FZ": 2.5}), seed=helix)
    assert later.solved, later.outcome
    branch = follow(helix, FZ=2.5)
    assert branch.end.reason == END
    assert branch.points[-1].solution.beta == pytest.approx(later.beta, abs=1e-10)


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


def turns_apart(beta: Any, other: Any) -> float:
    """The largest difference of two shapes [rad], but for whole turns."""
    apart = beta - other
    return float(np.abs(apart - 2 * np.pi * np.round(apart[0] / (2 * np.pi))).max())


def specials(branch: Branch) -> list[tuple[str, int, int]]:
    return [(special.kind, special.before, special.after) for special in branch.special]


def turns_back(branch: Branch, special: SpecialPoint) -> bool:
    """Whether a branch comes back to the side from which it came, as that of a pair that splits off in a pitchfork."""
    before, at, after = branch.values[special.position - 1 : special.position + 2]
    return bool((before - at) * (after - at) > 0)


def rods_between_hinges(seed: int, count: int) -> list[tuple[Case, float]]:
    """Cases with two hinges, and the FZ to which their equilibria are followed."""
    rng = np.random.default_rng(seed)
    rods = []
    for _ in range(count):
        E, L, FZ, M3, way = rng.uniform((5e3, 4.0, -15.0, -6.0, 2.0), (3e4, 13.0, 2.0, 6.0, 5.0))
        case = Case(Rod(E=E, nu=0.25, a=0.25, L=L), Cylinder(R=0.75), Ends(M10=0.0, M1L=0.0, FZ=FZ, M3=M3))
        rods.append((case, float(FZ + way * rng.choice([-1, 1]))))
    return rods


@pytest.mark.parametrize(("case", "goal"), [
    *rods_between_hinges(123, 1),
    pytest.param(between_hinges(0.8, 3.6, FZ=1.2, MZ=-1.2, M3=0.8), -6.0, marks=pytest.mark.slow),
    *(pytest.param(*row, marks=pytest.mark.slow) for row in rods_between_hinges(47, 10)),
])  # fmt: skip
def test_between_two_hinges_a_branch_goes_on_as_that_of_the_rod_run_through_backwards(case: Case, goal: float) -> None:
    """The loads are the same from either end. What rounding makes of beta_t at a hinge is no pitchfork."""
    listed = equilibria(case)
    assert sum((-1) ** one.index for one in listed) == 0  # as on a circle: none is missing
    assert "missing" not in listed.remark
    found = [one.solution for one in listed]
    branches = [follow(one, FZ=goal) for one in found]
    for one, branch in zip(found, branches, strict=True):
        assert branch.end.reason == END
        (image, *_) = (k for k, other in enumerate(found) if turns_apart(other.beta, one.beta[::-1]) < 1e-6)
        assert specials(branch) == specials(branches[image])
        assert all(special.before != special.after or turns_back(branch, special) for special in branch.special)
        last, mirrored = branch.points[-1], branches[image].points[-1]
        assert last.index == mirrored.index
        assert turns_apart(last.solution.beta, mirrored.solution.beta[::-1]) < 1e-7
        assert miss(last.solution) < 1e-6  # half of a march of 13 radii grows rounding so far


def test_a_fold_of_a_hinged_rod_has_its_shape_and_its_reactions() -> None:
    """Its condition number has no bound, and it is solved with fewer digits, as other folds are."""
    case = between_hinges(0.7, 3.0, betaL=0.9, FZ=-3.0)
    branches = [follow(one.solution, FZ=[-6.0, 3.0]) for one in equilibria(case)]
    folds = [
        branch.points[one.position].solution for branch in branches for one in branch.special if one.kind == "fold"
    ]
    assert len(folds) > 1
    for fold in folds:
        assert fold.solved, fold.outcome
        assert np.isfinite([*fold.reactions.values(), *fold.loads]).all()
        assert miss(fold) < 1e-9


HEAVY = Rod(EI=1.0, GJ=0.8, a=0.1, L=4.0, weight=0.5)


@pytest.mark.parametrize("inclination", (pytest.param("0deg", marks=pytest.mark.slow), "90deg"))
def test_equilibria_whose_angles_differ_by_whole_turns_are_listed_once(inclination: str) -> None:
    case = Case(HEAVY, Cylinder(R=0.9, inclination=inclination), Ends(M10=0.0, M1L=0.0, FZ=-0.5))
    shapes = [one.solution.beta for one in equilibria(case)]
    assert len(shapes) == 8
    for i, beta in enumerate(shapes):
        assert abs(beta[0]) <= np.pi + 1e-12
        assert all(turns_apart(beta, other) > 1e-6 or np.ptp(beta) > 1e-6 for other in shapes[:i])


@pytest.mark.slow
def test_a_map_of_rods_between_hinges_counts_each_equilibrium_once() -> None:
    rod, cylinder = Rod(EI=1.0, GJ=0.8, a=0.1, L=2.0, weight=0.5), Cylinder(R=0.9, inclination="90deg")
    found = region_map(Case(rod, cylinder, Ends(M10=0.0, M1L=0.0, FZ=-0.5)), FZ=(-1.5, -0.2), L=(1.5, 3.0), lattice=3)
    counts = [(len(region.equilibria), found.folds.indices_at(region.values).total()) for region in found.regions]
    assert max(map(max, counts)) <= 8
    assert sum(listed == counted for listed, counted in counts) >= 2  # nothing proves that all curves were met


def test_a_branch_steps_over_to_no_other_one_that_passes_close() -> None:
    """Near -206 two branches are 0.1 rad apart; each start on one of them meets the same folds, and no branch point."""
    case = Case(
        Rod(EI=100.0, GJ=60.0, a=0.2, L=4.0),
        Cylinder(1.0, "inside"),
        Ends(M10=0.0, betaL=0.5, azimuth=1.2575, FZ=-194.67),
    )
    starts = equilibria(case, within={"MZ": (-40.0, 80.0), "beta0": (-2.5, 0.0)}, values=5, tries=0)
    met = {one.index: set() for one in starts}
    for one in starts:
        branch = follow(one.solution, FZ=[-300.0, -60.0])
        met[one.index].add(tuple(sorted((point.kind, round(point.value, 4)) for point in branch.special)))
    assert met[0] == {(("fold", -245.9659),)}
    assert met[1] == {(("fold", -213.336), ("fold", -191.2938))}


def test_no_helix_between_hinges_is_missing_by_the_rounding_of_its_angle() -> None:
    """H has as many roots as it changes its sign on a circle of angles."""
    rng, angles = np.random.default_rng(5), np.linspace(-np.pi, np.pi, 100_001)
    for _ in range(100):
        loads = rng.uniform(-4.0, 4.0, 3)
        FZ, MZ, M3 = loads[[2, 0, 1]]  # rho = A = 1
        case = between_hinges(0.8, 3.0, FZ=FZ, MZ=MZ, M3=M3)
        signs = np.sign(force(angles, *loads))
        assert len(helices_of(Given.of(reduce_held(case)))[0]) == np.count_nonzero(signs[1:] != signs[:-1])


def test_two_close_equilibria_beside_a_saddle_are_in_the_list_between_hinges() -> None:
    rod = Rod(EI=1.0, GJ=0.8, a=0.2, L=11.75923798454756)
    ends = Ends(M10=0.0, M1L=0.8762421961143501, FZ=-3.5854892403095997, M3=-0.6402433659084887)
    listed = equilibria(Case(rod, Cylinder(R=0.8), ends))
    assert sum((-1) ** one.index for one in listed) == 0  # as on a circle: none is missing
    assert "missing" not in listed.remark
