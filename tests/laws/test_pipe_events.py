"""The loads at which a long horizontal pipe changes its state, and a string about its neutral point, from `solve`."""

from typing import Any

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from benchmarks.pipe_events import HELIX, SINUSOID, HalfWave, energy, events, push_min, wave_number
from solver import Case, Cylinder, Ends, Rod, Start, observe, solve
from solver.nodes.pipe_states import HELICAL, SINUSOIDAL, STRAIGHT, axial_force_along, azimuths, states
from workbench.words import caution_words
from workbench.words.pipe_profile import axial_force, place_in_words, profile

PIPE: dict[str, Any] = {"E": 2.06e8, "nu": 0.3, "a": 0.0635, "inner_radius": 0.0543, "weight": 0.241}  # kN and m


@pytest.mark.slow
def test_the_six_events_of_a_long_horizontal_pipe() -> None:
    expected = [2.0, 2.744687, 2.790434, 2.901122, 3.541672, 5.2613]
    digits = [1e-6] * 5 + [5e-5]
    for found, value, within in zip(events().values(), expected, digits, strict=True):
        assert found == pytest.approx(value, abs=within)


def test_helix_and_sinusoid_of_a_long_pipe_have_equal_energy_at_one_load() -> None:
    sinusoid, helix = HalfWave(SINUSOID).best(2.901122), HalfWave(HELIX).best(2.901122)
    assert energy(sinusoid, 2.901122) == pytest.approx(energy(helix, 2.901122), abs=2e-6)
    assert [wave_number(sinusoid), wave_number(helix)] == pytest.approx([0.97200, 1.18620], abs=1e-4)
    assert np.abs(HalfWave(SINUSOID).shape(2.901122, wave_number(sinusoid)).alpha).max() == pytest.approx(
        0.8688, abs=1e-4
    )
    assert min(push_min(sinusoid), push_min(helix)) > 0
    assert sinusoid.held_index == helix.held_index == 0


def test_a_long_string_passes_its_neutral_point_as_painleve_says() -> None:
    """Hastings and McLeod's solution of u'' = x u + 2 u^3 has u(0) = 0.3670615515; far below, it has two series."""
    weight, below, above, deep = 1e-12, 14.0, 10.0, 8.0  # w rho^3/A, and lengths in (A/w)^(1/3)
    size = weight ** (1 / 3)
    rod = Rod(EI=1.0, GJ=1.0, a=0.1, L=(below + above) / size, weight=weight)
    ends = Ends(M10=0.0, betaL=0.0, FZ=above * size**2)
    stations = (below - np.array([below, deep, 0.0, -above])) / size
    sol = solve(Case(rod, Cylinder(R=1.1, side="inside", inclination=0.0), ends), stations=stations)
    assert sol.solved
    assert abs(sol.beta[2]) / size == pytest.approx(0.3670615515, rel=1e-6)
    assert abs(sol.beta[1]) / size == pytest.approx(np.sqrt(deep / 2) * (1 - 1 / (8 * deep**3)), rel=3e-6)
    azimuth = np.sqrt(2) / 3 * deep**1.5 + np.log(2) / 2 + deep**-1.5 / (12 * np.sqrt(2))
    assert abs(sol.alpha[3] - sol.alpha[1]) == pytest.approx(azimuth, rel=1e-6)


def test_a_heavy_cable_on_a_horizontal_drum_is_pulled_as_the_capstan_equation_says() -> None:
    """h2 = e^(mu pi) h1 + R 2 mu/(1 + mu^2) (e^(mu pi) + 1), tensions over the weight, whatever the stiffness."""
    rod, drum = Rod(EI=1e-3, GJ=1e-3, a=0.001, L=np.pi * 0.051, weight=1.0), Cylinder(0.05, "outside", "90deg", 0.3)
    sol = solve(Case(rod, drum, Start("90deg", 0.0, F3=0.15, M3=0.0, alpha="90deg")))
    pulled = sol.MZ / 0.051 - 1e-3 / 0.051**2
    assert pulled == pytest.approx(0.485068915514, abs=1e-12)
    assert (sol.push > 0).all()


def test_dogleg_and_bending_stress_are_those_of_the_curve_in_space() -> None:
    rod = Rod(E=2.06e8, nu=0.3, a=0.0635, inner_radius=0.0543, L=60.0, weight=0.242)
    ends = Ends(beta0=0.0, betaL=0.0, FZ=-220.0)
    sol = solve(Case(rod, Cylinder(0.10795, "inside", "60deg"), ends), stations=4001)
    curve = make_interp_spline(sol.s, sol.position, k=7)
    bend = np.linalg.norm(curve(sol.s, 2), axis=1)[40:-40].max()  # a spline's derivatives are poor at its ends
    most = {row.name: row.largest for row in profile(sol, {"length": "m", "force": "kN"})}
    assert np.degrees(bend * 30) == pytest.approx(most["dogleg"], rel=2e-4)
    assert 2.06e8 * 0.0635 * bend / 1e3 == pytest.approx(most["bending stress"], rel=2e-4)


def vertical_pipe(load: float, azimuth: float | None) -> Case:
    hole = Cylinder(0.10795, "inside", inclination="180deg")
    return Case(Rod(L=1000.0, **PIPE), hole, Ends(beta0=0.0, betaL=0.0, FZ=-load, azimuth=azimuth))


@pytest.mark.parametrize("load", (50.0, 100.0))
@pytest.mark.parametrize("azimuth", (None, 0.0, 2.0))
def test_a_hanging_pipe_is_straight_where_it_is_in_tension_and_the_wall_does_not_push(
    load: float, azimuth: float | None
) -> None:
    """The neutral point of a hanging pipe lies the load over the weight above its foot, whatever its shape."""
    sol = solve(vertical_pipe(load, azimuth), stations=4001)
    neutral = 1000.0 - load / 0.241
    (top, *lower) = sol.states
    assert (top.word, top.begin) == (STRAIGHT, 0.0)
    assert lower[0].word == HELICAL
    assert neutral - 40 < top.end < neutral
    for state in lower:
        inside = (sol.s > state.begin) & (sol.s < state.end) & (sol.s < neutral)
        assert (sol.push[inside] > 0).all()


@pytest.mark.parametrize(("load", "tilt"), [(10.5, 0.0), (13.0, 0.0), (22.0, 0.0), (45.0, 0.5), (130.0, 5.0)])
def test_a_pipe_is_straight_where_the_waves_at_its_foot_have_died_away(load: float, tilt: float) -> None:
    """Above the neutral point nothing decides how often rounding changes the sign of an angle of 1e-30."""
    hole = Cylinder(0.10795, "inside", np.radians(180 - tilt))
    sol = solve(Case(Rod(L=1000.0, **PIPE), hole, Ends(beta0=0.0, betaL=0.0, FZ=-load)), stations=8001)
    top, *lower = sol.states
    assert (top.word, top.begin) == (STRAIGHT, 0.0)
    assert HELICAL in {state.word for state in lower} if load > 100 else [state.word for state in lower] == [SINUSOIDAL]
    quiet, bent = (np.abs(sol.beta[where]).max() for where in (sol.s < top.end, sol.s >= top.end))
    assert quiet < 0.1 * bent
    beside = (sol.s >= top.end) & (sol.s < top.end + 30.0)  # half a wave here is longer
    assert np.abs(sol.beta[beside]).max() > 0.02 * bent


@pytest.mark.parametrize("inclination", ("90deg", "100deg"))
@pytest.mark.parametrize("sliding", ("backward", "rotating", "axial-forward", "axial-backward"))
def test_the_axial_force_follows_from_that_at_the_far_end_the_push_the_weight_and_the_friction(
    sliding: str, inclination: str
) -> None:
    hole = Cylinder(0.10795, "inside", inclination, 0.15, sliding)
    ends = Ends(beta0=0.0, betaL=0.0, FZ=-180.0)
    sol = solve(Case(Rod(L=300.0, **PIPE), hole, ends), stations=12_001)
    along = axial_force_along(hole, 0.241, -180.0, sol.s, sol.beta, sol.push)
    change, expected = along - along[-1], axial_force(sol) + 180.0
    # trapezoids of 25 mm on waves of 20 m; the small change of a pipe that turns is a difference of forces of 180 kN
    assert change == pytest.approx(expected, abs=2e-5 * np.abs(expected).max())


@pytest.mark.parametrize("sliding", ("forward", "axial-forward", "backward", "axial-backward", "rotating"))
@pytest.mark.parametrize("load", (-60.0, -80.0, 30.0))
def test_a_push_arrives_at_the_other_end_of_a_straight_lying_pipe_where_it_exceeds_the_friction(
    sliding: str, load: float
) -> None:
    """Friction is f w L = 72.3 kN; a pipe that is pushed at s = L slides backward, and one that turns has none."""
    hole = Cylinder(0.10795, "inside", "90deg", 0.3, sliding)
    azimuth = {} if sliding == "rotating" else {"azimuth": 0.0}
    sol = solve(Case(Rod(L=1000.0, **PIPE), hole, Ends(beta0=0.0, betaL=0.0, FZ=load, **azimuth)))
    outcome = str(sol.outcome)
    assert sol.solved
    ahead = load + 72.3 if "backward" in sliding else load  # the force at the end ahead
    behind = load if "backward" in sliding else load - 72.3
    lost = ahead > 0 > behind and sliding != "rotating"
    near, far = ("L", "0") if "backward" in sliding else ("0", "L")
    force = f"{'FZ' if sliding.startswith('axial') else 'F3'} = {ahead:.4g}"  # along the way of the rod
    words = f"the push at s = {near} does not arrive at s = {far}, where a tension must pull the rod ({force})"
    assert outcome == (f"solved; {words}" if lost else "solved")


def test_a_bend_whose_middle_is_exactly_along_the_axis_is_a_bend() -> None:
    """A place at which beta is exactly 0 lies within a crossing: without it one azimuth seems to stay."""
    s = np.linspace(0.0, 8.0, 801)
    beta, alpha = np.cos(np.pi * s / 2), np.sin(np.pi * s / 2)
    on_places = np.where(np.isclose(np.cos(np.pi * s / 2), 0), 0.0, beta)
    assert np.count_nonzero(on_places == 0) == 4
    for values in (beta, on_places):
        assert [state.word for state in states(s, values, alpha)] == [SINUSOIDAL]
    assert states(s, on_places, 0.01 * alpha)[0].word == STRAIGHT


@pytest.mark.parametrize("place", (2.0, 3.2, 5.0))
def test_the_states_of_a_reversed_rod_are_the_reversed_states(place: float) -> None:
    """A helix, a straight piece and a sinusoid, at places that no station is on."""
    s = np.linspace(0.0, 20.0, 1501)
    alpha = 12 / (1 + np.exp(-3 * (s - place))) + 0.4 * np.sin(3 * s) / (1 + np.exp(-4 * (s - 8.1)))
    beta = np.gradient(alpha, s)
    there = states(s, beta, alpha, None, (True, False))
    back = states(s[-1] - s[::-1], beta[::-1], -alpha[::-1], None, (False, True))[::-1]
    assert [part.word for part in there] == [part.word for part in back]
    assert {HELICAL, SINUSOIDAL} <= {part.word for part in there}
    ends = [(s[-1] - part.end, s[-1] - part.begin) for part in back]
    np.testing.assert_allclose([(part.begin, part.end) for part in there], ends, atol=1e-9)


@pytest.mark.parametrize(("layer", "words"), [(0.5, [HELICAL]), (5.0, [STRAIGHT, HELICAL, STRAIGHT])])
@pytest.mark.parametrize("backward", [False, True])
def test_an_end_layer_that_is_shorter_than_half_a_turn_belongs_to_the_helix(
    layer: float, words: list[str], backward: bool
) -> None:
    """A helix of five turns between clamps, beside which beta falls to 0; a turn is 20 / 5 long."""
    s = np.linspace(0.0, 20.0 + 2 * layer, 4001)
    beta = np.pi / 2 * np.clip(np.minimum(s, s[-1] - s) / layer, 0.0, 1.0) ** 8
    alpha = np.concatenate([[0.0], np.cumsum((beta[1:] + beta[:-1]) / 2 * np.diff(s))])
    sides = (beta[::-1], -alpha[::-1]) if backward else (beta, alpha)
    parts = states(s, *sides)
    assert [part.word for part in parts] == words
    assert (parts[0].begin, parts[-1].end) == (0.0, s[-1])


def test_the_azimuth_on_the_axis_is_that_of_the_next_place() -> None:
    """It has none there, so an arbitrary one would be a bend at the end of the rod."""
    s, radius = np.linspace(0.0, 1.0, 5), np.array([0.0, 0.1, 0.2, 0.1, 1e-9])
    np.testing.assert_allclose(azimuths(s, np.array([0.0, 2, 3, 4, -7]), radius, 1e-6), [2, 2, 3, 4, 4])
    assert not azimuths(s, s, 0 * s, 1e-6).any()


@pytest.mark.parametrize("turns", (0.3, 0.9, 1.5))
def test_a_part_of_a_hoop_is_helical_and_has_no_bend(turns: float) -> None:
    """The capstan is exact, so beta is 90 degrees but for rounding."""
    rod, drum = Rod(EI=1e-3, GJ=1e-3, a=0.01, L=2 * np.pi * turns), Cylinder(R=0.99, friction=0.3)
    sol = solve(Case(rod, drum, Ends("90deg", "90deg", MZ=100.001)))
    assert [state.word for state in sol.states] == [HELICAL]
    assert sol.bends_at == ()
    assert observe(sol, ["bends"])["bends"] == 0


def test_bends_that_die_away_are_counted_as_far_as_rounding_lets_them_be_seen() -> None:
    """A lying pipe that turns in place leans: its ends bend like exp(-x) cos x over some metres of a kilometre."""
    hole = Cylinder(0.10795, "inside", "90deg", 0.25, "rotating")
    sol = solve(Case(Rod(L=1000.0, **PIPE), hole, Ends(beta0=0.0, betaL=0.0, FZ=-50.0)))
    sizes = np.array([size for _, size in sol.bends_at])
    assert 2 < sizes.size < 40
    assert sizes.min() > 1e-13 * np.abs(sol.beta).max()


def test_lift_off_at_the_ends_leaves_the_middle_half_on_the_wall() -> None:
    """Short rods with weight on a cylinder, which the wall would have to hold in places."""
    rng, kinds = np.random.default_rng(9), set[bool]()
    for _ in range(30):
        L, weight = rng.uniform(2.0, 14.0), 10 ** rng.uniform(-2.0, 0.0)
        wall = Cylinder(R=0.9, inclination=rng.uniform(0, np.pi))
        ends = Ends(rng.normal() * 0.6, rng.normal() * 0.6, FZ=rng.normal() * 2, alpha=rng.uniform(-3, 3))
        sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=L, weight=weight), wall, ends))
        caution = str(sol.caution)
        if "pulled" not in caution or "nearly everywhere" in caution:
            continue
        middle = [(a, b) for a, b in sol.lift_offs if b > 0.2501 * L and a < 0.7499 * L]
        assert ("pulled at the ends" in caution) == (not middle)
        kinds.add(bool(middle))
    assert kinds == {True, False}


@pytest.mark.parametrize("wall", [{}, {"friction": 0.25, "sliding": "forward"}])
@pytest.mark.parametrize(("tilt", "load"), [(0.0, 5.0), (0.0, 45.0), (0.5, 5.0), (1.0, 5.0), (3.0, 5.0), (3.0, 45.0)])
def test_a_pipe_in_tension_that_hangs_in_its_hole_without_a_push_does_not_lift_off(
    tilt: float, load: float, wall: dict[str, Any]
) -> None:
    """Above the neutral point the push is 0 where the hole is vertical, and rounding gave it a sign."""
    if wall and load > 5:
        pytest.skip("with friction this load is not solved")
    rod = Rod(E=30e3, nu=0.3, a=2.5, L=24000.0, inner_radius=2.138, weight=19.5e-3 / 12)  # kip, inch
    hole = Cylinder(4.25, "inside", np.radians(180 - tilt), **wall)
    sol = solve(Case(rod, hole, Ends(beta0=0.0, betaL=0.0, FZ=-load)))
    assert all(end < 600 or begin > 23000 for begin, end in sol.lift_offs)  # next to a clamp
    seen = observe(sol, ["lift_off_at"])
    assert float(seen["lift_off_at"]) == pytest.approx(sol.lift_offs[0][0] if sol.lift_offs else 24000.0)
    assert not caution_words.is_barred(str(sol.caution))


@pytest.mark.parametrize(
    ("L", "inclination", "load", "wall"),
    [
        (60.0, "60deg", 220.0, {}),
        (300.0, "90deg", 200.0, {"friction": 0.2, "sliding": "axial-forward"}),
        (200.0, "90deg", 50.0, {"friction": 0.25, "sliding": "rotating"}),
    ],
)
def test_the_rows_of_a_pipe_are_its_observables(L: float, inclination: str, load: float, wall: dict[str, Any]) -> None:
    rod, hole = Rod(**{**PIPE, "E": 2.06e8, "L": L}), Cylinder(0.10795, "inside", inclination, **wall)
    sol = solve(Case(rod, hole, Ends(beta0=0.0, betaL=0.0, FZ=-load)))
    rows = {row.name: row for row in profile(sol, {"length": "m", "force": "kN"})}
    seen = observe(sol, ["push_max", "push_max_at", "push_middle", "kappa_max", "bending_stress_max", "FZ0", "M30"])
    push = rows["push of the wall"]
    near = {"rel": 1e-7}  # between two of the places at which a row is read last
    assert push.largest == pytest.approx(float(seen["push_max"]), **near)
    assert push.middle == pytest.approx(float(seen["push_middle"]), rel=1e-10)
    assert push.at == pytest.approx(float(seen["push_max_at"]), abs=1e-3)  # flat there
    assert rows["dogleg"].largest == pytest.approx(np.degrees(float(seen["kappa_max"])) * 30, **near)
    assert rows["bending stress"].largest == pytest.approx(float(seen["bending_stress_max"]) / 1e3, **near)
    assert rows["axial force FZ"].start == pytest.approx(float(seen["FZ0"]), rel=1e-12)
    if "torque M3" in rows:
        assert rows["torque M3"].start == pytest.approx(float(seen["M30"]), rel=1e-9)
        assert rows["friction"].middle == pytest.approx(0.25 * push.middle, rel=1e-12)


def test_a_number_that_is_the_same_all_along_a_pipe_is_largest_nowhere() -> None:
    """The stress of 200 kN varies by 1e-5, as the pipe sways; in an inclined hole the weight changes it by 4 %."""
    ends, places = Ends(beta0=0.0, betaL=0.0, FZ=-200.0), []
    for inclination in ("90deg", "60deg"):
        sol = solve(Case(Rod(**PIPE, L=60.0), Cylinder(0.10795, "inside", inclination), ends))
        places.append({row.name: row.at for row in profile(sol, {"length": "m", "force": "kN"})})
    level, steep = places
    for name in ("axial force FZ", "axial stress"):
        assert place_in_words(level[name], "m") == "everywhere"
        assert place_in_words(steep[name], "m") == "at s = 0 m"
    assert place_in_words(level["push of the wall"], "m") == "at s = 60 m"


def test_the_largest_push_of_a_pipe_that_may_leave_the_wall_is_one_number() -> None:
    """It is at a clamp, where the meshes come close as their edges do."""
    hole = Cylinder(0.10795, "inside", "90deg", contact="unilateral")
    sol = solve(Case(Rod(**{**PIPE, "L": 60.0}), hole, Ends(beta0=0.0, betaL=0.0, FZ=-200.0)))
    push = next(row for row in profile(sol, {"length": "m", "force": "kN"}) if row.name == "push of the wall")
    assert push.largest == pytest.approx(float(observe(sol, ["push_max"])["push_max"]), rel=1e-3)


@pytest.mark.parametrize("stations", [6, 9, 40])
def test_a_sinusoid_is_one_however_few_stations_a_wave_has(stations: int) -> None:
    """Next to a change of sign beta may be large at the next station already; that is no part of a hoop."""
    waves = 25
    s = np.linspace(0, waves, stations * waves + 1) + 0.8 / stations
    beta, alpha = np.sin(2 * np.pi * s), -np.cos(2 * np.pi * s)
    assert [state.word for state in states(s, beta, alpha)] == [SINUSOIDAL]
