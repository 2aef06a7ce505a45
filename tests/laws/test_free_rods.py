"""Rods beside a cylinder that only pushes: the belt, balance in space, what stays and what leaves, and the refusals."""

import sys
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve
from scipy.sparse import coo_array
from scipy.special import ellipe, ellipk

from solver import Case, Cylinder, Ends, InputError, Rod, Start, observe, solve
from solver.free.discrete_rod import HELD_ON, INSIDE, OUTSIDE, DiscreteRod
from solver.free.free_problem import problems_of
from solver.free.free_rods import FREE_TOLERANCE, LEAST, SHAKES, distance, estimate, limit, refine
from solver.free.let_go_descent import Sinking
from solver.free.minimum import minimise
from solver.free.program import EACH_STEP, Effort, Program
from solver.free.quaternions import product
from solver.free.starting_curves import curve_of, curves_of, let_go
from solver.observe.free_numbers import _limit, errors_of_contacts
from solver.orbits import frames
from solver.problem.case_fields import with_field
from tests.cases import table_1
from tests.slow import slow_but

pytest.importorskip("unopy", reason="the extra contact is not installed")

ROD = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
ENDS = Ends(beta0=0.5, betaL=0.8, FZ=-8.66, MZ=1.3, M3=6.1)
ELASTIC = ("bending_energy", "twist_energy")


def elastic_energy(sol: Any) -> float:
    return sum(float(value) for value in observe(sol, ELASTIC).values())


def pushes(sol: Any, arms: bool = False) -> tuple[np.ndarray, float]:
    """The force of the wall on the rod, (3,), and the sum of its sizes: push per length, and point forces.

    arms: the moment about the origin instead of the force.
    """
    outward, s = frames.outward(sol.alpha), sol.s
    size = np.concatenate([0.5 * (sol.push[1:] + sol.push[:-1]) * np.diff(s), [f for _, f in sol.point_forces]])
    at = np.concatenate([(s[1:] + s[:-1]) / 2, [place for place, _ in sol.point_forces]])
    ways = np.stack([np.interp(at, s, outward[:, k]) for k in range(3)], axis=1)
    if arms:
        ways = np.cross(np.stack([np.interp(at, s, sol.position[:, k]) for k in range(3)], axis=1), ways)
    return sol.case.outward * (size[:, None] * ways).sum(axis=0), float(size.sum())


def force_in_space(sol: Any) -> np.ndarray:
    """The internal force, (n, 3)."""
    return in_space(sol, sol.F1, sol.F2, sol.F3)


def in_space(sol: Any, *parts: np.ndarray) -> np.ndarray:
    """A vector, (n, 3), of its components along N, B and T, (n,) each."""
    frame = sol.normal, np.cross(sol.tangent, sol.normal), sol.tangent
    return sum(part[:, None] * along for part, along in zip(parts, frame, strict=True))


def belt(slack: float, stations: int = 2001) -> Any:
    """A rod in a plane across the axis, hinged at 4 rho from it at both ends, bent round the cylinder; A = rho = 1.

    slack: its length over that of a string which is drawn taut.
    """
    radius, half = 4.0, 2.2
    taut = 2 * (half - np.arccos(1 / radius) + np.sqrt(radius**2 - 1))
    ends = Ends(beta0="90deg", betaL="90deg", height=0.0, azimuth=2 * half, M3=0.0, radius0=radius, radiusL=radius,
                M20=0.0, M2L=0.0)  # fmt: skip
    wall = Cylinder(R=0.9, contact="unilateral")
    return solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=taut * slack), wall, ends), stations=stations)


@pytest.mark.parametrize("slack", (1.001, 1.005))
def test_a_belt_leaves_the_drum_where_bending_lets_it_and_is_pressed_on_at_a_point_there(slack: float) -> None:
    """sin(theta_c/2) = sqrt(A/F)/(2 rho); push F cos(theta_c)/rho in between, point forces F sin(theta_c)."""
    sol = belt(slack)
    forces = force_in_space(sol)[[0, -1]]
    F = float(np.linalg.norm(forces[0]))
    first, last = forces / F
    leaves = 2 * np.arcsin(1 / (2 * np.sqrt(F)))
    ((begin, end),) = sol.contacts
    middle = np.abs(sol.s - (begin + end) / 2).argmin()
    # the edges of contact lie between nodes: order 1 there, 7e-5 of the length and its share of the forces
    assert end - begin == pytest.approx(np.arccos(first @ last) - 2 * leaves, abs=2 * sol.error * sol.case.rod.L)
    assert sol.push[middle] == pytest.approx(F * np.cos(leaves), rel=1e-3)
    assert [force for _, force in sol.point_forces] == pytest.approx([F * np.sin(leaves)] * 2, rel=2e-3)


@pytest.mark.parametrize("slack", (1.001, 1.005))
def test_contacts_and_point_forces_are_the_same_numbers_in_a_solution_and_in_its_observables(slack: float) -> None:
    sol = belt(slack)
    numbers = observe(sol, ["contact_share", "contact_at", "point_force_max"])
    ((begin, end),) = sol.contacts
    assert begin == numbers["contact_at"]
    assert (end - begin) / float(sol.case.rod.L) == pytest.approx(float(numbers["contact_share"]), rel=1e-12)
    assert max(force for _, force in sol.point_forces) == numbers["point_force_max"]


def test_rods_whose_ends_off_the_wall_alone_differ_are_solved_in_one_call_as_each_by_itself() -> None:
    def bow(radius: object) -> Any:
        ends = Ends(beta0="90deg", betaL="90deg", height=0.0, azimuth=2.0, M3=0.0, radiusL=radius, M2L=0.0)
        return solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=4.0), Cylinder(R=0.9, contact="unilateral"), ends), stations=51)

    radii = np.array([2.5, 3.0])
    together = bow(radii)
    assert together.solved.all()
    for i, radius in enumerate(radii):
        np.testing.assert_allclose(together.position[i], bow(radius).position, rtol=0, atol=1e-9)


def test_the_curve_from_which_a_rod_begins_does_not_depend_on_the_other_rods() -> None:
    rod = Rod(EI=1228.0, GJ=945.0, a=0.0635, L=100.0, weight=0.242)
    hole = Cylinder(R=0.10795, side="inside", inclination="90deg")

    def beginning(force: Any) -> Any:
        return curves_of(solve(Case(rod, hole, Ends(beta0=0.0, betaL=0.0, FZ=force))), "the shape")[0]

    together, alone = beginning(np.array([-180.0, -400.0])), beginning(-180.0)  # -400 kN needs more places
    assert together.u.size == alone.u.size
    np.testing.assert_allclose(together.x, alone.x, rtol=0, atol=1e-12)


def test_a_slack_belt_touches_the_drum_at_one_point() -> None:
    sol = belt(1.02)
    ((begin, end),) = sol.contacts
    assert begin == end == pytest.approx(sol.case.rod.L / 2, abs=1e-3)
    ((_, force),) = sol.point_forces
    around = force_in_space(sol)
    assert force == pytest.approx(np.linalg.norm(around[-1] - around[0]), rel=1e-3)


def test_nodes_that_the_wall_holds_on_come_to_the_exact_bilateral_shape_with_order_two() -> None:
    missed: list[float] = []
    for edges in (50, 100, 200):
        exact = solve(Case(ROD, Cylinder(R=0.75), ENDS), stations=edges + 1)
        (curve,) = curves_of(exact, "the exact shape")
        assert curve is not None
        (beside,) = problems_of(let_go(exact, [curve])[0])
        rod = replace(beside.rod_on(curve, 1.0, edges), side=HELD_ON)
        minimum = minimise(rod, curve.on(rod), beside.sizes(curve))
        assert minimum is not None
        settled = curve_of(minimum)  # whose ends have a lead
        rod = replace(beside.rod_on(settled, 1.0, edges), side=HELD_ON)
        minimum = minimise(rod, minimum.y, beside.sizes(settled))
        assert minimum is not None
        missed.append(float(np.abs(rod.parts(minimum.y)[1] - exact.position[1:] / float(exact.case.rho)).max()))
    assert missed[-1] < 1e-3
    assert np.log2(missed[0] / missed[1]) == pytest.approx(2, abs=0.2)  # higher orders are still felt
    assert np.log2(missed[1] / missed[2]) == pytest.approx(2, abs=0.1)


@pytest.fixture(scope="module")
def freed() -> tuple[Any, Any]:
    """A rod that the cylinder would have to pull on a fifth of its length, before and after it is let go."""
    before = solve(Case(ROD, Cylinder(R=0.75), ENDS), stations=2001)
    return before, before.let_go(tol=1e-5)


def test_a_rod_that_is_let_go_leaves_the_wall_where_it_would_have_to_pull(freed: tuple[Any, Any]) -> None:
    """The numbers are limits of order 2 of another code, by CasADi and IPOPT."""
    before, after = freed
    assert after.solved
    assert "others may exist" in str(after.outcome)
    assert elastic_energy(after) == pytest.approx(37.555, abs=2e-3)
    assert elastic_energy(before) > 39.7
    assert float(observe(after, ["gap_max"])["gap_max"]) == pytest.approx(0.21005, abs=1e-4)
    ((begin, end),) = after.contacts
    assert (begin, end) == pytest.approx((3.45, 15.0), abs=0.05)
    assert pushes(after)[1] == pytest.approx(23.41, abs=0.05)


def test_the_ends_of_a_rod_that_is_let_go_stay_as_they_are(freed: tuple[Any, Any]) -> None:
    before, after = freed
    for name in ("position", "tangent", "material_frame"):
        old, new = getattr(before, name), getattr(after, name)
        np.testing.assert_allclose(new[[0, -1]], old[[0, -1]], atol=1e-7)


def test_gap_and_push_are_never_negative_and_never_both_there(freed: tuple[Any, Any]) -> None:
    _, sol = freed
    assert (sol.gap >= 0).all()
    assert (sol.push >= 0).all()
    assert (sol.push * sol.gap == 0).all()
    assert np.linalg.norm(sol.position[:, :2], axis=1) == pytest.approx(sol.radius, rel=1e-9)


def test_the_forces_of_the_wall_and_of_both_ends_are_in_balance_in_space(freed: tuple[Any, Any]) -> None:
    _, sol = freed
    forces = force_in_space(sol)
    assert forces[-1] - forces[0] == pytest.approx(-pushes(sol)[0], abs=2e-2)  # of 23.4 N, by trapezoids and edges


def test_components_are_along_an_orthonormal_frame_in_which_an_arc_off_the_wall_carries_what_is_constant(
    freed: tuple[Any, Any],
) -> None:
    _, sol = freed
    force, frame = force_in_space(sol), sol.material_frame
    assert np.linalg.norm(sol.normal, axis=1) == pytest.approx(1.0)
    assert (sol.normal * sol.tangent).sum(axis=1) == pytest.approx(0.0, abs=1e-12)
    # the frame from which the rotation of the section is counted
    turned = np.cos(sol.gamma)[:, None] * frame[:, 0] - np.sin(sol.gamma)[:, None] * frame[:, 1]
    assert turned == pytest.approx(sol.normal, abs=1e-3)
    assert np.ptp(force[:, 2]) < 1e-9
    assert (force * np.cross([0, 0, 1.0], frames.outward(sol.alpha))).sum(axis=1) == pytest.approx(sol.FY, abs=1e-9)
    moment = in_space(sol, sol.M1, sol.M2, sol.M3_along) + np.cross(sol.position, force)
    ((begin, end),) = sol.contacts
    for off in ((sol.s > 0.1) & (sol.s < begin - 0.1), (sol.s > end + 0.1) & (sol.s < sol.case.rod.L - 0.1)):
        assert np.ptp(force[off], axis=0).max() < 1e-3 * np.linalg.norm(force, axis=1).max()
        assert np.ptp(moment[off], axis=0).max() < 1e-3 * np.linalg.norm(moment, axis=1).max()


def random_rod(seed: int) -> Case:
    """A rod between held ends on a cylinder, on each side by turns of fate; every third one has weight."""
    rng = np.random.default_rng(1000 + seed)
    beta0, betaL = rng.uniform(-1, 1, 2)
    weight = rng.uniform(0, 0.3) if seed % 3 == 2 else 0.0
    rod = Rod(EI=1.0, GJ=rng.uniform(0.7, 1), a=0.1, L=rng.uniform(3, 15), **({"weight": weight} if weight else {}))
    side = str(rng.choice(["outside", "inside"]))
    ends = Ends(beta0, betaL, FZ=rng.uniform(-1.5, 1), MZ=rng.uniform(-0.5, 0.5), M3=rng.uniform(-0.5, 0.5))
    wall: dict[str, Any] = {"R": 0.9 if side == "outside" else 1.1, "side": side}
    return Case(rod, Cylinder(**wall, **({"inclination": "60deg"} if weight else {})), ends)


@pytest.mark.parametrize("seed", (3, 12, 13))
def test_wall_and_ends_are_in_balance_where_contact_begins_at_an_end_or_is_short(seed: int) -> None:
    """Forces and moments in space. Rod 3 has contact from its end on, 12 and 13 on a hundredth of their length."""
    sol = solve(random_rod(seed), stations=4001).let_go()
    (force, total), x, F = pushes(sol), sol.position[[0, -1]], force_in_space(sol)[[0, -1]]
    M = in_space(sol, sol.M1, sol.M2, sol.M3_along)[[0, -1]] + np.cross(x, F)
    # by trapezoids, and edges of contact between two stations
    assert F[1] - F[0] == pytest.approx(-force, abs=3e-3 * total)
    assert M[1] - M[0] == pytest.approx(-pushes(sol, arms=True)[0], abs=2e-3 * total * float(sol.case.rod.L))


@pytest.mark.parametrize("seed", slow_but((10, 14, 26, 27, 31, 35, 46, 49, 73), 26, 49, 73))
def test_numbers_of_contacts_are_off_by_no_more_than_the_stated_errors(seed: int) -> None:
    """Contact goes on to an end, or is short. Both errors count, of a mesh and of one of some eight times its edges."""
    names = ("contact_share", "contact_at", "push_mean", "push_max", "point_force_max", "gap_max", "energy")
    before = solve(random_rod(seed))
    rough, fine = (observe(before.let_go(tol=tol), names, errors=True) for tol in (FREE_TOLERANCE, 2e-6))
    for name in names:
        assert abs(rough[name] - fine[name]) <= rough[f"{name}_error"] + fine[f"{name}_error"], name


@pytest.mark.parametrize("side", (OUTSIDE, INSIDE))
@pytest.mark.parametrize("held", (True, False))
def test_the_derivatives_of_a_discrete_rod_are_those_of_differences(side: int, held: bool) -> None:
    rng, step = np.random.default_rng(0), 1e-6
    free = np.array([0, not held, not held, 0, not held, not held, not held, not held], dtype=bool)
    rod = DiscreteRod(5, 3.0, 0.8, 0.4, side, rng.normal(size=3), rng.normal(size=8), free, -1.0, np.array([1.0, 1.5]),
                      None, rng.normal(size=8), 0.4, 0.3 * rng.normal(size=(2, 3)))  # fmt: skip
    y, multipliers, n = rng.normal(size=rod.size), rng.normal(size=rod.bounds[0].size), rod.size

    def jacobian(y: np.ndarray) -> np.ndarray:
        return coo_array((rod.jacobian_values(y), rod.jacobian_places), shape=(multipliers.size, n)).toarray()

    def differences(f: Any) -> np.ndarray:
        return np.stack([(f(y + d) - f(y - d)) / (2 * step) for d in step * np.eye(n)], axis=-1)[..., ~rod.known]

    lower = coo_array((rod.hessian_values(y, 0.7, multipliers), rod.hessian_places), shape=(n, n)).toarray()
    hessian = lower + lower.T - np.diag(np.diag(lower))
    of_lagrangian = differences(lambda y: 0.7 * rod.gradient(y) - multipliers @ jacobian(y))
    near = {"rtol": 0, "atol": 1e-6}  # rounding, 1e-16 of numbers up to 100, over the step
    np.testing.assert_allclose(rod.gradient(y)[~rod.known], differences(rod.energy), **near)
    np.testing.assert_allclose(jacobian(y)[:, ~rod.known], differences(rod.conditions), **near)
    np.testing.assert_allclose(hessian[:, ~rod.known], of_lagrangian, **near)


def test_the_energy_does_not_depend_on_which_share_of_the_twist_is_even(freed: tuple[Any, Any]) -> None:
    """Frames that turn back by a full turn more, on a rod that is twisted evenly by it: the error is of order 2."""
    missed = []
    for shape in freed[1].trajectory.free.answers[0].shapes[-3:]:
        rod, turn = shape.rod, 2 * np.pi
        y, half = shape.y.copy(), np.pi * (np.arange(rod.edges) + 0.5) / rod.edges
        q, _, angles = rod.parts(y)
        q[:] = product(q, np.stack([np.cos(half), 0 * half, 0 * half, -np.sin(half)], axis=1))
        angles[7] -= turn
        other = replace(rod, twist=rod.twist + turn / rod.span, angles=angles, flip=rod.flip)
        missed.append(other.energy(y) - rod.energy(shape.y))
    assert missed[0] / missed[1] == pytest.approx(4, rel=0.1)
    assert missed[1] / missed[2] == pytest.approx(4, rel=0.1)


def test_the_least_of_several_minima_is_found_beside_the_one_that_it_starts_from() -> None:
    freed = solve(with_field(table_1("force-first", "tension", "paper"), "E", 1.4142e4)).let_go(tol=1e-3)
    least = solve(freed.case, tol=1e-3, seed=freed, choose="lowest")
    assert elastic_energy(least) < elastic_energy(freed) / 2  # 20.9 before, 7.6 after
    assert "the least of" in str(least.outcome)
    assert 1 < least.trajectory.free.answers[0].minima <= len(SHAKES)  # ways to the same one count once


def test_meshes_count_anew_where_a_finer_mesh_leads_to_another_minimum() -> None:
    """Refined from the shape of a rod whose clamps are nearer to each other."""
    near, far = (Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=10.0), Cylinder(0.9, contact="unilateral"),
                 Ends(0.0, 0.0, height=height, azimuth=0.0, M3=0.0, radius0=50.0, radiusL=50.0))
                 for height in (5.0, 9.0))  # fmt: skip
    (beside,) = problems_of(far)
    answer = refine(beside, solve(near).trajectory.free.answers[0].shapes[0], 1e-4)
    assert answer.error < 1e-4
    assert [shape.rod.height for shape in answer.shapes] == pytest.approx([9.0] * len(answer.shapes))


@pytest.mark.slow
def test_the_softest_rod_that_is_let_go_keeps_its_minimum_on_finer_meshes() -> None:
    """Its error is of order 1, as its points of contact pass from node to node, and 8320 edges are not computed."""
    freed = solve(with_field(table_1("force-first", "tension", "paper"), "E", 5e3)).let_go()
    shapes = freed.trajectory.free.answers[0].shapes
    energies = [shape.rod.energy(shape.y) for shape in shapes[1:]]
    assert freed.solved
    assert freed.error < 1e-3
    assert energies == pytest.approx([energies[-1]] * len(energies), rel=1e-3)


def test_a_finer_mesh_without_a_minimum_leaves_a_rod_solved_with_the_digits_of_the_others(
    freed: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    known = freed[1].trajectory.free.answers[0].shapes
    most, tol = known[2].rod.edges, freed[1].error / 100

    def none_beyond(rod: DiscreteRod, *given: Any) -> Any:
        return None if rod.edges > most else minimise(rod, *given)

    monkeypatch.setattr("solver.free.free_problem.minimise", none_beyond)
    less = freed[0].let_go(tol=tol)
    assert less.solved
    assert f"fewer digits than the tolerance {tol:.1e}" in less.outcome
    assert f"as no minimum of the energy was found on {2 * most} edges; a stable equilibrium" in less.outcome


def test_a_search_takes_no_more_steps_than_it_may_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Inside, where the contacts of this rod move along it from mesh to mesh."""
    before, seen = solve(Case(ROD, Cylinder(R=0.75, side="inside"), ENDS)), []
    hessian = Program.hessian

    def hessian_and_count(program: Program, *given: Any) -> Any:
        seen.append(program.rod.edges)
        return hessian(program, *given)

    monkeypatch.setattr("solver.free.program.Program.hessian", hessian_and_count)
    monkeypatch.setattr("solver.free.free_rods.STEPS", 60)
    after = before.let_go()
    assert after.solved
    assert "in as many steps as a search may take; a stable equilibrium" in after.outcome
    assert sum(seen) < 2 * 60 * LEAST  # Newton's method takes steps of its own


def test_a_motion_ends_after_as_many_steps_as_it_may_take(
    freed: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("solver.free.let_go_descent.MOST_STEPS", 40)  # those of Uno count too; 120 are needed
    with pytest.raises(InputError, match="this rod does not come to rest within 44 steps"):
        freed[0].descent(2)


def test_a_load_that_turns_the_far_end_round_the_axis_without_end_is_named() -> None:
    """In a hole an end may go round and round. No held azimuth needs a moment like that one: there is no shape."""

    def pipe(**end: float) -> Any:
        ends = Ends(0.0, 0.0, FZ=0.2, M3=0.0, radius0=0.5, **end)
        return solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=10.0), Cylinder(1.1, side="inside", contact="unilateral"), ends))

    needed = [float(observe(pipe(azimuth=turned), ["MZ"])["MZ"]) for turned in (-2.0, -1.0, 0.0, 1.0, 2.0)]
    assert max(needed) < 0.1
    assert pipe(MZ=max(needed) / 2).solved
    assert "as azimuth turns without end: hold it" in pipe(MZ=0.1).outcome


def test_a_twisting_moment_that_turns_an_end_on_the_axis_without_end_is_named_by_the_rotation() -> None:
    """A buckled rod may pass itself, and its far end has then turned twice: its energy falls without end."""
    rod, hole = Rod(EI=1.0, GJ=0.97, a=0.1, L=11.735), Cylinder(1.1, side="inside", contact="unilateral")
    ends = Ends(0.0, 0.0, FZ=-1.67, M3=-0.243, radius0=0.0, radiusL=0.0)
    assert "as rotation turns without end: hold it" in solve(Case(rod, hole, ends)).outcome
    assert solve(Case(rod, hole, replace(ends, M3=None, rotation=0.0))).solved


def test_a_search_is_cut_only_where_it_took_all_the_steps_that_were_left() -> None:
    """A rod in a plane across the axis, pushed off its shape, to which Uno finds back in a few steps."""
    sol = belt(1.005)
    shape, (beside,) = sol.trajectory.free.answers[0].shapes[0], problems_of(sol.case)
    rod, step = shape.rod, shape.rod.edges + EACH_STEP
    moved = shape.y + 1e-3 * np.random.default_rng(0).normal(size=rod.size) * ~rod.known
    program = Program(rod, beside.sizes(curve_of(shape)), moved)
    for steps, cut in ((0.5, True), (2.5, True), (60.5, False)):  # it takes six
        effort = Effort(steps * step)
        assert (program.minimise(effort) is None) == bool(effort.why) == cut
        assert effort.left >= 0


def test_a_rod_continues_from_a_neighbour_by_newtons_method_alone(
    freed: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """From its multipliers: a search by Uno takes ten times the steps, and forgets where the rod touches the wall."""
    before, near = freed[0], freed[1]
    ends = replace(near.case.given, height=near.case.given.height - 1e-3 * ROD.L)
    case = replace(near.case, given=ends)
    searched = solve(case, seed=before.let_go())
    monkeypatch.setattr("solver.free.program.Program.minimise", lambda *_: pytest.fail("Uno searches"))
    followed = solve(case, seed=near)
    assert followed.solved
    far = np.linalg.norm(followed.position - searched.position, axis=1).max() / ROD.L
    assert far <= followed.error + searched.error


def test_the_multipliers_of_a_curve_push_as_hard_on_any_mesh(freed: tuple[Any, Any]) -> None:
    """Half of each force goes to the node at its place on a mesh of half the edges, a quarter to each neighbour."""
    shape = freed[1].trajectory.free.answers[0].shapes[-1]
    curve, edges = curve_of(shape), shape.rod.edges
    known, push, end = shape.rod.split(shape.multipliers)
    for count in (2 * edges, edges, edges // 2, edges // 2 + 7):
        of_edges, wall, far = replace(shape.rod, edges=count).split(curve.multipliers(count))
        assert wall.sum() == pytest.approx(push.sum(), rel=1e-12)
        np.testing.assert_allclose(of_edges[:, :3].mean(axis=0), known[:, :3].mean(axis=0), atol=1e-3 * np.ptp(known))
        np.testing.assert_array_equal(far, end)
        if count == 2 * edges:
            np.testing.assert_allclose(wall[1::2], push / 2, rtol=1e-9, atol=1e-9 * push.max())


def test_a_finer_mesh_that_leads_to_another_minimum_late_is_left_out(
    freed: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beyond an eighth of the finest mesh, where too few meshes are left to tell the error of the other minimum."""
    most = freed[1].trajectory.free.answers[0].shapes[3].rod.edges

    def jump_beyond(coarse: Any, fine: Any) -> float:
        return 1.0 if fine.rod.edges > most else distance(coarse, fine)

    monkeypatch.setattr("solver.free.free_rods.distance", jump_beyond)
    monkeypatch.setattr("solver.free.free_rods.FINEST", 10 * most)
    less = freed[0].let_go(tol=1e-5)
    assert less.solved
    assert f"as {2 * most} edges lead to another minimum; a stable equilibrium" in less.outcome
    assert less.trajectory.free.answers[0].shapes[-1].rod.edges == most


@pytest.mark.parametrize("order", (1.0, 1.1, 1.5, 1.9, 2.0))
@pytest.mark.parametrize("meshes", (3, 5))
def test_the_stated_error_covers_what_errors_of_any_order_from_one_to_two_leave(order: float, meshes: int) -> None:
    left = 2.0 ** (-order * np.arange(meshes))
    assert estimate(list(left))[1] >= left[-1] * (1 - 1e-12)
    assert estimate(list(left))[1] <= 2 * left[-1]


def test_of_numbers_with_errors_of_order_two_the_limit_is_exact_and_the_error_is_that_of_the_finest_mesh() -> None:
    numbers = [np.array([3.0 + 0.1 * h**2, -1.0 - 7.0 * h**2]) for h in (1.0, 0.5, 0.25)]
    np.testing.assert_allclose(limit(numbers), [3.0, -1.0], rtol=1e-13)
    np.testing.assert_allclose(estimate(numbers)[1], np.array([0.1, 7.0]) / 16, rtol=1e-12)


def test_changes_that_happen_to_agree_are_not_trusted_where_those_of_coarser_meshes_do_not() -> None:
    """Of errors h^2 c, as where an edge of contact passes from node to node: c is 3, 1, 2 and 5."""
    numbers = [c * 4.0**-k for k, c in enumerate((3, 1, 2, 5))]
    assert estimate(numbers)[1] > numbers[-1]


def test_two_meshes_are_as_far_from_the_limit_as_from_each_other_and_one_tells_nothing() -> None:
    assert estimate([3.0, 1.0])[1] == pytest.approx(2.0)
    assert estimate([3.0])[1] == np.inf


CLAMPS = {"height": 9.0, "azimuth": 0.0, "M3": 0.0}
CENTRED = {"FZ": -1.0, "radius0": 0.0, "radiusL": 0.0}


@pytest.mark.parametrize(
    ("cylinder", "ends", "line"),
    [
        (
            Cylinder(0.9),
            CLAMPS | {"radius0": 50.0, "radiusL": 50.0},
            "the rod may turn about the line through its ends",
        ),
        (Cylinder(1.1, "inside"), CENTRED, "the rod may turn about the axis of the cylinder"),
        (Cylinder(0.9), CLAMPS | {"azimuth": 0.1}, ""),
    ],
)
def test_a_minimum_of_a_line_of_equal_ones_says_how_the_rod_may_turn(cylinder: Any, ends: Any, line: str) -> None:
    wall = replace(cylinder, contact="unilateral")
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=10.0), wall, Ends(0.0, 0.0, **ends)))
    assert sol.solved
    assert sol.trajectory.free.answers[0].line == line
    assert line in str(sol.outcome)


@pytest.mark.parametrize("inclination", ("180deg", "120deg"))
def test_the_axial_force_at_the_ends_of_a_straight_pipe_holds_its_whole_weight(inclination: str) -> None:
    hole = Cylinder(1.1, "inside", inclination, contact="unilateral")
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=10.0, weight=0.2), hole, Ends(0.0, 0.0, FZ=0.5)))
    assert sol.solved
    along = -0.2 * np.cos(hole.inclination)
    assert sol.F3[[0, -1]] == pytest.approx([0.5 + 10.0 * along, 0.5], abs=1e-9)
    assert float(sol.FZ) == pytest.approx(0.5, abs=1e-9)


def test_a_rod_sinks_in_a_viscous_medium_by_even_steps_without_a_rise_of_its_energy(freed: tuple[Any, Any]) -> None:
    held, free = freed
    motion, energy = held.descent(12)
    assert motion.beta.shape[0] == 12
    assert np.diff(energy).max() < 0
    assert motion.solved.all()
    assert [str(outcome) for outcome in motion.outcome[:-1]] == ["solved; the motion of a rod that is let go"] * 11
    lost = elastic_energy(held) - elastic_energy(free)
    assert energy[0] == pytest.approx(lost, abs=1e-3 * elastic_energy(held))  # on 192 edges, each of 0.1 cm
    np.testing.assert_array_equal(motion.position[-1], held.let_go().position)
    moved = np.linalg.norm(np.diff(np.stack([held.position, *motion.position]), axis=0), axis=-1).max(axis=-1)
    assert moved.max() < 2 * moved.min()
    assert (motion.radius >= held.case.rho).all()
    for end in (0, -1):
        np.testing.assert_allclose(motion.position[:, end], [held.position[end]] * 12, atol=1e-9)
        np.testing.assert_allclose(motion.tangent[:, end], [held.tangent[end]] * 12, atol=1e-9)


def test_the_first_motion_of_a_rod_is_along_the_fall_of_its_energy(freed: tuple[Any, Any]) -> None:
    """What drags balances the push and the change of the internal force at each place, as in dE + drag dx/dt = 0."""
    held, _ = freed
    (curve,) = curves_of(held, "held")
    (beside,) = problems_of(let_go(held, [curve])[0])
    sinking = Sinking(beside, curve, replace(beside.rod, edges=96))
    before = sinking.step(sinking.begun, 1e-6)
    time = 1e-4
    after = sinking.step(before, time)
    rod, h = sinking.rod, sinking.rod.h
    rows, columns = rod.jacobian_places
    pull = np.zeros(rod.size)
    np.add.at(pull, columns, rod.jacobian_values(after.y) * after.multipliers[rows])
    free = np.zeros(rod.size, dtype=bool)
    rod.parts(free)[1][:-1] = True
    force = (pull - rod.gradient(after.y))[free].reshape(-1, 3)
    np.testing.assert_allclose(h * (after.x - before.x)[1:-1] / time, force, atol=1e-6 * np.abs(force).max())


@pytest.mark.parametrize("seed", slow_but(range(40), 0, 1))
def test_energy_never_rises_by_letting_go(seed: int) -> None:
    rng = np.random.default_rng(seed)
    beta0, betaL = rng.uniform(-1, 1, 2)
    rod = Rod(EI=1.0, GJ=0.8, a=0.1, L=rng.uniform(3, 15))
    ends = Ends(beta0, betaL, FZ=rng.uniform(-1.5, 1), MZ=rng.uniform(-0.5, 0.5), M3=rng.uniform(-0.5, 0.5))
    before = solve(Case(rod, Cylinder(0.9, str(rng.choice(["outside", "inside"]))), ends), stations=401)
    if not before.solved or before.case.outward < 0:
        before = solve(Case(rod, Cylinder(0.9), ends), stations=401)
    after = before.let_go()
    if after.solved:
        error = sum(float(value) for value in observe(after, ELASTIC, errors=True).values()) - elastic_energy(after)
        assert elastic_energy(after) <= elastic_energy(before) + error
    else:
        assert str(after.outcome).startswith("failed: ")


PIPE = Rod(EI=1228.0, GJ=945.0, a=0.0635, L=100.0, weight=0.242)  # m, kN
HOLE: dict[str, Any] = {"R": 0.10795, "side": "inside", "inclination": "90deg"}


@pytest.mark.parametrize("FZ", (-100.0, -150.0, -200.0))
def test_a_pipe_that_is_stable_and_pressed_on_stays_where_it_lies(FZ: float) -> None:
    before = solve(Case(PIPE, Cylinder(**HOLE), Ends(0.0, 0.0, FZ=FZ, azimuth=0.0)), stations=801)
    after = before.let_go()
    inside = (after.s > 15) & (after.s < 85)  # within a wave of a clamp a real pipe may leave the wall
    assert before.solved
    assert after.solved
    assert after.gap[inside].max() <= 2 * after.error * PIPE.L
    np.testing.assert_allclose(after.alpha[inside], before.alpha[inside], atol=0.05)


def test_a_pipe_with_centred_ends_buckles_at_the_load_of_dawson_and_paslay() -> None:
    hole = Cylinder(**HOLE, contact="unilateral")
    ranges = {}
    for FZ in (-150.0, -170.0):
        sol = solve(Case(PIPE, hole, Ends(0.0, 0.0, FZ=FZ, radius0=0.0, radiusL=0.0)), stations=801)
        assert sol.solved
        middle = (sol.s > 25) & (sol.s < 75)
        ranges[FZ] = np.ptp(sol.alpha[middle])
        assert 0.7 < float(observe(sol, ["contact_share"])["contact_share"]) < 0.9
        untwisted = observe(sol, ["MZ", "MZ0", "M3", "M30", "surface_torque", "twist_energy"])
        assert {str(value) for value in untwisted.values()} == {"0.0"}  # no rounding
    assert ranges[-150.0] < 1e-3
    assert 0.2 < ranges[-170.0] < 0.4


def length_of_arc(FZ: float, alpha: float, beta: float, M2: float, near: float) -> float:
    """How far `PIPE`, marched in space from the axis and along it, is free until it meets the wall like this [m]."""
    P, rho, w, A = -FZ, HOLE["R"] - PIPE.a, PIPE.weight, PIPE.bending_stiffness
    out, around = np.array([np.cos(alpha), np.sin(alpha), 0]), np.array([-np.sin(alpha), np.cos(alpha), 0])

    def slopes(_: float, y: np.ndarray) -> np.ndarray:
        t, m, force = y[3:6], y[6:9], np.array([*y[9:], -P])
        return np.concatenate([t, np.cross(m, t) / A, np.cross(force, t), [-w, 0.0]])

    def missed(v: np.ndarray) -> list[float]:
        y = solve_ivp(slopes, (0, v[4]), [0, 0, 0, 0, 0, 1, v[0], v[1], 0, *v[2:4]], rtol=1e-10, atol=1e-13).y[:, -1]
        x, t, m = y[:3], y[3:6], y[6:9]
        leans = t @ out, np.arctan2(t @ around, t[2]) - beta
        return [x @ out - rho, x @ around, *(near * np.array(leans)), (m @ np.cross(out, t) - M2) / P]

    k, sag, turned = np.sqrt(P / A), w / P, np.exp(1j * alpha)  # the arc of small angles is near
    c, s = np.cos(k * near), np.sin(k * near)
    u = rho * turned - sag * near**2 / 2, 1j * beta * turned / k - sag * near / k
    bend, shear = np.linalg.solve(np.array([[1 - c, k * near - s], [s, 1 - c]], dtype=complex), u)
    moment, force = P * bend + A * sag, -P * k * shear
    v, _, found, _ = fsolve(missed, [-moment.imag, moment.real, force.real, force.imag, near], full_output=True)
    assert found == 1
    return float(v[4])


@pytest.mark.parametrize("FZ", slow_but((-160.0, -200.0, -400.0), -160.0, -200.0))
def test_a_pipe_is_off_the_wall_next_to_a_centred_end_as_long_as_a_rod_in_space(FZ: float) -> None:
    hole = Cylinder(**HOLE, contact="unilateral")
    sol = solve(Case(PIPE, hole, Ends(0.0, 0.0, FZ=FZ, radius0=0.0, radiusL=0.0)), stations=2001, tol=2e-7)
    at, alpha, M2 = (observe(sol, [f"contact_{name}"], errors=True).values() for name in ("at", "alpha", "M2"))
    (at, at_error), (alpha, _), (M2, M2_error) = at, alpha, M2
    size = -FZ * (HOLE["R"] - PIPE.a)
    length = length_of_arc(FZ, alpha, np.interp(at, sol.s, sol.beta), M2, at)
    # by the law of small angles an error of M2/(P rho) is twice one of the length
    assert abs(length - at) < at_error + 2 * length * M2_error / size
    x = length * np.sqrt(-FZ / PIPE.bending_stiffness)
    V = 1 - x / (2 * np.tan(x / 2))
    weight = PIPE.weight * PIPE.bending_stiffness * np.cos(alpha) / (-FZ * size)
    assert 2 * V * M2 / size + 2 * V**2 * weight == pytest.approx(1, abs=(2 * size / FZ / length) ** 2)


@pytest.mark.parametrize(("end", "turns"), [(-2e-19, 0.0), (2e-6, 1e-6 / np.pi)])
def test_what_rounding_leaves_of_the_turns_of_a_rod_is_none(end: float, turns: float) -> None:
    on_wall = SimpleNamespace(radius=np.ones(2))
    azimuths = (SimpleNamespace(turned=np.linspace(0.0, k * end, 5)[None]) for k in (5, 2, 1.25))  # of order 2
    meshes: Any = [SimpleNamespace(along=along, rod=on_wall) for along in azimuths]
    value, error = _limit("turns_around", meshes)
    assert value == pytest.approx(turns, rel=1e-12, abs=0)
    assert 0.24 * abs(end) / (2 * np.pi) <= error


def test_turns_between_ends_on_the_axis_do_not_depend_on_the_azimuth_that_is_given_there() -> None:
    pipe, hole = (
        Rod(EI=1228.0, GJ=945.0, a=0.0635, L=30.0),
        Cylinder(HOLE["R"], side="inside", contact="unilateral"),
    )
    turns = []
    for alpha in (0.0, 2.5):
        ends = Ends(0.0, 0.0, FZ=-300.0, radius0=0.0, radiusL=0.0, alpha=alpha)
        sol = solve(Case(pipe, hole, ends), stations=4001)
        turns.append(float(observe(sol, ["turns_around"])["turns_around"]))
        assert 2 * np.pi * turns[-1] == pytest.approx(sol.alpha[-2] - sol.alpha[1], abs=0.2)  # of stations off the axis
    assert turns[0] == pytest.approx(turns[1], abs=1e-6)
    assert abs(turns[0]) > 0.5


def test_a_load_that_is_given_is_observed_as_it_is_given() -> None:
    sol = solve(Case(ROD, Cylinder(R=0.75, contact="unilateral"), replace(ENDS, MZ=0.0, M3=1.3)))
    seen = observe(sol, ["FZ", "MZ", "M3", "M30", "surface_torque"], errors=True)
    assert {name: float(value) for name, value in seen.items()} == {
        "FZ": -8.66,
        "MZ": 0.0,
        "M3": 1.3,
        "M30": 1.3,
        "surface_torque": -1.3,
        "FZ_error": 0.0,
        "MZ_error": 0.0,
        "M3_error": 0.0,
        "M30_error": 0.0,
        "surface_torque_error": 0.0,
    }


def test_loads_that_hold_the_ends_of_a_rod_off_the_wall_are_off_by_no_more_than_their_stated_errors(
    freed: tuple[Any, Any],
) -> None:
    before, fine = freed
    names = ("FZ", "MZ", "M3")
    rough, better = (observe(sol, names, errors=True) for sol in (before.let_go(), fine))
    for name in names:
        assert 0 < rough[f"{name}_error"] < abs(rough[name]), name
        assert abs(rough[name] - better[name]) <= rough[f"{name}_error"] + better[f"{name}_error"], name
    assert set(observe(before, names, errors=True)) == set(names)  # on the wall they have none


@pytest.mark.parametrize("slack", (1.001, 1.02))
def test_contacts_begin_and_end_where_finer_meshes_have_them_but_for_the_stated_error(slack: float) -> None:
    """The second belt touches the drum at a point only, whose share of the length has no error."""
    shapes = belt(slack).trajectory.free.answers[0].shapes
    *some, (begin, end) = [(on.begin, on.end) for shape in shapes for on in shape.contacts]
    for meshes in range(3, len(shapes)):
        ((first, last),) = errors = errors_of_contacts(shapes[:meshes])[0]
        assert (np.abs(np.subtract(some[meshes - 1], (begin, end))) <= errors).all()
        assert max(first, last) < 0.5


def test_contact_that_nothing_tells_from_a_gap_is_in_the_errors() -> None:
    """A reference finds one cable on the wall from its start on, and one rod off it by 4e-8 cm in a stretch."""
    names = "contact_at", "contact_share"
    drum = Cylinder(200.0, contact="unilateral")
    held = Ends("90deg", "90deg", height=0.0, azimuth="200deg", radiusL=1206.0, M2L=0.0)
    cable = observe(solve(Case(Rod(EI=2e6, GJ=1.6e6, a=6.0, L=1640.0), drum, held)), names, errors=True)
    assert cable["contact_at"] <= cable["contact_at_error"]
    assert abs(cable["contact_share"] - 197.05 / 1640) <= cable["contact_share_error"] < 0.05
    ends, cylinder = Ends(0.5, 0.8, FZ=-8.66, MZ=1.3, M3=6.1), Cylinder(R=0.75, inclination="70deg")
    for weight, share, most in ((0.3, (14.309 - 3.652) / 20, 0.02), (0.0, 0.5754, 0.005)):
        rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0, weight=weight)
        seen = observe(solve(Case(rod, cylinder, ends)).let_go(), names, errors=True)
        assert abs(seen["contact_share"] - share) <= seen["contact_share_error"] < most


def test_the_edge_of_a_contact_that_passes_a_node_by_chance_alike_on_three_meshes_has_its_error() -> None:
    """The changes from 24 to 48 and 96 edges are as of order 2, the next are not. These numbers are of 6144 edges."""
    drum, rod = Cylinder(200.0, contact="unilateral"), Rod(EI=2e6, GJ=1.6e6, a=6.0, L=1616.0)
    held = Ends("90deg", "90deg", height=0.0, azimuth="200deg", radiusL=1200.0, M2L=0.0)
    true = {"push_max": 0.58298, "point_force_max": 78.8273, "contact_share": 0.196321}
    seen = observe(solve(Case(rod, drum, held)), [*true], errors=True)
    for name, value in true.items():
        assert abs(seen[name] - value) <= seen[f"{name}_error"] < 0.02 * value, name


def test_a_contact_that_only_the_finest_mesh_has_is_looked_at_on_one_more() -> None:
    """Of three meshes of this cable the last alone has a contact, so that no change tells the error of its force."""
    cable, drum = Rod(EI=0.16, GJ=0.16, a=0.1, L=6.139), Cylinder(0.9, contact="unilateral")
    held = Ends("85deg", "80deg", height=0.03, azimuth=2.526, M3=0.0, radiusL=4.983, M2L=0.0)
    contacts = [len(shape.contacts) for shape in solve(Case(cable, drum, held)).trajectory.free.answers[0].shapes]
    assert contacts[-2:] == [1, 1]


@pytest.mark.parametrize(("FZ", "word"), [(-166.0, "straight"), (-170.0, "sinusoidal")])
def test_an_end_on_the_axis_has_no_azimuth_that_would_be_a_wave(FZ: float, word: str) -> None:
    hole = Cylinder(R=0.10795, side="inside", inclination="90deg", contact="unilateral")
    pipe = Rod(EI=1228.0, GJ=945.0, a=0.0635, L=100.0, weight=0.242)
    sol = solve(Case(pipe, hole, Ends(beta0=0.0, betaL=0.0, FZ=FZ, radius0=0.0, radiusL=0.0)))
    assert {state.word for state in sol.states} == {"straight", word}
    assert sol.states[-1].word == "straight"


def test_the_moment_about_the_axis_that_holds_the_frame_of_an_end_there_is_observed() -> None:
    """A wall pushes at right angles to the axis, and so has no moment about it: both ends have the same."""
    hole = Cylinder(1.1, side="inside", contact="unilateral")
    ends = Ends(-0.356, -0.776, FZ=0.038, MZ=0.0, rotation=0.509, radius0=0.0, radiusL=0.0)
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=5.0), hole, ends))
    seen = observe(sol, ["MZ", "MZ0"], errors=True)
    assert seen["MZ"] == pytest.approx(seen["MZ0"], abs=2 * seen["MZ0_error"])
    assert seen["MZ"] > 10 * seen["MZ0_error"]


def test_a_tilt_is_an_angle_to_a_plane_however_far_a_hinge_turns() -> None:
    """A hinge at the start lets the rod turn over; at the far end the tilt is held at 0."""
    wall = Cylinder(0.9, inclination=0.3, contact="unilateral")
    ends = Ends(0.368, FZ=-0.338, azimuth=-1.629, rotation=-0.146, M20=0.084, M1L=0.0, radius0=1.2)
    sol = solve(Case(Rod(EI=1.0, GJ=0.909, a=0.1, L=9.448, weight=0.0156), wall, ends))
    assert sol.solved
    assert abs(sol.tilt[0]) <= np.pi
    assert np.abs(sol.tilt[1:]).max() <= np.pi / 2
    assert sol.tilt[-1] == pytest.approx(0, abs=1e-9)


def test_between_two_hinges_that_turn_over_a_rod_has_the_same_angles_on_each_mesh() -> None:
    """A rod between them is half a turn from the angles that are given at either, to whichever side."""
    ends = Ends(0.05, -0.4, FZ=-0.3, rotation=0.3, M20=0.2, M2L=-0.9, radius0=3.0, radiusL=2.1)
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=3.5), Cylinder(0.9, contact="unilateral"), ends))
    assert sol.solved, sol.outcome
    assert np.abs(sol.tilt[[0, -1]]).min() > np.pi / 2
    assert np.abs(sol.tilt[1:-1]).max() <= np.pi / 2
    first, *finer = (shape.at(sol.t[0, 1:-1]).turned for shape in sol.trajectory.free.answers[0].shapes)
    for turned in finer:
        assert turned == pytest.approx(first, abs=0.1)


@pytest.mark.parametrize("reverse", [False, True])
def test_numbers_that_are_given_at_a_hinge_that_turns_over_are_observed_as_given(reverse: bool) -> None:
    """From either end: a rod that is turned round about a radius keeps its angles, and its moment M2."""
    angles, hinge, off = (0.3, 0.4), ("M20", "M2L")[reverse], ("radiusL", "radius0")[reverse]
    ends = Ends(*angles[:: 1 - 2 * reverse], FZ=0.1, gamma=0.2, rotation=0.5, **{hinge: 1.2, off: 1.5})
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=4.0), Cylinder(0.9, contact="unilateral"), ends), stations=9)
    assert sol.solved, sol.outcome
    over = -reverse
    assert abs(sol.tilt[over]) > np.pi / 2
    assert (sol.beta[0], sol.beta[-1]) == pytest.approx((ends.beta0, ends.betaL), abs=1e-6)
    assert sol.M2[over] == pytest.approx(1.2, rel=1e-3)  # the moment of a joint, to second order in the edges
    assert sol.gamma[-1] - sol.gamma[0] == pytest.approx(0.5, abs=1e-6)
    across = np.cos(sol.tilt) * np.sin(sol.beta)
    x = np.sin(sol.tilt) * np.cos(sol.alpha) - across * np.sin(sol.alpha)
    y = np.sin(sol.tilt) * np.sin(sol.alpha) + across * np.cos(sol.alpha)
    tangent = np.column_stack([x, y, np.cos(sol.tilt) * np.cos(sol.beta)])
    assert tangent == pytest.approx(sol.tangent, abs=1e-6)


@pytest.mark.parametrize(("side", "M2L"), [("inside", 0.3), ("outside", -0.4)])
def test_a_hinge_that_its_moment_presses_into_the_wall_lies_along_it_with_order_two(side: str, M2L: float) -> None:
    """The wall takes the rest of the moment, as a couple at the very end, which is no point force."""
    wall = Cylinder(1.1 if side == "inside" else 0.9, side, contact="unilateral")
    ends = Ends(0.5, FZ=-0.3, azimuth=2.0 if side == "inside" else 0.3, M3=0.0, M1L=0.0, M2L=M2L)
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=8.0), wall, ends), tol=1e-5)
    assert sol.error <= 1e-5, sol.outcome
    moved = [distance(*pair) for pair in pairwise(sol.trajectory.free.answers[0].shapes)]
    assert moved[-2] / moved[-1] == pytest.approx(4, rel=0.05)
    assert sol.tilt[-1] == pytest.approx(0, abs=1e-12)
    assert sol.point_forces == ()
    assert sol.M2[-1] == pytest.approx(sol.M2[-2], abs=1e-2)


def test_a_rod_off_the_wall_without_an_axial_force_has_none_at_either_end() -> None:
    wall = Cylinder(1.0, contact="unilateral")
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=6.0), wall, Ends(0.8, 0.3, FZ=0.0, radius0=1.1, radiusL=1.3)))
    assert sol.solved
    assert {str(value) for value in observe(sol, ["FZ", "FZ0"]).values()} == {"0.0"}  # no rounding


def test_a_rod_that_never_touches_bends_as_a_beam_under_its_end_moments() -> None:
    """Small angles: with both ends turned by b in a plane far from the cylinder the moment is 2 A b/L all along."""
    L, b = 10.0, 0.02
    ends = Ends(0.0, 0.0, FZ=0.0, azimuth=0.0, M3=0.0, radius0=50.0, radiusL=50.0, tilt0=b, tiltL=-b)
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=L), Cylinder(R=0.9, contact="unilateral"), ends), tol=1e-6)
    assert sol.contacts == ()
    assert np.abs(sol.kappa) == pytest.approx(2 * b / L, rel=1e-3)
    assert sol.radius.max() - 50.0 == pytest.approx(b * L / 4, rel=1e-3)


@pytest.mark.parametrize(("radius", "height"), [(3.0, 9.9), (50.0, 9.9), (200.0, 9.9), (1000.0, 9.9)])
def test_a_clamped_rod_that_is_pressed_together_off_the_wall_bows_as_the_elastica(radius: float, height: float) -> None:
    """Between clamps on one line: height/L = 2 E(k)/K(k) - 1, and the bow is k L/K(k) wide, in whichever direction."""
    L = 10.0
    m = brentq(lambda m: 2 * ellipe(m) / ellipk(m) - 1 - height / L, 0.0, 0.9)
    ends = Ends(0.0, 0.0, height=height, azimuth=0.0, M3=0.0, radius0=radius, radiusL=radius)
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=L), Cylinder(R=0.9, contact="unilateral"), ends))
    assert sol.solved, sol.outcome
    bow = np.linalg.norm(sol.position[:, :2] - sol.position[0, :2], axis=1).max()
    assert bow == pytest.approx(np.sqrt(m) * L / ellipk(m), abs=2 * sol.error * L)


@pytest.mark.parametrize("seed", slow_but(range(20), 0, 1))
def test_a_rod_between_clamps_of_any_direction_off_the_wall_is_in_balance_in_space(seed: int) -> None:
    """Clamps lean by up to a radian, at different distances; ends nearer than a straight rod's are no hindrance."""
    rng = np.random.default_rng(seed)
    L, radius = rng.uniform(5, 20), rng.uniform(25, 60)
    height, apart, tilt0, tiltL = L * rng.uniform(0.2, 0.8), L * rng.uniform(-0.5, 0.5), *rng.uniform(-1, 1, 2)
    beta0, betaL, azimuth = *rng.uniform(-0.5, 0.5, 2), rng.uniform(-2, 2) / radius
    ends = Ends(beta0, betaL, height=height, azimuth=azimuth, M3=0.0, radius0=radius,
                radiusL=radius + apart, tilt0=tilt0, tiltL=tiltL)  # fmt: skip
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=L), Cylinder(R=0.9, contact="unilateral"), ends), tol=1e-3)
    assert sol.solved, sol.outcome
    forces = force_in_space(sol)
    np.testing.assert_allclose(forces, forces[[0]].repeat(sol.s.size, axis=0), rtol=1e-6)


def test_a_cylinder_that_only_pushes_pulls_nowhere(freed: tuple[Any, Any]) -> None:
    seen = observe(freed[1], ["lift_off_at"], errors=True)
    assert (seen["lift_off_at"], seen["lift_off_at_error"]) == (ROD.L, 0)


def test_a_mirror_image_is_let_go_to_the_mirror_image(freed: tuple[Any, Any]) -> None:
    _, after = freed
    ends = Ends(beta0=-0.5, betaL=-0.8, FZ=-8.66, MZ=-1.3, M3=-6.1)
    mirrored = solve(Case(ROD, Cylinder(R=0.75), ends), stations=2001).let_go(tol=1e-5)
    np.testing.assert_allclose(mirrored.position, after.position * [1, -1, 1], atol=1e-6)


def test_a_rope_that_is_wound_nearly_taut_stays_on_its_drum() -> None:
    """Its slack is a few millionths, far less than what chords as long as their arcs would add on a thousand edges."""
    rope = Rod(EI=3.927e7, GJ=3.021e7, a=10.0, L=5970.0)
    held = solve(Case(rope, Cylinder(R=180.0), Ends("89deg", "89deg", FZ=300.0, MZ=2106363.0, M3=3607.0)))
    free = held.let_go()
    assert free.error <= FREE_TOLERANCE, free.outcome
    ((begin, end),) = free.contacts
    assert end - begin > 0.99 * rope.L
    np.testing.assert_allclose(free.position, held.position, atol=FREE_TOLERANCE * rope.L)


def test_a_finer_tolerance_moves_a_rod_by_no_more_than_the_stated_error(freed: tuple[Any, Any]) -> None:
    before, fine = freed
    coarse = before.let_go()
    far = np.linalg.norm(fine.position - coarse.position, axis=1).max() / ROD.L
    assert far <= coarse.error + fine.error


def test_a_tolerance_above_the_default_one_needs_three_meshes_too(freed: tuple[Any, Any]) -> None:
    before, fine = freed
    draft = before.let_go(tol=1e-3)
    assert len(draft.trajectory.free.answers[0].shapes) == 3
    far = np.linalg.norm(fine.position - draft.position, axis=1).max() / ROD.L
    assert far <= draft.error + fine.error < 1e-3


def test_no_rod_on_the_cylinder_is_solved_for_one_whose_end_is_far_off(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its shape continues from a straight rod."""
    monkeypatch.setattr(
        sys.modules["solver.solve"], "bilateral_cases", lambda _: pytest.fail("a bilateral shape is looked for")
    )
    assert belt(1.005).solved


@pytest.mark.parametrize(
    "case",
    [
        Case(
            Rod(EI=1.0, GJ=0.7755289359250345, a=0.05, L=5.819176369262617),
            Cylinder(R=1.3181104721075485),
            Ends(
                0.014136277846782619, 0.012770002843141892, -0.9095146790103412, -0.291278231781712, 0.25993434013526023
            ),
        ),
        Case(
            Rod(EI=1.0, GJ=0.8901077044717807, a=0.05, L=8.285750906315545),
            Cylinder(R=1.391560078186782, side="inside"),
            Ends(-0.325404988502602, 0.5873090555173122, -0.5025318672798904, 0.05643232943262444, 0.14248018967413617),
        ),
    ],
    ids=["outside", "inside"],
)
def test_an_order_that_two_changes_seem_to_have_once_is_not_trusted(case: Case) -> None:
    held = solve(case)
    loose, tight = held.let_go(), held.let_go(tol=1e-5)
    assert np.abs(loose.position - tight.position).max() < (float(loose.error) + float(tight.error)) * case.rod.L


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Case(ROD, Cylinder(0.75, contact="unilateral"), Start(beta=0.5, dbeta=0.1, F3=1.0, M3=0.0)), "Ends"),
        (lambda: Cylinder(0.75, friction=0.3, contact="unilateral"), "excludes friction"),
        (lambda: Cylinder(0.75, contact="none"), "bilateral"),
        (
            lambda: Case(ROD, Cylinder(0.75), Ends(0.0, 0.0, tilt0=0.1)),
            "tilt0 matters only with unilateral contact",
        ),
        (lambda: Case(ROD, Cylinder(0.75, contact="unilateral"), Ends(0.0, 0.0, radiusL=0.5)), "radiusL"),
    ],
)
def test_what_has_no_shape_beside_a_cylinder_that_only_pushes_is_refused(make: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()


@pytest.mark.parametrize("beta", (0.0, 0.7))
def test_a_taut_rod_that_is_let_go_keeps_its_tension_and_says_that_its_ends_leave_it_open(beta: float) -> None:
    rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    around = rod.L * np.sin(beta)  # the centreline is 1 from the axis
    before = solve(Case(rod, Cylinder(R=0.75), Ends(beta, beta, FZ=9.0, azimuth=around, M3=0.0)))
    after = before.let_go()
    assert after.solved
    assert "whose axial force is kept" in after.outcome
    values, errors = (observe(sol, ["push_mean", "F3_size_max"], errors=True) for sol in (before, after))
    for name in ("push_mean", "F3_size_max"):
        assert errors[name] == pytest.approx(values[name], abs=float(errors[f"{name}_error"]) + 1e-9)
    held = Ends(beta, beta, height=rod.L * np.cos(beta), azimuth=around, M3=0.0)
    again = solve(Case(rod, Cylinder(R=0.75, contact="unilateral"), held))
    assert again.outcome.startswith("failed: the ends are held as far apart")


def test_without_uno_one_sentence_names_its_package_and_the_extra(
    freed: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "unopy", None)
    with pytest.raises(InputError, match=r"needs the package unopy: pip install 'rod-workbench\[contact\]'"):
        freed[0].let_go()


def test_a_seed_that_a_rod_cannot_be_let_go_from_is_refused_or_named_in_the_outcome() -> None:
    rod, cylinder = Rod(E=1.07e4, nu=0.25, a=0.25, L=6.0), Cylinder(R=0.75)
    held = solve(Case(rod, cylinder, Ends(beta0=0.2, betaL=0.3, FZ=-20.0)), stations=21)
    two = solve(Case(rod, cylinder, Ends(beta0=0.2, betaL=0.3, FZ=[-20.0, -19.0])), stations=21)
    for seed in (3.0, "straight", [held], held.case, two):
        with pytest.raises(InputError, match=r"^a seed of let_go is a Solution of as many rods, 1; got"):
            held.let_go(seed=seed)
    unsolved = replace(held, trajectory=replace(held.trajectory, solved=np.array([False])))
    assert held.let_go(seed=unsolved).outcome == "failed: the seed is not solved"
    assert unsolved.let_go(seed=held).outcome == "failed: there is no shape to be let go"
