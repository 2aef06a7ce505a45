"""Fold curves and region maps, against an integration of the variational equations and against all equilibria."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

from solver import Case, Cylinder, Ends, Rod, equilibria, fold_curves, region_map
from solver.branches.fold_curves import FoldCurve, FoldCurves
from solver.branches.fold_tracing import point_on_line
from solver.branches.orbit_folds import UNIT, OrbitFold, OrbitPitchfork, OrbitPoint, Saddle, numbers_on
from solver.branches.parameter_plane import ParameterPlane, parameter_plane
from solver.orbits.boundary import boundary_of
from solver.orbits.level_search import census
from solver.region_map import RegionMap
from studies import load
from tests.equation import march_with_variations
from tests.slow import slow, slow_but
from workbench.branches.ends_study import ends_problem

ROD = Rod(E=1.07e4, nu=0.25, a=0.25, L=3.0)
CASE = Case(ROD, Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.8, M3=5.0))
A, RHO = ROD.bending_stiffness, CASE.rho


@cache
def small() -> RegionMap:
    """A short rod over its axial force and its length: two curves, one with a cusp."""
    return region_map(CASE, FZ=(-70, -20), L=(1.5, 3.5), lattice=3)


@cache
def straight() -> RegionMap:
    """A straight rod along the cylinder, which buckles."""
    case = Case(ROD, Cylinder(R=0.75), Ends(beta0=0.0, betaL=0.0))
    return region_map(case, FZ=(-80, -10), L=(2.0, 4.5), lattice=3)


def marched(v: float, FZ: float, L: float, case: Case = CASE) -> tuple[float, float, float]:
    """beta(L) less the given one, and its first and second derivative by beta_t(0), of a march (rho = 1)."""
    loads = 0.0, float(case.given.M3) * RHO / A, FZ * RHO**2 / A
    y, by, second = march_with_variations(loads, float(case.given.beta0), v, L / RHO, 1e-13)
    return y[0, -1] - float(case.given.betaL), by[0, 1, -1], second[-1]


@pytest.mark.slow
def test_on_a_curve_beta_and_the_jacobi_field_reach_the_far_end_as_they_must() -> None:
    for curve in small().folds.curves:
        for i in np.flatnonzero(curve.exact)[::5]:
            off, eta, _ = marched(curve.dbeta0[i] * RHO, *curve.values[i])
            assert abs(off) < 1e-9
            assert abs(eta) < 1e-6  # of the size of the next derivative times the error of beta_t(0)


def test_a_cusp_is_that_of_the_marched_equations_to_eight_digits() -> None:
    (curve,) = (one for one in small().folds.curves if one.cusps.size)
    ((FZ, L),) = curve.cusps
    x = fsolve(lambda x: marched(*x), (curve.cusp_dbeta0[0] * RHO, FZ, L), xtol=1e-11)  # the march leaves 1e-13
    np.testing.assert_allclose([FZ, L], x[1:], rtol=1e-8)
    assert curve.cusp_dbeta0[0] * RHO == pytest.approx(x[0], rel=1e-6)


def across(folds: FoldCurves, curve: FoldCurve, i: int, far: float) -> list[list[int]]:
    """The indices on the side of fewer and on the side of more equilibria of a traced point."""
    toward = curve.more[i] / np.linalg.norm(curve.more[i])
    steps = [curve.values[i] + sign * far * toward * (folds.high - folds.low) for sign in (-1, 1)]
    return [sorted(one.index for one in equilibria(folds.case_at(values), stations=2)) for values in steps]


@pytest.mark.parametrize("made", [small, slow(straight)])
def test_two_equilibria_of_neighbouring_index_appear_across_a_curve(made) -> None:
    folds = made().folds
    for curve in folds.curves:
        i = int(np.flatnonzero(curve.exact)[3])
        fewer, more = across(folds, curve, i, 1e-5)
        for index in (curve.lower, curve.lower + 1):
            assert more.count(index) - fewer.count(index) == (len(more) - len(fewer)) // 2
        assert len(more) - len(fewer) in (2, 4)  # 4 where the mirror image folds at the same point


def test_the_straight_rod_buckles_where_euler_says() -> None:
    """sqrt(-FZ/A) L = n pi, with both end angles held; each mode n is a pitchfork."""
    pitchforks = [one for one in straight().folds.curves if one.kind == "pitchfork"]
    modes = []
    for curve in pitchforks:
        FZ, L = curve.values[curve.exact].T
        modes += [int(np.rint(np.median(np.sqrt(-FZ / A) * L / np.pi)))]
        np.testing.assert_allclose(np.sqrt(-FZ / A) * L, modes[-1] * np.pi, rtol=1e-8)
        assert np.abs(curve.dbeta0).max() < 1e-7
    assert sorted(modes) == [1, 2]
    assert [curve.lower for curve in pitchforks] == [mode - 1 for mode in modes]


def test_the_numbers_of_the_map_change_across_the_first_and_the_last_piece_of_each_curve() -> None:
    folds = straight().folds
    for curve in folds.curves:
        both = 1 if curve.kind == "pitchfork" else 2  # the mirror image folds at the same point
        for i in (0, -2):
            middle = (curve.values[i] + curve.values[i + 1]) / 2
            step = 1e-4 * curve.more[i] / np.linalg.norm(curve.more[i]) * (folds.high - folds.low)
            fewer, more = (folds.indices_at(middle + sign * step) for sign in (-1, 1))
            assert more - fewer == {curve.lower: both, curve.lower + 1: both}


@cache
def atlas() -> RegionMap:
    """Fig. 7 (4): the equilibria of Table 1 over the far angle and the axial force."""
    return region_map(ends_problem(load("fig7_4_end_angle")), betaL=("-60deg", "90deg"), FZ=(4, 12), lattice=6)


@pytest.mark.parametrize(("made", "count"), [(small, 10), (straight, 10), slow(atlas, 200)])
def test_the_numbers_of_the_map_are_those_of_all_equilibria_at_random_points(made, count: int) -> None:
    assert made().remark == ""
    assert made().check(count) == []
    assert sum(one.area for one in made().regions) == pytest.approx(1, abs=1e-3)


def cusps(found: FoldCurves) -> np.ndarray:
    return np.concatenate([np.column_stack([one.cusps, one.cusp_dbeta0]) for one in found.curves])


@pytest.mark.slow
def test_the_mirror_image_has_the_same_curves() -> None:
    """beta -> -beta with lam and mu of the other sign."""
    mirror = Case(ROD, CASE.cylinder, Ends(beta0=-0.5, betaL=-0.8, M3=-5.0))
    found = fold_curves(mirror, FZ=(-70, -20), L=(1.5, 3.5), lattice=3)
    np.testing.assert_allclose(cusps(found) * [1, 1, -1], cusps(small().folds), rtol=1e-7)
    for mine, theirs in zip(small().folds.curves, found.curves, strict=True):
        assert (mine.lower, mine.kind, mine.ends) == (theirs.lower, theirs.kind, theirs.ends)


@pytest.mark.slow
def test_scaling_the_stiffness_and_the_loads_leaves_the_curves() -> None:
    stiff = Case(Rod(2 * ROD.E, 0.25, 0.25, 3.0), CASE.cylinder, Ends(0.5, 0.8, M3=10.0))
    found = fold_curves(stiff, FZ=(-140, -40), L=(1.5, 3.5), lattice=3)
    np.testing.assert_allclose(cusps(found), cusps(small().folds) * [2, 1, 1], rtol=1e-9)


# a rod of twenty radii whose stable equilibria vanish where its start has the height of a saddle: the level is 1e-6
# above it, and less
LONG = Case(Rod(1.07e4, 0.25, 0.25, 20.0), CASE.cylinder, Ends("30deg", "50deg", M3=8.0))


# beta0, betaL, about beta_t(0), the sign of the gap, log gap, and the lower index of the equilibria that meet
AT_REST = {
    "a stable one, at the start": ("30deg", "50deg", 0.0, -1.0, -17.4432, 0),
    "one more bend": ("30deg", "50deg", 6e-7, -1.0, -14.6523, 1),
    "a stable one, at the far end": ("50deg", "30deg", 0.607, -1.0, -17.4432, 0),
    "over the saddle": ("30deg", "209deg", 0.0, 1.0, -17.7515, 0),
    "over the saddle after a turning point": ("30deg", "209deg", -7e-6, 1.0, -12.2620, 1),
    "over the saddle to the far end": ("209deg", "30deg", -0.634, 1.0, -17.7515, 0),
}


def near_the_saddle(point: type[OrbitPoint], plane: ParameterPlane, sign: float, even: bool, *w: float) -> OrbitPoint:
    """The point of a curve of long rods at MZ = -0.2. w: beta_t(0) of a fold, and log gap."""
    guess = np.array([*w[:-1], w[-1] / UNIT, 0.18, 0.0])
    saddle = Saddle(2.65, sign, even)
    found = point_on_line(point(numbers_at=numbers_on(plane), scales=np.ones(1), saddle=saddle, w=guess), 0)
    assert found is not None
    return found


def long_plane(beta0: str, betaL: str, L: float = 20.0) -> ParameterPlane:
    case = Case(replace(LONG.rod, L=L), LONG.cylinder, Ends(beta0, betaL, M3=8.0))
    return parameter_plane(case, {"FZ": (4.0, 4.06), "MZ": (-0.2, 0.2)})


@pytest.mark.parametrize("which", AT_REST)
def test_a_fold_next_to_a_separatrix_is_exact(which: str) -> None:
    """Two equilibria more within 1e-8 of the ranges on one side, of the indices that the path of the rod tells."""
    beta0, betaL, slope, sign, log_gap, lower = AT_REST[which]
    plane = long_plane(beta0, betaL)
    point = near_the_saddle(OrbitFold, plane, sign, False, slope, log_gap + 0.01)
    assert point.w[1] * UNIT == pytest.approx(log_gap, abs=1e-4)
    toward = 1e-8 * point.more / np.linalg.norm(point.more)
    fewer, more = (census(plane.problems(point.z + sign * toward)).indices for sign in (-1, 1))
    assert more - fewer == {lower: 1, lower + 1: 1}
    assert point.lower == lower


@pytest.mark.parametrize("which", AT_REST)
@pytest.mark.parametrize("L", [40.0, 200.0, 700.0])
def test_a_fold_is_exact_where_no_float_holds_the_gap(which: str, L: float) -> None:
    """Each unit of length of the saddle takes the same from log gap, and moves the fold no more."""
    beta0, betaL, slope, sign, log_gap, lower = AT_REST[which]
    per_length = (-217.79525833640 + 39.70452255086) / 160  # at the saddle, r times 2
    guess = log_gap + per_length * (L - 20)
    point = near_the_saddle(
        OrbitFold, long_plane(beta0, betaL, L), sign, False, slope if abs(slope) > 0.1 else 0.0, guess
    )
    assert point.w[1] * UNIT == pytest.approx(guess, abs=1e-3)
    assert point.lower == lower
    assert point.z[0] == pytest.approx(long_limit(beta0, betaL), abs=1e-9)


@cache
def long_limit(beta0: str, betaL: str) -> float:
    """FZ, as a share of its range, at which an end has the height of the saddle, as it has for an endless rod."""
    plane = long_plane(beta0, betaL)
    angle = np.deg2rad(30.0)

    def fall(share: float) -> float:
        place = boundary_of(plane.problems(np.array([share, 0.0])))
        return place.fall(float(place.saddles[np.abs(place.saddles - 2.65).argmin()]), angle)

    return float(brentq(fall, 0.0, 1.0, xtol=1e-14))


@pytest.mark.parametrize(("point", "w", "lower"), [(OrbitFold, (0.0,), 0), (OrbitPitchfork, (), 1)])
def test_with_equal_ends_a_fold_and_a_pitchfork_lie_next_to_a_separatrix(point, w, lower) -> None:
    """They are closer than 1e-8 of the ranges: both are crossed."""
    plane = long_plane("30deg", "30deg")
    point = near_the_saddle(point, plane, -1.0, True, *w, -17.0)
    toward = 1e-8 * point.more / np.linalg.norm(point.more)
    fewer, more = (census(plane.problems(point.z + sign * toward)).indices for sign in (-1, 1))
    assert more - fewer == {0: 1, 1: 2, 2: 1}
    assert point.lower == lower


# the level of a fold nears that of a saddle as L grows: the end at a turning point, ranges of FZ and L, and the curves
NEARING = {
    "the start": ("30deg", "50deg", (3.996, 4.2), (6, 12), [("fold", 0)]),
    "the far end": ("50deg", "30deg", (3.996, 4.2), (6, 12), [("fold", 0)]),
    "both ends": ("30deg", "30deg", (4.0052, 4.01), (12.2, 13), [("fold", 0), ("pitchfork", 1)]),
}


@cache
def nearing(end: str) -> FoldCurves:
    beta0, betaL, FZ, L, _ = NEARING[end]
    return fold_curves(Case(LONG.rod, LONG.cylinder, Ends(beta0, betaL, M3=8.0)), lattice=2, FZ=FZ, L=L)


@pytest.mark.slow
@pytest.mark.parametrize("end", NEARING)
def test_a_curve_is_whole_and_exact_where_it_comes_next_to_a_separatrix(end: str) -> None:
    folds = nearing(end)
    assert folds.remark == ""
    assert sorted((curve.kind, curve.lower) for curve in folds.curves) == NEARING[end][4]
    for curve in folds.curves:
        assert curve.ends == ("border", "border")
        for i in np.flatnonzero(curve.exact)[::3]:
            off, eta, _ = marched(curve.dbeta0[i] * RHO, *curve.values[i], folds.case)
            assert abs(off) < 1e-6  # next to the separatrix: the square of the gap
            assert abs(eta) < 1e-3  # of the size of the next derivative times the error of beta_t(0)


# a long rod, the end angles, and the lower indices of its folds and pitchforks
FAR_BELOW_ROUNDING = {
    "the start": (40.0, "30deg", "50deg", [0, 1, 1, 2, 2, 3, 4, 5], []),
    "the far end": (40.0, "50deg", "30deg", [0, 1, 1, 2, 2, 3, 4, 5], []),
    "both ends": (30.0, "30deg", "30deg", [0, 2, 2], [1, 1, 3]),
    "a longer rod": (60.0, "30deg", "50deg", [0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 6, 7, 8, 9], []),
}


@pytest.mark.parametrize("which", slow_but(FAR_BELOW_ROUNDING, "the start"))
def test_all_curves_are_met_by_the_search_where_no_float_holds_the_gap(which: str) -> None:
    """From few points: without a good first log gap each line is halved some twenty times for each curve."""
    L, beta0, betaL, folds, pitchforks = FAR_BELOW_ROUNDING[which]
    case = Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=L), LONG.cylinder, Ends(beta0, betaL, M3=8.0))
    met = fold_curves(case, lattice=2, FZ=(4.0, 4.06), MZ=(-0.2, 0.2))
    assert met.remark == ""
    assert all(curve.ends == ("border", "border") for curve in met.curves)
    for kind, lower in (("fold", folds), ("pitchfork", pitchforks)):
        assert sorted(curve.lower for curve in met.curves if curve.kind == kind) == lower
    assert len(met.searched.counted) < 100


@pytest.mark.slow
@pytest.mark.parametrize("end", NEARING)
def test_the_equilibria_that_meet_next_to_a_separatrix_have_the_indices_of_the_curve(end: str) -> None:
    folds = nearing(end)
    for curve in folds.curves:
        at = np.flatnonzero(curve.exact)
        fewer, more = across(folds, curve, int(at[np.abs(curve.values[at, 1] - 12.0).argmin()]), 1e-6)
        # at a pitchfork two equilibria of one index take the place of one of the next, or the other way round
        assert sorted([*fewer, curve.lower, curve.lower + 1]) == more


@pytest.mark.slow
@pytest.mark.parametrize(
    ("FZ", "MZ", "lower"), [((4.0, 4.06), (-0.2, 0.2), [0, 1, 2]), ((3.9, 4.2), (-2, 2), [0, 1, 1, 2, 2, 3])]
)
def test_folds_next_to_a_separatrix_and_far_from_it_are_exact(FZ, MZ, lower) -> None:
    """Two equilibria more on one side of each curve than on the other, 1e-8 of the ranges away."""
    folds = fold_curves(LONG, lattice=2, FZ=FZ, MZ=MZ)
    assert folds.remark == ""
    assert sorted((curve.kind, curve.lower) for curve in folds.curves) == [("fold", index) for index in lower]
    for curve in folds.curves:
        fewer, more = across(folds, curve, int(np.flatnonzero(curve.exact)[curve.exact.sum() // 2]), 1e-8)
        assert sorted([*fewer, curve.lower, curve.lower + 1]) == more


@pytest.mark.slow
def test_the_atlas_has_the_folds_that_its_branches_end_in() -> None:
    """24.49, 35.34 and 49.90 degrees at Table 1's own force, found by joining equilibria to branches."""
    folds = atlas().folds
    FZ, found = 10 * np.cos(np.pi / 6), []
    for curve in folds.curves:
        betaL, force = curve.values.T
        for i in np.flatnonzero((force[:-1] - FZ) * (force[1:] - FZ) < 0):
            share = (FZ - force[i]) / (force[i + 1] - force[i])
            found.append(np.rad2deg(betaL[i] + share * (betaL[i + 1] - betaL[i])))
    inside = sorted(one for one in found if -20 < one < 60)
    np.testing.assert_allclose(inside, [24.49, 35.34, 49.90], atol=0.01)
    assert {one.count for one in atlas().regions} == {9, 11, 13, 15}


def test_a_range_may_end_where_the_values_become_invalid() -> None:
    tube = Case(Rod(1.07e4, 0.25, 0.25, 3.0, inner_radius=0.1), CASE.cylinder, Ends(0.5, 0.8, FZ=-50))
    plane = parameter_plane(tube, {"inner_radius": (0.0, 0.2), "L": (1.5, 3.5)})
    assert plane.values(np.array([-1e-5, 0.5])).tolist() == [0.0, 2.5]


@pytest.mark.slow
@pytest.mark.parametrize("field, cusps", [("betaL", 1), ("M3", 3)])
def test_no_pitchfork_line_goes_where_a_field_breaks_the_symmetry(field, cusps) -> None:
    """The straight rod buckles at FZ = -1.8986 and exists at betaL = M3 = 0 only: there folds meet in a cusp."""
    case = Case(Rod(EI=1.0, GJ=0.8, a=0.2, L=2.28), Cylinder(1.2, side="inside"), Ends(beta0=0.0, betaL=0.0))
    found = region_map(case, stations=2, FZ=(-3.0, 3.0), **{field: (-1.2, 1.2)})
    assert {curve.kind for curve in found.folds.curves} == {"fold"}
    assert sum(len(curve.cusps) for curve in found.folds.curves) == cusps
    assert not found.remark
    assert not found.check(60)


STRIPS = {
    "EI": (
        Case(Rod(EI=1.0, GJ=1.7052953818, a=0.2, L=3.7419063113), Cylinder(0.8), Ends(-0.4170023, -0.4170023)),
        {"FZ": (-9.2066, 3.5832), "EI": (1.4921, 2.9843)},
        [((-1.97 * 2.8, 2.8), 3), ((-1.96 * 2.8, 2.8), 5), ((-1.95 * 2.8, 2.8), 3)],
    ),
    "R": (
        Case(Rod(EI=1.0, GJ=1.2686566719, a=0.2, L=3.9938316568), Cylinder(0.8),
             Ends(0.0035581283, 0.0035581283, MZ=0.4052525276, M3=-0.8041990176)),
        {"FZ": (-6.0812, 3.0533), "R": (0.9, 1.6)},
        [((-1.62, 0.9), 3), ((-1.56, 0.9), 5), ((-1.48, 0.9), 3)],
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", STRIPS)
def test_a_strip_between_two_folds_that_undo_each_other_is_seen(name) -> None:
    """It has 5 equilibria; on both sides there are 3, one of them another."""
    case, ranges, points = STRIPS[name]
    folds = fold_curves(case, **ranges)
    for values, count in points:
        assert sum(folds.indices_at(values).values()) == count == len(equilibria(folds.case_at(values), stations=2))


@pytest.mark.slow
def test_a_pitchfork_line_changes_its_side_where_a_fold_curve_ends_on_it() -> None:
    """Under MZ a rod that begins and ends at rest still equals its reversal; d^3B/dv^3 vanishes at four points."""
    rod = Rod(EI=1.0, GJ=1.2669913292215425, a=0.2, L=4.916852969976965)
    case = Case(rod, Cylinder(0.8), Ends(beta0=0.0, betaL=0.0))
    found = region_map(case, stations=2, FZ=(-7.3533, -0.1020), MZ=(-1.5, 1.5))
    assert not found.remark
    assert not found.check(100)
