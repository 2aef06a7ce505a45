"""A followed branch is one curve of equilibria: its folds are exact, it leads back, and it never jumps to another."""

import sys
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from solver import Branch, Case, Cylinder, Ends, Rod, Solution, equilibria, follow, solve
from solver.branches.branch_events import Bounds, Place, events_between
from solver.branches.branch_following import branch_through
from solver.branches.branch_states import begin_at, in_other_charts
from solver.branches.family import family_of
from solver.equilibria import Equilibrium
from solver.follow import _path, solutions_of
from solver.numerics.arclength import BRANCH_POINT, FOLD, PITCHFORK
from solver.orbits.path_orbits import orbit_of
from solver.orbits.periodic_orbit import jacobi_zeros
from solver.problem.case_fields import with_field
from solver.problem.dimensionless import reduce
from solver.solve import between_ends
from tests.cases import TABLE_1, ends_in_units_of_rho, rod_of_unit_stiffness
from tests.equation import far_angle

END = "the end of the range"


@cache
def table_1() -> Solution:
    return solve(TABLE_1["force-first/tension/paper"].case, tol=1e-12)


@cache
def table_1_ends() -> Case:
    case = table_1().case
    return Case(case.rod, case.cylinder, Ends(case.given.beta, float(table_1().beta[-1]), *case.loads))


@cache
def every() -> list[Equilibrium]:
    return list(equilibria(table_1_ends()))


def test_whole_turns_of_both_ends_change_no_branch() -> None:
    """Nor beyond a million radians, where sines are those of the machine's library."""
    branches = []
    for turns in (0.0, 2 * np.pi * 400_000):
        ends = Ends(beta0=0.5 + turns, betaL=0.8 + turns, FZ=-8.66)
        unstable = equilibria(Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75), ends))[-1].solution
        branches.append(follow(unstable, FZ=-4.0))
    plain, turned = branches
    assert [point.kind for point in turned.special] == [point.kind for point in plain.special] == ["fold"]
    assert turned.special[0].value == pytest.approx(plain.special[0].value, rel=1e-7)


def test_the_fold_of_table_1_is_the_largest_beta_at_the_end_over_the_slope_at_the_start() -> None:
    branch = follow(table_1(), betaL=1.0)
    (fold,) = branch.special
    near = branch.points[fold.position].solution.dbeta[0]
    best = minimize_scalar(
        lambda slope: -far_angle(table_1_ends(), slope), bounds=(near - 0.01, near + 0.01), method="bounded",
        options={"xatol": 1e-7},
    )  # fmt: skip
    assert fold.kind == "fold"
    assert fold.value == pytest.approx(-best.fun, abs=1e-8)
    assert near == pytest.approx(best.x, abs=1e-5)
    assert {fold.before, fold.after} == {5, 6}
    assert branch.end.reason == END
    assert branch.values[-1] == branch.values[0]


def test_a_branch_reaches_the_ends_of_its_range_through_values_a_little_beyond() -> None:
    ends = Ends(beta0=-0.18635438063, betaL=-0.38175329073, FZ=-1.738266398496882, M3=-1.361106708564987)
    case = Case(Rod(E=325.949323452, nu=0.25, a=0.25, L=5.310689087464453), Cylinder(R=0.75), ends)
    branch = follow(solve(case), FZ=[-3.738266398496882, 0.261733601503118])
    assert branch.begin.reason == branch.end.reason == END


def test_two_equilibria_merge_at_a_fold_and_none_is_left_beyond_it() -> None:
    (fold,) = follow(table_1(), FZ=4.0).special
    counts = [len(equilibria(with_field(table_1_ends(), "FZ", fold.value + off))) for off in (1e-4, -1e-4)]
    assert counts[0] - counts[1] == 2


@pytest.mark.parametrize("short", [1e-3, 1e-7, 1e-11])
def test_a_branch_ends_at_its_border_though_it_folds_next_to_it(short: float) -> None:
    (fold,) = follow(table_1(), FZ=4.0).special
    border = fold.value + short * np.sign(table_1().case.loads[0] - fold.value)
    branch = follow(table_1(), FZ=border)
    assert branch.values[-1] == branch.end.value == border
    assert (branch.end.reason, branch.special) == (END, ())


@pytest.mark.parametrize("L", [10.0, 31.0])
def test_a_straight_pipe_buckles_at_eulers_loads(L: float) -> None:
    """About beta = 0 without torque eta'' - phi eta = 0: sin(r L) = 0 at -phi = (n pi/L)^2."""
    pipe = Case(rod_of_unit_stiffness(L, 0.01), Cylinder(1 - 0.01), Ends(0.0, 0.0, FZ=1.0))
    branch = follow(solve(pipe), FZ=-3.0)
    loads = [-((n * np.pi / L) ** 2) for n in range(1, len(branch.special) + 1)]
    np.testing.assert_allclose([one.value for one in branch.special], loads, rtol=1e-12)
    assert -(((len(loads) + 1) * np.pi / L) ** 2) < -3.0
    assert [(one.kind, one.before, one.after) for one in branch.special] == [
        ("pitchfork", n, n + 1) for n in range(len(loads))
    ]
    assert branch.index[-1] == len(loads)


def test_a_buckled_branch_passes_the_pitchfork_to_its_mirror_image() -> None:
    """Below Euler's load only the straight rod is left, so the branch turns there and returns as its mirror image."""
    first = -((np.pi / 10) ** 2)
    pipe = Case(rod_of_unit_stiffness(10.0, 0.01), Cylinder(1 - 0.01), Ends(0.0, 0.0, FZ=1.3 * first))
    buckled = next(one for one in equilibria(pipe) if one.index == 0)
    branch = follow(buckled.solution, FZ=0.5 * first)
    (turn,) = branch.special
    assert turn.kind == "pitchfork"
    assert turn.value == pytest.approx(first, rel=1e-9)
    np.testing.assert_allclose(branch.points[-1].solution.beta, -buckled.solution.beta, atol=1e-9)


def test_a_rod_between_opposite_angles_branches_where_both_its_ends_are_turning_points() -> None:
    """-0.5 to 0.5 rad with H odd: the rod with beta(s) = -beta(L - s) loses two others there, which are not so."""
    case = ends_in_units_of_rho(0.0, 0.0, -3.0, 5.0, -0.5, 0.5)
    odd = next(one for one in equilibria(case) if one.index == 1 and one.dbeta0 < 0)
    branch = follow(odd.solution, FZ=-0.2)
    assert branch.end.reason == END
    assert [point.kind for point in branch.special] == ["fold", "fold", "pitchfork"]
    pitchfork = branch.special[-1]
    there = with_field(case, "FZ", pitchfork.value)
    assert far_angle(there, 0.0) == pytest.approx(0.5, abs=1e-9)
    counts = [len(equilibria(with_field(case, "FZ", pitchfork.value + change))) for change in (-1e-6, 1e-6)]
    assert sorted(np.abs(np.diff(counts))) == [2]


def test_values_that_are_asked_for_are_points_and_both_directions_are_followed() -> None:
    wanted = [12.0, 10.5, 6.0]
    branch = follow(table_1(), FZ=wanted)
    assert 0 < branch.start < len(branch) - 1
    assert branch.values[branch.start] == float(table_1_ends().given.FZ)
    assert {*wanted} <= {*branch.values}
    assert {branch.begin.value, branch.end.value} == {6.0, 12.0}
    assert len(branch.at(10.5)) == 1


def is_curve_of_equilibria(branch: Branch) -> bool:
    """Whether each point meets its ends and has the index of its Jacobi field, and neighbours are near."""
    special = {one.position for one in branch.special}
    last = None
    for i, point in enumerate(branch.points):
        problem = reduce(point.case)
        orbit = orbit_of(problem, point.path)
        t = problem.span[:, None] * np.linspace(0, 1, 101)
        beta = orbit.at(t)[0][0]
        ends = abs(beta[0] - problem.beta0[0]) < 1e-9 and abs(beta[-1] - problem.betaL[0]) < 1e-6
        if not ends or (i not in special and jacobi_zeros(orbit)[0] != point.index):
            return False
        if last is not None and np.abs(beta - last).mean() > 0.5:
            return False
        last = beta
    return True


def followed_in_steps(one: Equilibrium, field: str, last: float, count: int) -> Branch:
    own = float(getattr(table_1_ends().given, field))
    branch = follow(one.solution, **{field: np.linspace(own, last, count + 1)})
    assert branch.end.reason == END
    assert is_curve_of_equilibria(branch)
    return branch


@pytest.mark.parametrize("which", [3, 11])
def test_equilibria_of_table_1_are_followed_under_a_falling_load(which: int) -> None:
    branch = followed_in_steps(every()[which], "FZ", 6.0, 5)
    assert (branch.values[-1] == 6.0) == (which == 3)


@pytest.mark.slow
def test_all_equilibria_of_table_1_are_followed_under_a_falling_load_and_are_those_found_there() -> None:
    branches = [followed_in_steps(one, "FZ", 2.0, 100) for one in every()]
    there = equilibria(with_field(table_1_ends(), "FZ", 2.0))
    arrived = [branch.points[-1] for branch in branches if branch.values[-1] == 2.0]
    assert len(arrived) == 11  # the other two meet in a fold
    assert len({place(point.solution, there) for point in arrived}) == 11
    turned = [branch for branch in branches if branch.values[-1] != 2.0]
    assert turned[0].special[0].value == pytest.approx(turned[1].special[0].value, abs=1e-10)


def place(sol: Solution, among: list[Equilibrium]) -> int | None:
    """Which of the equilibria this is; None if it is none of them."""
    apart = [float(np.abs(one.solution.beta - sol.beta).max()) for one in among]
    return int(np.argmin(apart)) if min(apart) < 1e-6 else None


def random_problem(rng: np.random.Generator) -> tuple[Case, str, float]:
    """A problem, a field, and its value after a perturbation; some have symmetries."""
    numbers = [*rng.normal(0, 0.6, 3), rng.uniform(5, 25), *rng.uniform(-2, 2, 2)]
    kind = rng.random()
    if kind < 0.15:
        numbers[5] = numbers[4]
    elif kind < 0.25:
        numbers[:2], numbers[5] = [0.0, 0.0], -numbers[4]
    case = ends_in_units_of_rho(*numbers)
    field = str(rng.choice(["FZ", "MZ", "M3", "L", "betaL", "beta0", "R"]))
    own = next(float(getattr(part, field)) for part in (case.rod, case.cylinder, case.given) if hasattr(part, field))
    return case, field, own * (1 + 0.02 * rng.normal()) if field in ("L", "R") else own + 0.1 * rng.normal()


@pytest.mark.parametrize("count, seed", [(10, 3), pytest.param(500, 4, marks=pytest.mark.slow)])
def test_branches_pair_the_equilibria_before_and_after_a_perturbation(count: int, seed: int) -> None:
    """Each ends at another one after it, or, through folds, at one before it, whose own branch then leads back.

    Where `equilibria` misses a pair after the perturbation, following it back must lead to the first.
    """
    rng, done = np.random.default_rng(seed), 0
    while done < count:
        case, field, value = random_problem(rng)
        before, after = list(equilibria(case)), list(equilibria(with_field(case, field, value)))
        ends: dict[int, tuple[str, int]] = {}
        for i, one in enumerate(before):
            branch = follow(one.solution, **{field: value})
            assert branch.end.reason == END
            done += 1
            last = branch.points[-1]
            there = last.value == value
            found = place(last.solution, after if there else before)
            if found is None:
                own = branch.points[0].value
                back = follow(last.solution, **{field: own})
                assert there
                assert place(back.points[-1].solution, before) == i
                continue
            assert (after if there else before)[found].index == last.index
            ends[i] = ("after" if there else "before", found)
        assert len(set(ends.values())) == len(ends)
        assert all(ends[j] == ("before", i) for i, (side, j) in ends.items() if side == "before")


def test_a_field_without_an_effect_on_the_shape_has_a_straight_branch() -> None:
    branch = follow(table_1(), nu=[0.1, 0.4])
    assert not branch.special
    shapes = [branch.points[i].solution.beta for i in (0, -1)]
    np.testing.assert_allclose(*shapes, atol=1e-9)


def test_it_stops_at_the_limit_of_points_and_keeps_what_it_has() -> None:
    branch = follow(table_1(), FZ=[4.0, 12.0], points=3)
    assert len(branch) == 7
    assert branch.begin.reason == branch.end.reason == "the limit of 3 points"


def test_a_branch_is_a_dataset() -> None:
    pytest.importorskip("xarray")
    branch = follow(table_1(), FZ=4.0)
    ds = branch.to_dataset(stations=51, length="cm", force="N")
    assert ds.sizes == {"point": len(branch), "u": 51}
    np.testing.assert_array_equal(ds["FZ"], branch.values)
    np.testing.assert_array_equal(ds["index"], branch.index)
    assert ds["FZ"].attrs["units"] == "N"
    assert [str(kind) for kind in ds["special"].values if kind] == ["fold"]
    own = next(one for one in every() if one.index == 6)
    assert float(ds["energy"][0]) == pytest.approx(own.energy, rel=1e-9)


def test_a_rod_that_leaves_its_helix_is_followed_next_to_it() -> None:
    pulled = Case(rod_of_unit_stiffness(10.0, 0.01), Cylinder(1 - 0.01), Ends(0.0, 0.0, FZ=1.0))
    branch = follow(solve(pulled), betaL=0.3)
    assert branch.end.reason == END
    alone = equilibria(with_field(pulled, "betaL", 0.3))
    assert place(branch.points[-1].solution, alone) == 0


def test_a_branch_passes_a_helix_without_a_fold() -> None:
    """Both ends at 0.1 rad: at -phi = 2 sin^2 cos the rod is a helix, and its level has no logarithm."""
    case = ends_in_units_of_rho(0.0, 0.0, 1.0, 8.0, 0.1, 0.1)
    straight = next(one for one in equilibria(case) if one.index == 0 and abs(one.dbeta0) < 0.2)
    branch = follow(straight.solution, FZ=-0.05)
    assert branch.end.reason == END
    assert not branch.special
    assert len(branch) < 120


def test_a_branch_arrives_at_the_pitchfork_at_which_its_range_ends() -> None:
    """A range of 1e-4 of Euler's load that ends there: leaps of a fixed share of the way would never arrive."""
    first = -((np.pi / 10) ** 2)
    pipe = Case(rod_of_unit_stiffness(10.0, 0.01), Cylinder(1 - 0.01), Ends(0.0, 0.0, FZ=(1 + 1e-4) * first))
    buckled = next(one for one in equilibria(pipe) if one.index == 0)
    branch = follow(buckled.solution, FZ=first)
    assert len(branch.points) < 200  # were 1001
    assert branch.end.reason == END
    assert branch.values[-1] == first


def test_another_coordinate_keeps_the_direction_in_which_a_branch_nears_a_pitchfork() -> None:
    """beta'(0) falls towards 0 and so does its log; behind the pitchfork the log rises again, with the mirror image."""
    first, excess = -((np.pi / 10) ** 2), 1e-8
    pipe = Case(rod_of_unit_stiffness(10.0, 0.01), Cylinder(1 - 0.01), Ends(0.0, 0.0, FZ=(1 + excess) * first))
    buckled = next(one for one in equilibria(pipe) if one.index == 0).solution
    family = family_of(pipe, "FZ", between_ends(buckled), Bounds(2 * first, first, (), 100))
    count = 0
    for share in np.geomspace(1e-5, 1e-3, 100):  # where the rate of FZ along the branch is rounding
        path = replace(_path(buckled), y=_path(buckled).y + float(np.log(share)))
        state = begin_at(family, path, (1 + share * excess) * first, rises=True)
        assert not isinstance(state, str)
        others = [other for other in in_other_charts(state) if other.curve.chart.logarithmic]
        assert state.x * state.node.tangent[0] < 0
        assert all(other.node.tangent[0] < 0 for other in others)
        count += len(others)
    assert count > 50


def wire_between_saddles() -> list[Equilibrium]:
    """The equilibria of a wire in a tube beside the load at which its helices of +-54.74 degrees cease to exist."""
    wire, tube = Rod(E=2.1e5, nu=0.3, a=0.25, L=120.0), Cylinder(2.0, side="inside")
    return list(equilibria(Case(wire, tube, Ends(0.0, 0.0, FZ=-160.0))))


@pytest.mark.parametrize("index", [0, 1])
def test_the_branch_of_a_wire_passes_its_fold_whatever_other_loads_it_is_asked_for(index) -> None:
    """Leaps led 4e-8 N from the fold, where the derivative over a longer change of FZ has the other sign."""
    wire = next(one for one in wire_between_saddles() if one.index == index and abs(one.dbeta0 + 0.25496) < 1e-4)
    for loads in ((-170.0, -150.0), np.linspace(-170.0, -150.0, 61), np.linspace(-163.0, -150.0, 14)):
        branch = follow(wire.solution, FZ=loads)
        assert (branch.begin.reason, branch.end.reason) == (END, END)
        assert [(point.kind, round(point.value, 6)) for point in branch.special] == [(FOLD, -161.962031)]


@pytest.mark.parametrize("index", [2, 3])
def test_the_branch_of_a_wire_passes_the_load_at_which_its_helices_cease_to_exist(index) -> None:
    """With ends along the axis -beta is an equilibrium too, and the branch of a rod that meets it is its own image.

    The first ran out of points in leaps that became ever shorter before the next value; the second went to and fro
    between two saddles of the same height at a wanted value.
    """
    start = next(one for one in wire_between_saddles() if one.index == index and one.dbeta0 > 0.9)
    branch = follow(start.solution, FZ=np.linspace(-200, 0, 61))
    assert branch.begin.reason == branch.end.reason == END
    assert [point.kind for point in branch.special] == ["fold", "fold", "pitchfork", "fold", "fold"]
    folds = [point.value for point in branch.special]
    np.testing.assert_allclose(folds, folds[::-1], rtol=1e-9)
    assert len(branch) < 800  # were 1014, to -162.4, and 200, to -150
    assert not (np.diff(branch.values) == 0).any()


def test_the_shapes_of_all_points_in_one_call_are_those_of_each_to_the_last_bit() -> None:
    """More points than are computed together, of orbits that rest at saddles, of a helix, and with a held end."""
    straight = Case(rod_of_unit_stiffness(10.0, 0.01), Cylinder(1 - 0.01), Ends(0.0, 0.0, FZ=1.0))
    held = Case(Rod(E=325.95, nu=0.25, a=0.25, L=12.0), Cylinder(R=0.75), Ends(beta0=0.5, betaL=0.5, FZ=-0.5))
    deep = next(one for one in wire_between_saddles() if one.index == 0)
    branches = [
        follow(solve(straight), FZ=-0.4),
        follow(equilibria(held)[0].solution, height=[-10.8, 10.8]),
        follow(deep.solution, FZ=np.linspace(-170, -100, 301)),
    ]
    assert {point.index for point in branches[1].points} == {0, 1}  # through folds
    assert len(branches[2]) > 300
    for branch in branches:
        every = solutions_of(branch, 31)
        for i in {*range(0, len(branch), 37), len(branch) - 1}:
            one = solutions_of(replace(branch, points=branch.points[i : i + 1]), 31)
            for name in ("beta", "alpha", "z", "error", "condition", "solved", "outcome", "held_index"):
                np.testing.assert_array_equal(getattr(every, name)[i], getattr(one, name)[0], err_msg=name)


def slight_wire(L: float) -> tuple[Branch, float]:
    """The branch of a wire in a tube that buckles slightly, to where its helix ceases to exist, and that load.

    A helix inside without torque has -FZ rho^2/A = 2 sin^2 cos <= 4/3^(3/2), at cos = 1/sqrt(3).
    """
    wire, tube = Rod(E=60e9, nu=0.3, a=0.25e-3, L=L), Cylinder(2e-3, side="inside")
    limit = -4 / 3**1.5 * float(wire.bending_stiffness) / (2e-3 - 0.25e-3) ** 2
    return follow(solve(Case(wire, tube, Ends(0.0, 0.0, FZ=-20.0))), FZ=-60.0), limit


def test_a_wire_in_a_tube_turns_back_beside_the_load_at_which_its_helix_ceases_to_exist() -> None:
    """Its fold lies 1e-4 beyond, where differences by the level must resolve what is left of the saddle."""
    branch, limit = slight_wire(0.12)
    (fold,) = branch.special
    assert (fold.kind, fold.before, fold.after) == ("fold", 0, 1)
    assert 0 < fold.value / limit - 1 < 2e-4
    assert branch.end.kind == "border of the range"


def test_a_wire_is_followed_to_where_its_helix_ceases_to_exist_if_no_float_lies_between_that_and_its_fold() -> None:
    branch, limit = slight_wire(0.8)
    assert branch.end.kind == "helix ceases"
    assert branch.end.value == pytest.approx(limit, rel=1e-9)
    assert branch.end.reason == (
        f"the helix of beta = 54.74 deg, along which the rod lies, ceases to exist at FZ = {limit:.10g}"
    )
    assert [(one.kind, one.position) for one in branch.special] == [("helix ceases", len(branch) - 1)]


@pytest.mark.slow
def test_branches_beside_that_helix_reach_their_folds_whatever_values_they_pass() -> None:
    """They went on in short leaps, and a sentence told to choose a range that ended 14 N away."""
    wire, tube = Rod(E=60e9, nu=0.3, a=0.25e-3, L=0.12), Cylinder(2e-3, side="inside")
    for one in equilibria(Case(wire, tube, Ends(0.0, 0.0, FZ=-45.0))):
        if one.index == 6 and 0 < one.dbeta0 < 260:
            branch = follow(one.solution, FZ=np.linspace(-60, -45, 61))
            assert branch.end.kind == "border of the range"
            assert [point.kind for point in branch.special] == ["fold"]


@dataclass(frozen=True)
class Passing:
    """A point of a made-up branch."""

    p: float
    rises: float
    index: int | None

    def record(self, kind: str = "") -> Place:
        return Place(self.p, None, None, self.index, kind)


@pytest.mark.parametrize(("after", "kind", "expected"), [
    (Passing(1.0, 1.0, 3), PITCHFORK, ""),  # the index is the same, and p goes on
    (Passing(1.0, 1.0, 4), PITCHFORK, PITCHFORK),
    (Passing(1.0, 1.0, None), PITCHFORK, PITCHFORK),  # not decided
    (Passing(1.0, 1.0, 3), BRANCH_POINT, ""),
    (Passing(0.0, -1.0, 3), PITCHFORK, PITCHFORK),  # p turns back, as on the branch of the pair that splits off
    (Passing(0.0, -1.0, 4), FOLD, FOLD),
])  # fmt: skip
def test_a_pitchfork_changes_the_index_or_turns_back_or_it_is_none(after: Passing, kind: str, expected: str) -> None:
    before, middle, bounds = Passing(0.0, 1.0, 3), Passing(0.5, 0.0, None), Bounds(-1.0, 2.0, (), 10)
    places = events_between(before, after, [(middle, kind)], bounds, lambda *_: None)
    assert places is not None
    assert "".join(place.kind for place in places) == expected


def resting_rod(beta0: Any, betaL: Any, E: float = 1e5) -> Solution:
    """A wire pushed into a tube, which rests near the angle of a helix, 12.5 deg at E = 1e5, on most of its length."""
    wire = Rod(E=E, nu=0.3, a=0.25, L=120.0)
    return solve(Case(wire, Cylinder(R=1.0, side="inside"), Ends(beta0, betaL, FZ=-50.0)))


@pytest.mark.parametrize("start", [True, False])
def test_a_branch_passes_the_value_at_which_an_end_is_at_the_angle_where_the_rod_rests(start: bool) -> None:
    """As E grows that angle falls below 10 deg: the level passes that of the saddle, and the rod loses a turning point.

    A level below the saddle between the two ends was taken for an orbit that joins them: 65 of 107 points were none.
    """
    branches = list[Branch]()
    for beta in ("-10deg", "10deg"):
        ends: tuple[Any, Any] = (beta, 0.0) if start else (0.0, beta)
        branch = follow(resting_rod(*ends), E=np.linspace(1e5, 2.1e5, 5))
        assert branch.end.reason == END
        assert not branch.special
        for point in branch.points:
            assert point.solution.outcome == "solved"
        for E in np.linspace(1e5, 2.1e5, 5):
            (point,) = branch.at(E)
            np.testing.assert_allclose(point.solution.beta, resting_rod(*ends, E=E).beta, atol=1e-8)
        branches.append(branch)
    negative, positive = branches
    assert len(negative) == len(positive) < 80
    np.testing.assert_allclose(negative.values, positive.values, rtol=1e-6)


@pytest.mark.parametrize("beta0", ["-10deg", "10deg"])
def test_a_seed_is_carried_past_the_angle_where_the_rod_rests(beta0: str) -> None:
    case = resting_rod(beta0, 0.0, E=2.1e5).case
    reached = solve(case, seed=resting_rod(beta0, 0.0))
    assert reached.outcome == "solved"
    np.testing.assert_allclose(reached.beta, solve(case).beta, atol=1e-8)


def follow_spoiled(monkeypatch: pytest.MonkeyPatch, spoil: slice) -> tuple[Branch, Branch]:
    """A branch, and the same one of which these places are no equilibria, in steps of the core or of Python."""
    solution = resting_rod("-10deg", 0.0)
    whole = follow(solution, E=[0.9e5, 1.1e5])

    def spoil_places(*given: Any) -> Any:
        through: Any = branch_through(*given)
        places, *rest = through
        for place in places[spoil]:
            path = replace(place.path, y=place.path.y + 1, turns=place.path.turns + 2)
            places[places.index(place)] = replace(place, path=path)
        return places, *rest

    monkeypatch.setattr(sys.modules["solver.follow"], "branch_through", spoil_places)
    return whole, follow(solution, E=[0.9e5, 1.1e5])


@pytest.mark.parametrize("which", [3, -4])
def test_a_branch_ends_where_no_point_beyond_is_an_equilibrium(monkeypatch: pytest.MonkeyPatch, which: int) -> None:
    whole, branch = follow_spoiled(monkeypatch, slice(which, None) if which < 0 else slice(which + 1))
    end, kept = (branch.end, whole.values[:which]) if which < 0 else (branch.begin, whole.values[which + 1 :])
    assert "is not solved" in end.reason
    assert end.kind == "stopped"
    assert branch.values.tolist() == kept.tolist()
    assert end.value in (kept[0], kept[-1])
    assert branch.points[branch.start].value == 1e5


@pytest.mark.parametrize("which", [3, -4])
def test_a_branch_leaves_out_a_point_that_is_no_equilibrium(monkeypatch: pytest.MonkeyPatch, which: int) -> None:
    """Behind it the branch is solved again: floats do not resolve one point next to a saddle."""
    whole, branch = follow_spoiled(monkeypatch, slice(which, which + 1))
    assert branch.values.tolist() == np.delete(whole.values, which).tolist()
    assert (branch.begin, branch.end) == (whole.begin, whole.end)
    assert branch.points[branch.start].value == 1e5


def random_resting_case(rng: np.random.Generator) -> Case:
    """A rod of 8 to 200 rho on either side of the wall, with loads and end angles of both signs."""
    a, R = 0.25, float(rng.uniform(0.6, 2.0))
    side: Any = str(rng.choice(["inside", "outside"]))
    rho = R - a if side == "inside" else R + a
    rod = Rod(E=10 ** float(rng.uniform(4, 5.3)), nu=0.3, a=a, L=rho * 10 ** float(rng.uniform(0.9, 2.3)))
    A = float(rod.bending_stiffness)
    euler = max(np.pi**2 * A / rod.L**2, 0.03 * A / rho**2)
    FZ, MZ, M3 = rng.uniform(-3, 3) * euler, *(rng.uniform(-1, 1, 2) * [0.05, 0.2] * A / rho * rng.integers(0, 2, 2))
    beta0, betaL = rng.normal(0, 0.25, 2)
    return Case(rod, Cylinder(R=R, side=side), Ends(beta0, betaL, FZ=FZ, MZ=MZ, M3=M3))


def mirror_image(case: Case) -> Case:
    """The case whose rods have -beta."""
    turned = {name: -getattr(case.given, name) for name in ("beta0", "betaL", "MZ", "M3")}
    return replace(case, given=replace(case.given, **turned))


@pytest.mark.parametrize("count, seed", [(4, 7), pytest.param(60, 8, marks=pytest.mark.slow)])
def test_random_branches_have_equilibria_alone_and_those_of_mirror_images_are_mirror_images(
    count: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(count):
        case = random_resting_case(rng)
        loads, rod = float(case.rod.bending_stiffness) / float(case.rho) ** 2, case.rod
        ends: Any = case.given
        ranges = {"E": (0.5 * rod.E, 2.1 * rod.E), "R": (0.8 * case.cylinder.R, 1.4 * case.cylinder.R)}
        ranges |= {
            "FZ": (ends.FZ - 0.1 * loads, ends.FZ + 0.1 * loads),
            "beta0": (-0.5, 0.5),
            "betaL": (-0.5, 0.5),
        }
        for name, (low, high) in ranges.items():
            wanted, sign = np.linspace(low, high, 4), -1.0 if name in ("beta0", "betaL") else 1.0
            branch = follow(solve(case), **{name: wanted})  # type: ignore[arg-type]
            image = follow(solve(mirror_image(case)), **{name: sign * wanted})  # type: ignore[arg-type]
            folds = {point.position for point in branch.special}
            assert all(point.solution.solved for i, point in enumerate(branch.points) if i not in folds)
            for value in wanted:
                points, images = branch.at(value), image.at(sign * value)
                assert len(points) == len(images)
                shapes = -np.array([point.solution.beta for point in images])
                every = np.array([one.solution.beta for one in equilibria(points[0].case)])
                for point in points:
                    assert np.abs(shapes - point.solution.beta).max(axis=1).min() < 1e-6
                    assert np.abs(every - point.solution.beta).max(axis=1).min() < 1e-6
