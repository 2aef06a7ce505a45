"""Ends held in position: reactions, uniqueness of the answer, hinges, the Morse index, and what is refused."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.special import ellipk

from solver import Case, Cylinder, Ends, Rod, Solution, equilibria, observe, solve
from solver.branches.given_numbers import Given, OrbitState
from solver.branches.held_index import index_of
from solver.branches.orbit_rates import orbit_rates
from solver.numerics.arrays import FAINT
from solver.orbits.boundary import path_of
from solver.orbits.path_orbits import orbit_of
from solver.orbits.potential import slope_rate
from solver.problem.case_fields import fields_of
from solver.problem.declared_fields import PAIRS
from solver.problem.dimensionless import EndsProblem, reduce
from tests.cases import in_units_of_rho, table_1
from tests.numerics.test_sensitivity import moved
from tests.slow import slow

TABLE = table_1("force-first", "tension", "paper")
SHORT, DRUM = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(0.75)


def displacements(sol: Solution) -> dict[str, float]:
    return {
        "height": float(sol.z[-1] - sol.z[0]), "azimuth": float(sol.alpha[-1] - sol.alpha[0]),
        "rotation": float(sol.gamma[-1] - sol.gamma[0]),
    }  # fmt: skip


def test_table_1_with_a_lowered_end_has_the_known_reactions() -> None:
    """FZ/A, MZ/A, M3/A and beta'(0) of the physics notes, computed apart with marched orbits and a root finder."""
    start = solve(TABLE)
    ends = displacements(start)
    assert ends == pytest.approx({"height": 7.07512262, "azimuth": -0.21572730, "rotation": 61.3785078}, rel=1e-8)
    ends["height"] -= 0.3
    held = Ends(beta0=TABLE.given.beta, betaL=float(start.beta[-1]), **ends)
    found = solve(replace(TABLE, given=held), seed=start)
    A = TABLE.rod.bending_stiffness
    assert found.outcome == "solved"
    assert found.begun.startswith("the seed, 0.")
    assert pytest.approx([0.756046552, 2.711074293, 2.530586040], abs=1e-9) == [
        found.FZ / A,
        found.MZ / A,
        found.M3 / A,
    ]
    assert found.dbeta[0] == pytest.approx(0.707198662, abs=1e-9)
    assert list(found.reactions) == ["FZ", "MZ", "M3"]
    assert displacements(found) == pytest.approx(ends, abs=1e-12)


def test_the_solution_is_that_under_its_reactions() -> None:
    held = Ends(beta0=0.5, M1L=0.0, height=3.0, azimuth=1.0)
    found = solve(Case(SHORT, DRUM, held))
    loads = {name: found.reactions[name] for name in ("FZ", "MZ")}
    dead = Case(SHORT, DRUM, Ends(beta0=0.5, betaL=found.reactions["betaL"], **loads))
    again = solve(dead, seed=float(found.dbeta[0]))
    assert again.beta == pytest.approx(found.beta, abs=1e-9)
    assert (found.z[-1], found.alpha[-1]) == pytest.approx((3.0, 1.0), abs=1e-12)
    assert found.dbeta[-1] == pytest.approx(0.0, abs=1e-10)


def random_problem(rng: np.random.Generator) -> tuple[Any, Any]:
    """A start problem and another one whose numbers differ from it by up to 5 %."""
    numbers = [*rng.uniform(-1, 1, 3), rng.uniform(2, 12), rng.uniform(-1.5, 1.5), rng.uniform(-1, 1)]
    other = [value * (1 + 0.05 * rng.uniform(-1, 1)) for value in numbers]
    return in_units_of_rho(*numbers), in_units_of_rho(*other)


def held_like(case: Case, sol: Solution, rng: np.random.Generator) -> Ends:
    """The ends of a solution, of each pair one at random."""
    every = values_of(sol, Ends(0, 0), every=True)
    return Ends(**{name: every[name] for name in (pair[rng.integers(2)] for pair in PAIRS)})


def check_return(seed: int, thorough: bool = False) -> str:
    """Pose a known solution as a held problem, and solve it from a seed 5 % away.

    "back", or "failed: " and why, or for another solution: "named" where the known one is among its `alternatives`,
    "others" where these are other ones, "listed" under dead loads, where `equilibria` lists it, and else "silent".
    thorough: where it is another solution, see that small steps lead to it, so that it is on the branch of the seed.
    """
    rng = np.random.default_rng(seed)
    case, near = random_problem(rng)
    known, start = solve(case, tol=1e-11), solve(near, tol=1e-11)
    held = held_like(case, known, rng)
    posed = Case(case.rod, case.cylinder, held)
    found = solve(posed, seed=start)
    if not found.solved:
        assert found.outcome.startswith("failed: ")
        return str(found.outcome)
    given = values_of(found, held)
    assert given == pytest.approx({name: getattr(held, name) for name in given}, abs=1e-8)
    if np.abs(found.beta - known.beta).max() < 1e-8:
        return "back"
    if thorough:
        assert stepwise(posed, start).beta == pytest.approx(found.beta, abs=1e-7), seed
    if not found.held:
        every = equilibria(posed)
        assert every.complete
        assert any(np.abs(one.solution.beta - known.beta).max() < 1e-7 for one in every)
        return "listed"
    for one in found.alternatives:
        again = values_of(one.solution, held)
        assert again == pytest.approx({name: getattr(held, name) for name in again}, abs=1e-8)
        if np.abs(one.solution.beta - known.beta).max() < 1e-7:
            return "named"
    return "others" if found.alternatives else "silent"


def values_of(sol: Solution, held: Ends, every: bool = False) -> dict[str, float]:
    """The values of a solution that these ends give, or all of them."""
    A = sol.case.rod.bending_stiffness
    values = {
        "beta0": float(sol.beta[0]), "M10": float(A * sol.dbeta[0]), "betaL": float(sol.beta[-1]),
        "M1L": float(A * sol.dbeta[-1]), "FZ": float(sol.FZ), "MZ": float(sol.MZ), "M3": float(sol.M3),
        **displacements(sol),
    }  # fmt: skip
    return {name: value for name, value in values.items() if every or getattr(held, name) is not None}


def stepwise(case: Case, start: Solution, steps: int = 40) -> Solution:
    """The solution reached from a seed through problems in between."""
    assert isinstance(case.given, Ends)
    begin, seed = values_of(start, case.given), start
    for share in np.linspace(0, 1, steps + 1)[1:]:
        given = {name: (1 - share) * value + share * getattr(case.given, name) for name, value in begin.items()}
        L = (1 - share) * start.case.rod.L + share * case.rod.L
        seed = solve(Case(replace(case.rod, L=L), case.cylinder, Ends(**given)), seed=seed)
    return seed


@pytest.mark.parametrize("seeds", [*(range(k, k + 5) for k in range(0, 30, 5)), slow(range(500))])
def test_random_held_problems_come_back_or_say_why_not(seeds: range) -> None:
    """Where the seed lies beyond a fold of the problem, its branch leads to another equilibrium, which says so."""
    assert "silent" not in [check_return(seed, thorough=len(seeds) > 5) for seed in seeds]


def test_a_seeded_solution_says_how_far_its_seed_is_and_what_is_nearer() -> None:
    rng = np.random.default_rng(308)
    case, near = random_problem(rng)
    known, start = solve(case, tol=1e-11), solve(near, tol=1e-11)
    held = held_like(case, known, rng)
    found = solve(Case(case.rod, case.cylinder, held), seed=start)
    far = np.abs(found.beta - start.beta).max()
    assert found.begun.startswith(f"the seed, {far:.2g}")
    assert "another equilibrium with these ends is nearer to this one than the seed is: see alternatives" in found.begun
    (other, *_) = found.alternatives
    assert other.solution.beta == pytest.approx(known.beta, abs=1e-8)
    assert other.away == pytest.approx(np.abs(known.beta - start.beta).max(), rel=1e-3)
    close = solve(Case(case.rod, case.cylinder, held), seed=found)
    assert close.begun == "the seed itself"
    assert solve(known.case).alternatives == ()


@pytest.mark.parametrize("angle", (0.05, 0.8, 2.0))
def test_hinged_at_both_ends_is_half_a_period_of_the_elastica(angle: float) -> None:
    """On a nearly flat surface beta'' = -p sin(beta), and half a period is 2 K(sin(angle/2))/sqrt(p)."""
    rod, flat = Rod(E=4 / np.pi, nu=0.25, a=1.0, L=10.0), Cylinder(1e5)  # A = 1
    p = (2 * ellipk(np.sin(angle / 2) ** 2) / rod.L) ** 2
    seed = solve(Case(rod, flat, Ends(beta0=0.95 * angle, betaL=-0.95 * angle, FZ=-p)), choose=0)
    found = solve(Case(rod, flat, Ends(M10=0.0, M1L=0.0, FZ=-p)), seed=seed)
    assert found.outcome == "solved"
    assert found.reactions["beta0"] == pytest.approx(angle, rel=1e-7)
    assert found.reactions["betaL"] == pytest.approx(-angle, rel=1e-7)
    height = solve(Case(rod, flat, Ends(M10=0.0, M1L=0.0, height=float(found.z[-1]))), seed=seed)
    assert height.reactions["FZ"] == pytest.approx(-p, rel=1e-8)
    for one, name in ((found, "phi"), (height, "z")):
        mesh = discrete_index(one.problem, one.trajectory, ("dbeta0", "dbetaL", "lam", "mu", name), 1.25, 80)
        assert one.held_index == mesh


def discrete_index(problem: EndsProblem, orbit: Any, names: tuple[str, ...], ratio: float, n: int = 240) -> int:
    """Negative eigenvalues of the second variation on a mesh, under the constraints that the ends impose.

    orbit: an orbit, or a trajectory of one rod on nodes.
    """
    span = float(problem.span[0])
    h, t = span / n, np.linspace(0, span, n + 1)[None]
    on_nodes = getattr(orbit, "shapes", None)
    beta = orbit.at(t)[0][0] if on_nodes is None else on_nodes.of(0).at(t[0])[:, 0]
    weight = np.full(n + 1, h)
    weight[[0, -1]] = h / 2
    matrix = np.diag(np.r_[1, np.full(n - 1, 2), 1] / h - slope_rate(problem, beta) * weight)
    matrix -= (np.eye(n + 1, k=1) + np.eye(n + 1, k=-1)) / h
    if "turn" in names:
        row = np.cos(2 * beta) * weight
        matrix += np.outer(row, row) / (ratio * span)
    rows = [f(beta) * weight for name, f in (("z", np.sin), ("alpha", np.cos)) if name in names]
    inner = slice(0 if "dbeta0" in names else 1, n + 1 if "dbetaL" in names else n)
    matrix = matrix[inner, inner]
    if rows:
        q, _ = np.linalg.qr(np.array(rows)[:, inner].T, mode="complete")
        free = q[:, len(rows) :]
        matrix = free.T @ matrix @ free
    return int((np.linalg.eigvalsh(matrix) < 0).sum())


@pytest.mark.slow
def test_a_hinged_end_keeps_index_and_bends_along_a_branch() -> None:
    """A turning point at the hinge itself is no bend, whichever side of the end rounding puts it."""
    seed, told = None, []
    for height in (4.25, 4.0, 3.75, 3.5):
        found = solve(Case(SHORT, DRUM, Ends("20deg", M1L=0.0, rotation="90deg", height=height)), seed=seed)
        seen = observe(found, ["bends", "index"])
        mesh = discrete_index(found.problem, found.trajectory, ("beta0", "dbetaL", "z", "lam", "turn"), 1.25)
        assert found.held_index == mesh
        told.append((int(seen["bends"]), int(seen["index"]), int(found.held_index)))
        seed = found
    assert len(set(told)) == 1, told


KINDS = (
    ("beta0", "betaL", "z", "alpha", "turn"),
    ("beta0", "betaL", "z", "lam", "mu"),
    ("beta0", "betaL", "phi", "lam", "turn"),
    ("dbeta0", "betaL", "phi", "lam", "mu"),
    ("dbeta0", "dbetaL", "phi", "lam", "mu"),
    ("dbeta0", "dbetaL", "z", "alpha", "turn"),
)


def named(names: tuple[str, ...]) -> Given:
    """Given numbers of which an index needs the names alone."""
    return Given(names, np.zeros(5), 1.0, 1.25)


def table_1_between_ends() -> Case:
    sol = solve(TABLE)
    FZ, MZ, M3 = TABLE.loads
    return replace(TABLE, given=Ends(TABLE.given.beta, float(sol.beta[-1]), FZ, MZ, M3))


def test_clamped_positions_lower_the_index_of_two_equilibria_of_table_1() -> None:
    case = table_1_between_ends()
    problem, found = reduce(case), equilibria(case)
    assert isinstance(problem, EndsProblem)
    dead, held, slopes = [], [], []
    for one in found:
        path = path_of(one.path, 0)
        dead.append(one.index)
        slopes.append(one.dbeta0)
        held.append(int(index_of(OrbitState(problem, path, orbit_rates(problem, [path])), named(KINDS[0]))))
    changed = {(round(slope, 6), a, b) for slope, a, b in zip(slopes, dead, held, strict=True) if a != b}
    assert changed == {(0.5, 6, 5), (0.217255, 5, 4)}


@pytest.mark.parametrize("names", KINDS)
def test_the_index_is_that_of_the_constrained_second_variation(names: tuple[str, ...]) -> None:
    case = table_1_between_ends()
    problem, found = reduce(case), equilibria(case)
    assert isinstance(problem, EndsProblem)
    for one in found[-2:]:
        path = path_of(one.path, 0)
        mine = index_of(OrbitState(problem, path, orbit_rates(problem, [path])), named(names))
        assert mine == discrete_index(problem, orbit_of(problem, path), names, 1.25)


@pytest.mark.parametrize("given", (
    pytest.param({"beta0": 0.5, "betaL": 0.2, "height": 4.0, "azimuth": 1.0, "rotation": 0.5}, marks=pytest.mark.slow),
    {"beta0": 0.5, "M1L": 2.0, "height": 4.0, "M3": 3.0},
    pytest.param({"M10": -3.0, "betaL": 0.2, "FZ": -10.0, "rotation": 0.5}, marks=pytest.mark.slow),
))  # fmt: skip
def test_derivatives_by_every_field_agree_with_differences(given: dict[str, float]) -> None:
    case = Case(SHORT, DRUM, Ends(**given))
    sol = solve(case, stations=5, tol=1e-11)
    fields = [name for name in fields_of(case) if name not in ("alpha0", "gamma0")]
    found = sol.sensitivity(fields, ["energy"])
    assert found.solved, found.outcome
    for k, name in enumerate(fields):
        size = 2e-5 * (max(1.0, case.rod.E) if name == "E" else 1.0)
        up, down = (solve(moved(case, name, sign * size), tol=1e-11, stations=5, seed=sol) for sign in (1, -1))
        for key in ("beta", "z", "alpha", "gamma"):
            wanted = (getattr(up, key) - getattr(down, key)) / (2 * size)
            assert getattr(found, key)[k] == pytest.approx(wanted, rel=1e-5, abs=1e-6), (name, key)
        wanted = (observe(up, ["energy"])["energy"] - observe(down, ["energy"])["energy"]) / (2 * size)
        assert found.observables["energy"][k] == pytest.approx(wanted, rel=1e-5, abs=1e-5), name


@pytest.mark.parametrize("length", (slow(3.0), 20.0, slow(60.0)))
def test_a_compressed_pipe_with_a_hinge_is_straight_or_ends_next_to_its_helix(length: float) -> None:
    """The distance from the helix at the hinge falls exponentially with the length: collocation does not need it."""
    pipe = Rod(E=2.1e11, nu=0.3, a=0.0635, L=length, inner_radius=0.0543)
    found = solve(Case(pipe, Cylinder(0.108, side="inside"), Ends(beta0=0.0, M1L=0.0, FZ=-1e5)))
    assert found.outcome == "solved"
    assert found.held_index == 0
    assert abs(found.dbeta[-1]) < 1e-12
    if length <= 5:  # below the load at which it buckles
        assert not found.beta.any()
        return
    rho, rate = 0.108 - 0.0635, 0.02
    phi = -1e5 * rho**2 / pipe.bending_stiffness
    helix = np.sign(found.beta[-1]) * brentq(lambda b: 2 * np.sin(b) ** 2 * np.cos(b) + phi, 0.0, 0.5, xtol=1e-15)

    def bent(_: Any, y: Any) -> Any:
        """beta/helix over 0.02 s/rho, from the bending energy of beta' and sin(beta)^2/rho and the work of FZ."""
        s, c = np.sin(helix * y[0]), np.cos(helix * y[0])
        return np.array([y[1], (2 * s * s * c + phi) * s / (helix * rate**2)])

    x = rate * found.s / rho
    guess = np.array([1 - np.exp(-x), np.exp(-x)])
    other = solve_bvp(bent, lambda a, b: np.array([a[0], b[1]]), x, guess, tol=1e-10, max_nodes=20000)
    assert other.success
    np.testing.assert_allclose(found.beta / helix, other.sol(x)[0], atol=1e-8)
    assert 0 < 1 - found.beta[-1] / helix < 4 * np.exp(-0.39 * length)  # the decay about the helix is 0.39 per m


@pytest.mark.parametrize("turned", [1e9, -1e9])
def test_a_rod_twisted_by_many_turns_has_the_twisting_moment_of_its_twist_or_says_why_not(turned: float) -> None:
    sol = solve(Case(SHORT, DRUM, Ends("20deg", "20deg", rotation=np.radians(turned))))
    assert sol.outcome.startswith("solved" if sol.solved else "failed: ")
    if sol.solved:
        expected = SHORT.torsional_stiffness * np.radians(turned) / 5.0
        assert pytest.approx(expected, rel=1e-6) == sol.M3  # swirl is < 10 rad


def test_a_rod_that_cannot_be_carried_to_its_held_ends_is_told_nothing_of_a_range() -> None:
    sol = solve(Case(Rod(E=2e9, nu=0.3, a=0.001, L=1.0), Cylinder(R=0.1), Ends(0.0, "1e5 rad", height=0.5)))
    assert sol.outcome.startswith("failed: the branch of the start could not be followed to the held ends: ")
    assert "range" not in sol.outcome


def test_a_rod_with_a_hinge_at_its_start_is_followed_from_height_to_height() -> None:
    def case(height: float) -> Case:
        return Case(
            Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75), Ends(M10=0.0, betaL="20deg", height=height)
        )

    sol = solve(case(4.6))
    for height in np.linspace(4.55, 2.6, 40):
        sol = solve(case(height), seed=sol)
        assert sol.solved, (height, sol.outcome)


@pytest.mark.parametrize(
    ("E", "L", "R", "side", "ends"),
    [
        (1.07e4, 5.0, 0.75, "outside", Ends(0.001, 0.001, height=4.9)),
        (267.0, 10.0, 0.4155, "inside", Ends(0.6908, 0.3628, height=5.3364)),
        (1.07e4, 500.0, 0.75, "outside", Ends(0.3, 0.3, height=400.0)),
        (1.07e4, 5.0, 0.75, "outside", Ends(0.2, 0.2, height=4.999)),
    ],
)
def test_rods_that_are_pushed_far_or_pulled_taut_are_solved_and_stable(E, L, R, side, ends) -> None:
    sol = solve(Case(Rod(E=E, nu=0.25, a=0.25, L=L), Cylinder(R=R, side=side), ends))
    assert sol.solved, sol.outcome
    assert sol.held_index == 0


@pytest.mark.parametrize(("short", "off"), [(1e-4, 1e-3), (1e-6, 1e-5)])
@pytest.mark.parametrize("is_ring", [True, False])
def test_a_taut_rod_pulls_as_the_bends_of_its_clamped_ends_say(short, off, is_ring) -> None:
    """Under a tension k^2 an end at an angle d to it shortens a long rod by (4/k) sin(d/4)^2, exactly."""
    rod, drum, chord = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0), Cylinder(R=0.75), np.pi / 2 if is_ring else 0.5
    azimuth, height = 20 * (1 - short) * np.sin(chord), 20 * (1 - short) * np.cos(chord)  # rho = 1
    loads = {"FZ": -1.0} if is_ring else {"height": height}
    sol = solve(Case(rod, drum, Ends(1.0, 2.0 if is_ring else 0.3, azimuth=azimuth, **loads)))
    assert sol.solved, sol.outcome
    assert sol.held_index == 0
    beta0, betaL = (float(sol.beta[i]) for i in (0, -1))
    way = float(np.arctan2(sol.MZ, sol.FZ)) if not is_ring else chord
    k = float(np.sqrt(np.hypot(sol.MZ, sol.FZ) / rod.bending_stiffness))
    lost = 20 - (azimuth * np.sin(way) + (0 if is_ring else height * np.cos(way)))
    assert 4 * (np.sin((np.array([beta0, betaL]) - way) / 4) ** 2).sum() / k == pytest.approx(lost, rel=off)


def test_a_rod_between_hinges_follows_its_pull_though_it_could_rest_turned_over() -> None:
    for FZ, beta in ((1.0, 0.0), (-1.0, np.pi)):
        case = Case(SHORT, DRUM, Ends(M10=0.0, M1L=0.0, FZ=FZ, MZ=0.0, M3=0.0))
        sol = solve(case)
        assert sol.held_index == 0
        assert np.cos(sol.beta) == pytest.approx(np.cos(beta), abs=1e-12)
        assert sum(found.index == 0 for found in equilibria(case)) > 1


def test_a_rod_between_hinges_without_any_load_lies_along_the_cylinder_and_hardly_resists_turning() -> None:
    """Its energy is the integral of sin(beta)^4, so that half of the digits are lost, and more."""
    sol = solve(Case(SHORT, DRUM, Ends(M10=0.0, M1L=0.0, FZ=0.0, MZ=0.0, M3=0.0)))
    assert sol.outcome.startswith("solved; fewer digits")
    assert np.abs(np.sin(sol.beta)).max() <= sol.error < 1e-3


def test_a_hinged_rod_that_rests_at_its_far_end_is_its_own_seed() -> None:
    ends = Ends(M10=-0.027223322295329325, M1L=0, azimuth=-0.2775656008475698, M3=-0.005206395614304313)
    case = Case(Rod(E=145.6711216760269, nu=0.09843019864972385, a=0.25, L=30), Cylinder(R=1.1240044064931354), ends)
    sol = solve(case)
    assert sol.solved
    assert float(solve(case, seed=sol).FZ) == pytest.approx(float(sol.FZ), rel=1e-9)


@pytest.mark.parametrize("slack", (1e-7, 1e-10))
@pytest.mark.parametrize(("beta0", "betaL", "chord"), ((-0.16, 0.15, 0.0), (0.4, -0.75, -0.27), (0.23, -0.61, -0.11)))
def test_a_rod_that_is_pulled_almost_straight_bends_at_its_ends_as_a_beam_under_tension_does(
    slack: float, beta0: float, betaL: float, chord: float
) -> None:
    """beta'' = T sin(beta - aim) next to an end, so beta_t = -2 T^(1/2) sin((beta - aim)/2), and over the length both
    ends are nearer by 4 sum(sin(bend/4)^2)/T^(1/2) in all. aim: the angle at which the tension T pulls; between bends
    that differ it is not that of the chord."""
    L = 10.0
    far = L * (1 - slack)
    ends = Ends(beta0, betaL, height=far * np.cos(chord), azimuth=far * np.sin(chord))
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=L), Cylinder(0.9), ends), tol=1e-6)
    assert sol.solved
    FZ, MZ = (float(sol.reactions[name]) for name in ("FZ", "MZ"))
    tension, aim = np.hypot(FZ, MZ), np.arctan2(MZ, FZ)
    bends = np.array([beta0, betaL]) - aim
    # the curvature of the cylinder adds a part 1/T, and the next term of the shortening is smaller by T^(-1/2)
    assert sol.dbeta[0] == pytest.approx(-2 * np.sqrt(tension) * np.sin(bends[0] / 2), rel=1 / tension + FAINT)
    nearer = 4 * (np.sin(bends / 4) ** 2).sum() / np.sqrt(tension)
    apart = np.hypot(ends.height, ends.azimuth)
    assert nearer == pytest.approx(L - apart, abs=nearer / np.sqrt(tension) + FAINT * L)
