"""Fold curves under held ends, against equations that DOP853 marches with their variations, and against `follow`."""

from collections import Counter
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.spatial.distance import pdist

from solver import Branch, Case, Cylinder, Ends, Rod, equilibria, fold_curves, follow, region_map, solve, trace_fold
from solver.branches import linked_folds
from solver.branches.deflation import across_fold, end_vector
from solver.branches.fold_curves import FoldCurve
from solver.branches.given_numbers import Given
from solver.branches.parameter_plane import parameter_plane
from solver.branches.path_correction import state_of
from solver.equilibria_result import HeldEquilibria
from solver.problem.dimensionless import reduce_held
from solver.trace_fold import system_on
from tests.equation import march_with_variations


def case_of(L: float, **ends: float) -> Case:
    return Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=L), Cylinder(R=0.75), Ends(beta0=0.5, **ends))


@cache
def over_the_azimuth() -> Branch:
    """Height and azimuth are held, FZ and MZ unknown; two folds, which meet in a cusp at another height."""
    return follow(solve(case_of(7.0, betaL=0.8, height=2.5, azimuth=0.5)), azimuth=[-2.0, 3.0])


@cache
def hinged() -> Branch:
    """The far end is a hinge."""
    return follow(solve(case_of(4.0, M1L=0.0, FZ=-20.0)), FZ=[-40.0, -2.0])


def test_the_guess_across_a_fold_is_the_equilibrium_on_its_other_side_but_for_the_next_order() -> None:
    first, fold = over_the_azimuth().points[0].solution, over_the_azimuth().special[0].value
    missed = []
    for beside in (4e-3, 1e-3):
        met = follow(first, azimuth=[-2.0, fold - beside, 3.0]).at(fold - beside)
        one, other = (state_of(point.problem, point.path) for point in met[:2])
        guess, back = (end_vector(state) for state in across_fold(one, Given.of(reduce_held(met[0].case))))
        apart = end_vector(other) - end_vector(one)
        missed.append(np.linalg.norm(guess - end_vector(other)) / np.linalg.norm(apart))
        assert (back - end_vector(one)) @ apart < 0  # the less likely one is on the near side
    assert missed[0] < 0.2
    assert missed[1] == pytest.approx(missed[0] / 2, rel=0.2)  # they are apart as the root of the distance to the fold


def marched(v: float, lam: float, phi: float, L: float) -> tuple[np.ndarray, np.ndarray]:
    """beta, beta_t, alpha and z at the far end, and their derivatives by v, lam and phi, (4, 3); rho = 1, mu = 0."""
    y, by, _ = march_with_variations((lam, 0.0, phi), 0.5, v, L)
    return y[:4, -1], by[:4, [1, 2, 4], -1]


def end_of(curve: FoldCurve, name: int, value: float) -> np.ndarray:
    """Where the curve ends at a value of one of its fields, which it may do once."""
    (found,) = (one for one in curve.values[[0, -1]] if abs(one[name] - value) < 1e-12)
    return np.asarray(found)


def loads(branch: Branch, number: int) -> tuple[float, float, float]:
    """beta_t(0), lam and phi at a fold."""
    folds = [point for point in branch.special if point.kind == "fold"]
    solution = branch.points[folds[number].position].solution
    rho, A = float(solution.case.rho), float(solution.case.rod.bending_stiffness)
    return float(solution.dbeta[0]) * rho, float(solution.MZ) * rho / A, float(solution.FZ) * rho**2 / A


@pytest.mark.parametrize("number", [0, 1])
def test_a_curve_with_height_and_azimuth_held_ends_where_the_marched_rod_folds(number: int) -> None:
    """At the height of the border the three numbers at the far end are met, and the determinant of their derivatives
    by the start and the two loads vanishes."""
    branch, height = over_the_azimuth(), 2.52
    curve = trace_fold(branch, number, height=(2.48, height))

    def equations(x: np.ndarray) -> np.ndarray:
        numbers, rates = marched(*x[:3], 7.0)
        wanted = np.array([0.8, x[3], height])
        return np.append(numbers[[0, 2, 3]] - wanted, np.linalg.det(rates[[0, 2, 3]]) / 1e3)

    folds = [point.value for point in branch.special if point.kind == "fold"]
    x, _, status, why = fsolve(equations, [*loads(branch, number), folds[number]], xtol=1e-13, full_output=True)
    assert status == 1, why
    assert end_of(curve, 1, height)[0] == pytest.approx(x[3], abs=1e-9)


def test_a_curve_with_a_hinge_ends_where_the_marched_rod_folds() -> None:
    """beta_t vanishes at the far end, and its derivative by that at the start."""
    branch, L = hinged(), 4.1
    curve = trace_fold(branch, L=(3.9, L))

    def equations(x: np.ndarray) -> np.ndarray:
        numbers, rates = marched(x[0], 0.0, x[1], L)
        return np.array([numbers[1], rates[1, 0]])

    v, _, phi = loads(branch, 0)
    x, _, status, why = fsolve(equations, [v, phi], xtol=1e-13, full_output=True)
    assert status == 1, why
    A = float(branch.points[0].case.rod.bending_stiffness)
    assert end_of(curve, 1, L)[0] == pytest.approx(x[1] * A, rel=1e-9)


def test_the_folds_of_a_branch_lie_on_one_curve_through_a_cusp() -> None:
    branch = over_the_azimuth()
    curves = [trace_fold(branch, number, height=(2.4, 3.2)) for number in (0, 1)]
    for curve in curves:
        assert curve.cusps.shape == (1, 2)
    assert curves[0].cusps == pytest.approx(curves[1].cusps, abs=1e-7)


def cusps_of_closed_curve(branch: Branch, number: int) -> np.ndarray:
    """The cusps (8, 2) of the curve of a fold over the azimuth and the far angle, which runs once round."""
    curve = trace_fold(branch, number, azimuth=(-6.0, 6.0), betaL=(-6.0, 7.5))
    assert curve.ends == ("closed", "closed")
    assert curve.values[0].tolist() == curve.values[-1].tolist()
    assert curve.cusps.shape == (8, 2)
    assert pdist(curve.cusps).min() > 0.1
    return np.asarray(curve.cusps[np.argsort(curve.cusps[:, 0])])


def test_a_curve_with_height_and_azimuth_held_closes() -> None:
    """Both folds of the branch lie on it."""
    first, second = (cusps_of_closed_curve(over_the_azimuth(), number) for number in (0, 1))
    assert first == pytest.approx(second, abs=1e-7)


@pytest.mark.slow
def test_a_curve_of_a_rod_with_weight_closes_as_that_without() -> None:
    """A weight of 1e-8 moves no cusp by more than 1e-6."""
    case = case_of(7.0, betaL=0.8, height=2.5, azimuth=0.5)
    rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=7.0, weight=1e-8)
    heavy = Case(rod, Cylinder(R=0.75, inclination=1.0), case.given)
    branches = over_the_azimuth(), follow(solve(heavy), azimuth=[-2.0, 3.0])
    without, with_weight = (cusps_of_closed_curve(branch, 0) for branch in branches)
    assert with_weight == pytest.approx(without, abs=1e-6)


def test_a_curve_under_dead_loads_is_that_of_the_equations_in_the_slope_at_the_start() -> None:
    case = case_of(3.0, betaL=0.8, FZ=-40.0)
    (known,) = fold_curves(case, FZ=(-60, -20), L=(1.5, 3), lattice=3).curves
    found = trace_fold(follow(solve(case), FZ=[-60.0, -20.0]), L=(1.5, 3.0))
    assert found.cusps == pytest.approx(known.cusps, rel=1e-8)
    assert sorted(found.values[[0, -1], 0]) == pytest.approx(sorted(known.values[[0, -1], 0]), rel=1e-9)
    assert (found.lower, found.ends) == (known.lower, known.ends)


@pytest.mark.slow
def test_the_numbers_of_a_map_are_those_that_the_search_and_the_branches_from_there_find() -> None:
    """The search alone misses one of two that have just met; the branch of the other one leads to it."""
    case = case_of(4.0, betaL=0.8, height=2.5, azimuth=0.5)
    folds = fold_curves(case, height=(3.2, 3.6), azimuth=(0.0, 1.0))
    assert sorted(curve.lower for curve in folds.curves) == [0, 1, 2]
    assert {end for curve in folds.curves for end in curve.ends} == {"border"}
    assert folds.remark.startswith("not proved complete: ")
    for height, azimuth, count in ((3.4, 0.5, 7), (3.55, 0.6, 3)):
        found = equilibria(folds.case_at((height, azimuth)), stations=2)
        branches = [follow(one.solution, azimuth=[0.0, azimuth, 1.0]) for one in found]
        met = {round(float(p.solution.dbeta[0]), 6): p.index for branch in branches for p in branch.at(azimuth)}
        assert sorted(folds.indices_at((height, azimuth)).elements()) == sorted(met.values())
        assert len(met) == count


def test_a_curve_under_dead_loads_goes_on_where_the_gap_to_a_saddle_is_lost_in_rounding() -> None:
    """The gap shrinks as the rod grows: at L = 21 it is 1e-9, at L = 40 far below rounding."""
    long_rod = Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0), Cylinder(R=0.75), Ends("30deg", "50deg", FZ=4.003, M3=8.0))
    branches = [follow(one.solution, FZ=[4.0, 4.06]) for one in equilibria(long_rod, stations=2)[:3]]
    (branch,) = (one for one in branches if [(p.kind, p.before) for p in one.special] == [("fold", 1)])
    curve = trace_fold(branch, L=(12.0, 40.0), FZ=(4.0, 4.06))
    assert curve.ends == ("border", "border")
    assert not curve.cusps.size
    assert end_of(curve, 1, 12.0)[0] == pytest.approx(4.006456812686697, rel=1e-12)
    FZ, counts = end_of(curve, 1, 40.0)[0], []
    for beside in (-1e-12, 1e-12):
        loads = Ends("30deg", "50deg", FZ=FZ + beside, M3=8.0)
        found = equilibria(Case(replace(long_rod.rod, L=40.0), long_rod.cylinder, loads), stations=2)
        counts.append(Counter(one.index for one in found))
    fewer, more = sorted(counts, key=Counter.total)
    assert curve.lower == 0
    assert more - fewer == Counter({0: 1, 1: 2, 2: 1})  # the fold of one more bend lies closer than rounding


# the far end, FZ, which equilibrium begins the branch, and where the curve of its first fold ends at L = 25
NEARING = {"different ends": ("50deg", -1.0, 2), "equal ends": ("30deg", 0.5, 2)}


@pytest.mark.parametrize("which", NEARING)
def test_a_curve_with_the_azimuth_held_goes_on_where_the_gap_to_a_saddle_is_lost_in_rounding(which: str) -> None:
    """It ends at the longest rod where the branch of that rod folds."""
    betaL, FZ, number = NEARING[which]

    def branch(L: float, azimuth: tuple[float, float]) -> Branch:
        rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=L)
        case = Case(rod, Cylinder(R=0.75), Ends("30deg", betaL, FZ=FZ, M3=8.0))
        return follow(equilibria(case, stations=2)[number].solution, azimuth=list(azimuth))

    curve = trace_fold(branch(10.0, (4.0, 7.9)), azimuth=(-6.0, 7.9), L=(8.0, 25.0))
    assert curve.ends == ("border", "border")
    assert (curve.lower, curve.cusps.shape) == (0, (1, 2))
    (fold,) = (point.value for point in branch(25.0, (-6.0, 8.0)).special if point.kind == "fold")
    assert end_of(curve, 1, 25.0)[0] == pytest.approx(fold, abs=1e-9)


PIPE_IN_A_HOLE = Case(
    Rod(EI=100.0, GJ=60.0, a=0.2, L=4.0), Cylinder(1.0, "inside"), Ends(M10=0.0, betaL=0.5, azimuth=0.8, FZ=-150.0)
)


def test_a_closed_curve_between_the_lines_of_a_lattice_is_found_where_branches_pass_it_closely() -> None:
    """Three cusps: two branches that would cross on a symmetric rod are a little apart, and one of them turns back."""
    plane = parameter_plane(PIPE_IN_A_HOLE, {"azimuth": (0.8, 1.4), "FZ": (-260.0, -140.0)})
    ticks = linked_folds.lattice_ticks(2)
    z = ticks[[1, 0]]
    known = equilibria(plane.case_at(z), stations=2, within={"MZ": (-60, 60), "beta0": (-2.5, 2.5)}, values=3, tries=0)
    system = system_on(plane, z)
    found = linked_folds.search_linked(plane, system, ticks, {(1, 0): [system.place_of(one) for one in known]})
    closed = next(curve for curve in found.curves if curve.ends == ("closed", "closed"))
    low, high = closed.values.min(axis=0), closed.values.max(axis=0)
    assert (closed.lower, len(closed.cusps)) == (1, 3)
    lines = plane.values(np.stack([ticks, ticks], axis=1))
    assert not ((low < lines) & (lines < high)).any()
    # where a branch over FZ turns back
    assert np.abs(closed.values - [1.2575, -213.336]).min(axis=0) == pytest.approx([0, 0], abs=0.1)


def test_a_map_of_held_ends_states_the_range_of_reactions_that_its_counts_mean() -> None:
    """It is one range for all of its points."""
    folds = region_map(case_of(4.0, betaL=0.8, height=3.4), height=(3.3, 3.4), betaL=(0.7, 0.8), lattice=2)
    ((low, high),) = folds.folds.within.values()
    assert f"; counted are equilibria that are searched with FZ from {low:.6g} to {high:.6g}" in folds.remark
    for region in folds.regions:
        assert isinstance(region.equilibria, HeldEquilibria)
        assert region.equilibria.search.within["FZ"] == pytest.approx((low, high))
    for height in (3.3, 3.4):  # the default of each point lies within
        alone = equilibria(case_of(4.0, betaL=0.8, height=height), values=2, tries=0)
        assert isinstance(alone, HeldEquilibria)
        assert low <= alone.search.within["FZ"][0]
        assert alone.search.within["FZ"][1] <= high


def test_places_where_branches_meet_without_a_curve_are_counted_in_the_remark() -> None:
    searched, branches = SimpleNamespace(curves=()), SimpleNamespace(count=3, stopped=1, whole=False)
    said = "1 of them could not be followed to the border; more were met and not followed; "
    remark = linked_folds.remark_of(searched, branches, 2, np.zeros(1))
    assert remark.endswith(f"{said}of 2 points where branches meet no curve was found")
