"""Torque and drag of pipes in a hole: hand formulas of soft strings, and how far a push arrives."""

from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Start, fit, observe, solve
from solver.fits.start_force import with_start_force
from solver.nodes.local_waves import EQUAL, mean_push
from solver.nodes.lock_up import PASSED, lock_up_length

PIPE: dict[str, Any] = {"EI": 1224.0, "GJ": 941.6, "a": 0.0635, "weight": 0.241}  # 5 inch, in kN and m
RHO, FRICTION = 0.04445, 0.25
LYING = 4 * PIPE["EI"] / (FRICTION * RHO)  # over a compression: the length on which a lying helix locks up


def pipe(sliding: str, hole: float, L: float = 300.0, FZ: float = 0.0, friction: float = FRICTION) -> Case:
    """A pipe in a hole of an inclination in degrees, which s runs down."""
    wall = Cylinder(R=0.10795, side="inside", inclination=np.deg2rad(180 - hole), friction=friction, sliding=sliding)
    return Case(Rod(L=L, **PIPE), wall, Ends(beta0=0.0, betaL=0.0, FZ=FZ))


def seen(case: Case, *names: str) -> Any:
    sol = solve(case)
    assert sol.solved, sol.outcome
    found = observe(sol, names)
    return [float(found[name]) for name in names]


@pytest.mark.parametrize("hole", (60.0, 90.0, 120.0))
def test_a_straight_pipe_that_turns_in_place_needs_the_torque_of_a_soft_string(hole: float) -> None:
    """It climbs the wall until the push N and its friction f N balance the weight: N (1 + f^2)^(1/2) = w sin(hole)."""
    across = 0.241 * np.sin(np.deg2rad(hole))
    by_hand = FRICTION * 0.0635 * across * 300 / np.hypot(1, FRICTION)
    torque, at_start = seen(pipe("rotating", hole), "surface_torque", "M30")
    assert torque == pytest.approx(by_hand, rel=2e-3)  # some metres next to the clamps lean less
    assert torque == -at_start


def test_the_torque_of_a_pipe_that_the_wall_pulls_along_most_of_its_length_is_unknown() -> None:
    """A vertical helix that hangs in tension: its pulls would cancel its pushes."""
    case = pipe("rotating", 0.0, 914.4, -44.5)
    pushed, pulled, torque, at_start = seen(case, "push_mean", "pull_mean", "surface_torque", "M30")
    assert pulled > 0.5 * pushed
    assert -at_start == pytest.approx(FRICTION * 0.0635 * (pushed - pulled) * 914.4, rel=1e-6)
    assert np.isnan(torque)
    assert seen(pipe("rotating", 0.0, 914.4), "surface_torque") == [0.0]  # straight


@pytest.mark.parametrize("sliding", ("forward", "axial-backward"))
@pytest.mark.parametrize("M3", (0.0, 0.3))
def test_the_twisting_moment_of_a_pipe_that_slides_is_that_of_its_far_end(sliding: str, M3: float) -> None:
    up = pipe(sliding, 120.0, FZ=-150.0)
    case = Case(up.rod, up.cylinder, Ends(beta0=0.1, betaL=0.0, FZ=-150.0, M3=M3))
    assert seen(case, "M30", "surface_torque") == [M3, -M3]


def test_the_force_that_slides_a_straight_pipe_is_that_of_a_soft_string() -> None:
    along, rubbed = 0.241 * 300 * np.cos(np.pi / 3), FRICTION * 0.241 * 300 * np.sin(np.pi / 3)
    assert seen(pipe("axial-forward", 60.0), "FZ0")[0] == pytest.approx(along - rubbed, rel=1e-9)
    assert seen(pipe("axial-backward", 60.0), "FZ0")[0] == pytest.approx(along + rubbed, rel=1e-9)


def test_a_lying_helix_locks_up_at_nine_tenths_of_the_length_on_which_its_compression_has_no_bound() -> None:
    """1/F falls by f rho/(4 EI) in a unit of length, and a change by the square of F: to 1/100 where F is tenfold."""
    L, force = 900.0, 300.0
    at_start, reach, most = seen(pipe("axial-forward", 90.0, L, -force), "FZ0", "reach", "arriving_max")
    assert reach == pytest.approx(0.9 * LYING / force, rel=1e-9)
    assert most == pytest.approx(0.9 * LYING / L, rel=1e-4)  # as far as it is halved
    assert LYING * (1 / force + 1 / at_start) == pytest.approx(L, rel=0.01)  # a helix with two clamped ends
    changed = seen(pipe("axial-forward", 90.0, L, -force - 0.5), "FZ0")[0]
    passed = -0.5 / (changed - at_start)
    assert passed == pytest.approx((force / at_start) ** 2, rel=0.1)  # two clamped ends


def test_the_length_on_which_a_pipe_locks_up_jumps_at_the_helix_only_by_what_its_push_does() -> None:
    """Of 1/F a tenth is left where the push at both ends is that of a helix; at the far end of a sinusoid, more."""
    across, just = 1e-6, 1e-9
    front = np.sqrt(across) * (2 + EQUAL)
    lengths = [lock_up_length(0.0, across, FRICTION, front * (1 + part)) for part in (-just, just)]
    before, after = (float(mean_push(np.array(EQUAL + part), EQUAL)) for part in (-just, just))
    bounds = [FRICTION * front / 4 * length for length in lengths]  # of the length without bound of the compression
    assert bounds == pytest.approx([1 - np.sqrt(PASSED * after / before), 1 - np.sqrt(PASSED)], rel=1e-6)
    assert 1.02 < bounds[1] / bounds[0] < 1.03


def test_a_straight_pipe_reaches_further_by_the_soft_string() -> None:
    """Each kN less at the bit is another 1/(f w) of lying pipe before the compression is as large."""
    much, little = (seen(pipe("axial-forward", 90.0, 300.0, FZ), "reach")[0] for FZ in (-100.0, -50.0))
    assert little - much == pytest.approx(50 / (FRICTION * 0.241), rel=1e-4)  # the sinusoid begins softly


def test_the_largest_push_that_arrives_over_the_reach_of_a_load_is_that_load() -> None:
    load = 400.0
    reach = seen(pipe("axial-forward", 80.0, 100.0, -load), "reach")[0]
    assert seen(pipe("axial-forward", 80.0, reach * 0.99, -load), "arriving_max")[0] == pytest.approx(load, rel=0.02)
    said = str(solve(pipe("axial-forward", 80.0, reach * 1.25, -load)).outcome)
    assert "locked up" in said
    assert "passes the last 80 % of the length, the reach of this load" in said


def test_a_pipe_that_its_weight_carries_or_that_turns_or_is_pulled_does_not_lock_up() -> None:
    for case in (pipe("axial-forward", 30.0), pipe("rotating", 90.0), pipe("axial-backward", 60.0)):
        assert np.isnan(seen(case, "reach")[0])


@pytest.mark.parametrize("name", ("friction", "weight", "L"))
def test_a_force_at_the_hook_that_is_given_holds_in_a_fit_whatever_field_varies(name: str) -> None:
    """By hand FZ = FZ0 - w L (cos(hole) - f sin(hole)), which is -5 for one value of each."""
    wanted = {"friction": (72.3 * 0.5 - 15) / (72.3 * np.sqrt(3) / 2)}
    scale = 15 / (72.3 * (0.5 - FRICTION * np.sqrt(3) / 2))
    wanted |= {"weight": 0.241 * scale, "L": 300 * scale}
    bounds = (wanted[name] / 2, wanted[name] * 2)
    found = fit(pipe("axial-forward", 60.0), {name: bounds}, {"FZ": -5.0}, FZ0=10.0, starts=2)
    assert found.solved, found.outcome
    assert found.values[name] == pytest.approx(wanted[name], rel=1e-6)
    assert seen(found.case, "FZ0", "FZ") == pytest.approx([10, -5], rel=1e-6)


def test_a_fit_refuses_a_field_or_a_target_that_a_given_force_at_the_hook_decides() -> None:
    case = pipe("axial-forward", 60.0)
    with pytest.raises(InputError, match="FZ follows from it: vary another field"):
        fit(case, "FZ", {"push_max": 1.0}, FZ0=10.0)
    with pytest.raises(InputError, match="it is no target: omit FZ0@axial-backward"):
        fit(case, "friction", {"FZ0@axial-backward": 1.0}, FZ0=10.0)
    for bad, said in ((np.nan, "fit.FZ0 must be finite"), ([1.0, 2.0], "a single FZ0"), ("x", "must be a number")):
        with pytest.raises(InputError, match=said):
            fit(case, "friction", {"push_max": 1.0}, FZ0=bad)  # type: ignore[arg-type]
    start = Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=5.0), Cylinder(1.0), Start(beta=0.5, dbeta=0.1, F1=1.0, F3=1.0))
    with pytest.raises(InputError, match="a start problem does not have"):
        fit(start, "EI", {"kappa_max": 1.0}, FZ0=1.0)


def test_derivatives_under_a_given_force_at_the_hook_are_those_of_differences() -> None:
    def pipe_under(friction: float, FZ0: float) -> Any:
        case = with_start_force(pipe("axial-forward", 80.0, 60.0, friction=friction), FZ0)
        return solve(case, stations=31)

    names = ["FZ", "FZ0", "kappa_max"]
    at, h = pipe_under(0.2, -260.0), 1e-4
    known = at.sensitivity(["friction", "FZ"], names).with_given("FZ0", "FZ")
    assert known.fields == ("friction", "FZ0")
    pairs = (
        (pipe_under(0.2 + h, -260.0), pipe_under(0.2 - h, -260.0)),
        (pipe_under(0.2, -260 + h), pipe_under(0.2, -260 - h)),
    )
    for k, (more, less) in enumerate(pairs):
        assert np.abs(at.beta).max() > 5e-3
        for name in names:
            by_difference = (float(observe(more, [name])[name]) - float(observe(less, [name])[name])) / (2 * h)
            assert known.observables[name][k] == pytest.approx(by_difference, rel=1e-4, abs=1e-5), (name, k)
        by_difference = (more.beta - less.beta) / (2 * h)
        assert known.beta[k] == pytest.approx(by_difference, rel=1e-3, abs=1e-3 * np.abs(by_difference).max())


def test_one_coefficient_is_fitted_to_slack_off_and_pick_up_together() -> None:
    """Hook loads W cos(hole) -+ f W sin(hole): least squares of both."""
    W, hole = 0.241 * 300, np.pi / 3
    targets = {"FZ0": 22.0, "FZ0@axial-backward": 50.0}
    sigma = dict.fromkeys(targets, 1.0)
    found = fit(pipe("axial-forward", 60.0, friction=0.1), "friction", targets, sigma=sigma, starts=1)
    assert found.solved, found.outcome
    assert found.values["friction"] == pytest.approx((50 - 22) / (2 * W * np.sin(hole)), rel=1e-6)
    assert found.share_of("FZ0@axial-backward")["friction"] == pytest.approx(0.5, rel=1e-6)
    off = (22 + 50) / 2 - W * np.cos(hole)
    assert found.residuals == pytest.approx([-off, -off], rel=1e-4)


@pytest.mark.parametrize("inclination", [90.0, 60.0])
def test_the_load_at_which_a_pipe_locks_up_is_the_largest_that_arrives(inclination: float) -> None:
    rod = Rod(E=30e3, nu=0.3, a=2.5, L=60000.0, inner_radius=2.138, weight=19.5e-3 / 12)  # kip, inch
    hole = Cylinder(4.25, "inside", np.radians(180 - inclination), 0.25, "axial-forward")
    easy, locked = (solve(Case(rod, hole, Ends(beta0=0.0, betaL=0.0, FZ=-load))) for load in (20.0, 90.0))
    most = float(observe(easy, ["arriving_max"])["arriving_max"])
    assert f"less than {most:.4g} at s = L" in str(locked.outcome)
