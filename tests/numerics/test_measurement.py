"""Every observable of random rods and of localised ones is right to what it says of itself."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, solve
from solver.methods import available
from solver.observe import cautions
from solver.observe.measurement import MeasuredNumbers
from solver.observe.observables import OBSERVABLES, error_name, observe
from solver.orbits.periodic_orbit import LIBRATION
from solver.problem.quantities import QUANTITIES
from tests.cases import in_units_of_rho, random_rods
from tests.slow import slow

TOL = 1e-8
REFERENCES = np.load(Path(__file__).parents[1] / "march_references.npz")  # benchmarks/make_march_references.py
BOTH = [name for name in ("orbit", "swing") if name in available()]
ESTIMATED = [name for name in OBSERVABLES if error_name(name)]
by_both = pytest.mark.parametrize("method", BOTH)


def numbers_of(sol: Any) -> np.ndarray:
    p = sol.problem
    return np.stack([p.lam, p.mu, p.phi, p.span, p.beta0, p.dbeta0], axis=1)


@by_both
@pytest.mark.parametrize(("count", "seed", "reach", "reference"), [(4, 1, 12.0, "few"), slow(100, 2, 30.0, "many")])
def test_observables_of_random_rods_are_right_to_their_own_error(count, seed, reach, reference, method: str) -> None:
    sol = solve(random_rods(count, seed, reach), tol=TOL, method=method, stations=2)
    got = observe(sol, ESTIMATED, errors=True)
    given = numbers_of(sol)
    checked = 0
    for i, row in enumerate(REFERENCES[f"observed {reference}"]):
        if not (sol.solved[i] and np.isfinite(row).all()):
            continue
        true = dict(zip(REFERENCES["names"].tolist(), row, strict=True))
        true["energy"] = true["routh"] - given[i, 1] ** 2 * 1.25 * given[i, 3] / 2  # M3^2 L/(2C), nu = 1/4
        units = {"attached": 1.0, "amplitude": 1.0}
        contact = max(abs(true["push_min"]), abs(true["push_max"]))
        units |= dict.fromkeys(("push_min", "push_max", "push_mean", "pull_mean", "contact_size_mean"), contact)
        units |= dict.fromkeys(("kappa_max", "kappa_mean"), true["kappa_max"])
        heights = (true["kappa_max"] ** 2 + np.abs(given[i, :3]).sum() + given[i, 1] ** 2) * given[i, 3]
        units |= dict.fromkeys(("energy", "bending_energy"), heights)
        for name, unit in units.items():
            off = abs(got[name][i] - true[name])
            rounding = 1e-13 * unit  # of A and rho, which are 1 to an eps, and of the sums of the comparison
            assert off <= got[f"{name}_error"][i] + rounding, (i, name, off, got[f"{name}_error"][i])
            if name != "attached":
                assert off <= max(TOL, 1e-12) * max(1, sol.condition[i]) * unit, (i, name, off, unit)
            elif abs(true["push_min"]) > 1e-6 * contact and abs(true["push_max"]) > 1e-6 * contact:
                assert off <= 1e-6 * max(1, sol.condition[i]), (i, name, off)
        checked += 1
    assert checked > 0.8 * given.shape[0]


def localised(b: float) -> Case:
    """No load and h = 0: cot(beta) = cot(beta0) - t, bent once round within a few rho of its middle."""
    a = 0.01
    s, c = np.sin(b), np.cos(b)
    rod = Rod(E=1 / (np.pi / 4 * a**4), nu=0.25, a=a, L=2 / np.tan(b))
    return Case(rod, Cylinder(1 - a), Start(b, s**2, M3=0.0, F3=-(s**4), F2=s**3 * c))


@by_both
@pytest.mark.parametrize("length", [2e3, 2e4, 1e6])
def test_observables_of_a_localised_rod_are_those_of_the_closed_form(length: float, method: str) -> None:
    """kappa = sqrt(2) sin^2, push = sin^4 (2 - 12 cos^2), dt = d cot(beta): all by hand."""
    sol = solve(localised(np.arctan(2 / length)), tol=1e-8, method=method)
    u, L = float(sol.problem.span[0]) / 2, float(sol.problem.span[0])
    got = observe(sol, ESTIMATED, errors=True)
    energy = np.arctan(u) + u / (1 + u * u)  # integral of sin^4 dt
    edge = 1 / np.sqrt(5)
    x, w = np.polynomial.legendre.leggauss(40)
    pushed = edge * (w @ ((2 - 10 * (edge * x) ** 2) / (1 + (edge * x) ** 2) ** 3))
    exact = {
        "bending_energy": energy, "energy": energy, "push_max": 2.0, "kappa_max": np.sqrt(2), "attached": 2 * edge / L,
        "push_mean": pushed / L, "twist_energy": 0.0,
        "kappa_mean": np.sqrt(2) * 2 * np.arctan(u) / L, "amplitude": np.pi - 2 * np.arctan(1 / u),
    }  # fmt: skip
    for name, value in exact.items():
        # what hangs on the tails of the rod hangs on the last bits of its start, and says so
        lost = got[f"{name}_error"] if name in ("kappa_mean", "amplitude") else 0
        assert got[name] == pytest.approx(value, rel=1e-9, abs=lost), name


@by_both
def test_a_largest_value_at_the_far_end_is_not_missed(method: str) -> None:
    """Half a bend short of its largest curvature: the largest is that of the end, beyond the last even panel."""
    case = in_units_of_rho(0, 0, 0, 2.1, np.pi / 6, 0.0)
    sol = solve(case, tol=1e-10, method=method, stations=5)
    assert observe(sol, ["kappa_max"])["kappa_max"] == pytest.approx(sol.kappa[-1], rel=1e-13)


@pytest.mark.parametrize("F3", [-10.0, 0.0, 10.0])
@pytest.mark.parametrize("M3", [0.0, 0.3])
@pytest.mark.parametrize("side", ["outside", "inside"])
def test_a_straight_rod_along_the_cylinder_is_not_attached(F3: float, M3: float, side: str) -> None:
    sol = solve(Case(Rod(1e4, 0.3, 0.25, 20.0), Cylinder(1.0, side), Start(0.0, 0.0, M3=M3, F3=F3)))
    got = observe(sol, ["attached", "push_mean", "pull_mean", "push_max"])
    assert got["attached"] == 0
    assert abs(got["push_max"]) < 1e-12 * abs(F3 + M3 + 1)
    assert got["push_mean"] == got["pull_mean"] == 0


def test_energy_is_bending_and_twist_less_the_work_of_the_three_loads() -> None:
    case = in_units_of_rho(0.4, 0.7, -0.8, 30.0, 0.7, 0.4)
    sol = solve(case, tol=1e-11, stations=2)
    got = observe(sol, ["energy", "bending_energy", "twist_energy", "height", "turns_around"])
    work = sol.FZ * got["height"] + sol.MZ * 2 * np.pi * got["turns_around"] + sol.M3 * (sol.gamma[-1] - sol.gamma[0])
    assert got["twist_energy"] == pytest.approx(sol.M3**2 * 30.0 / (2 * case.rod.torsional_stiffness), rel=1e-14)
    assert got["energy"] == pytest.approx(got["bending_energy"] + got["twist_energy"] - work, rel=1e-10)


def test_pushes_and_pulls_add_up() -> None:
    for side, sign in (("outside", 1), ("inside", -1)):
        case = in_units_of_rho(0.3, 0.2, 0.1, 40.0, 0.5, 0.6, side)
        sol = solve(case, tol=1e-10, stations=20001)
        got = observe(sol, ["push_mean", "pull_mean", "contact_size_mean", "push_min", "push_max"])
        mean = np.trapezoid(sign * sol.contact, sol.s) / 40.0
        assert got["push_mean"] - got["pull_mean"] == pytest.approx(mean, abs=1e-5)  # step^2 of the rule
        assert got["push_mean"] + got["pull_mean"] == pytest.approx(got["contact_size_mean"], rel=1e-14)
        assert min(got["push_mean"], got["pull_mean"], -got["push_min"], got["push_max"]) > 0


def test_every_measured_observable_states_its_error_and_has_a_row_for_it() -> None:
    sol = solve(in_units_of_rho(0.3, 0.2, 0.1, np.array([4.0, 40.0]), 0.5, 0.6), stations=2)
    got = observe(sol, ESTIMATED, errors=True)
    for name in ESTIMATED:
        error = got[f"{name}_error"][np.isfinite(got[name])]
        assert np.isfinite(error).all(), name
        assert (error >= 0).all(), name
        assert error.size == (0 if name == "neutral_at" else 2), name  # the axial force is constant: it is nowhere 0
        assert QUANTITIES[f"{name}_error"].dimension == QUANTITIES[name].dimension


def test_what_a_march_gives_is_within_its_error_or_said_not_to_be_known() -> None:
    case = in_units_of_rho(0.3, 0.2, 0.1, 20.0, 0.5, 0.6)
    names = [name for name in ESTIMATED if name not in ("bend_number", "neutral_at")]
    true = observe(solve(case, tol=1e-11), names)
    for stations in (101, 401, 2001):
        got = observe(solve(case, tol=1e-9, method="dop853", stations=stations), names, errors=True)
        for name in names:
            assert abs(got[name] - true[name]) <= got[f"{name}_error"] + 1e-12, (name, stations)
    few = observe(solve(case, tol=1e-9, method="dop853", stations=5), [*names, "bends"], errors=True)
    for name in ("kappa_max", "push_min", "attached", "energy"):
        assert np.isnan(few[f"{name}_error"]), name
    assert np.isnan(few["bends"])


@by_both
def test_the_smallest_and_the_largest_angle_of_a_libration_are_those_of_beta_along_the_rod(method: str) -> None:
    E, L = np.array([2e3, 1e4, 4e4])[:, None], np.array([0.3, 3.0, 20.0, 35.0])  # before, and after the first bends
    starts = (
        Start(beta=0.5, dbeta=0.5, F1=5.0, F3=10.0),
        Start(beta=0.5, dbeta=-0.5, F1=5.0, F3=-10.0),
        Start(beta=-0.2, dbeta=0.3, M3=1.0, F3=-20.0),
        Start(beta=0.3, dbeta=0.0, M3=0.0, F3=-20.0),
    )
    for start in starts:
        rod = Rod(E=E, nu=0.25, a=0.25, L=L, stiffness="paper")
        sol = solve(Case(rod, Cylinder(R=0.75), start), 1e-9, method, 4001)
        read, librates = MeasuredNumbers(sol), sol.trajectory.orbit.kind == LIBRATION
        assert librates.any()
        beta_of = sol.beta.reshape(-1, 4001)[librates]
        step = np.abs(np.diff(beta_of)).max(axis=-1)  # an extremum lies between two stations
        low, high = read.value("low")[librates], read.value("high")[librates]
        for found, stored in ((low, beta_of.min(axis=-1)), (-high, -beta_of.max(axis=-1))):
            assert (found <= stored + 1e-9).all()
            assert (found >= stored - step).all()


@by_both
def test_the_error_of_the_half_period_of_a_rod_that_ends_before_its_turning_point_is_told(method: str) -> None:
    """The rod begins beside a helix; its turning point is 13.6 times its length away: no beta of it has the error."""
    case = in_units_of_rho(6.66858462, -0.02516198, 23.01267836, 0.27174963, 0.28210101, 0.0)
    got = observe(solve(case, tol=TOL, method=method, stations=2), ["bend_number"], errors=True)
    off = abs(got["bend_number"] - 0.0735592752941880501)  # quadrature of 40 digits
    assert off <= got["bend_number_error"]
    assert got["bend_number_error"] < 1e-5


def test_stations_that_show_no_shape_are_not_measured() -> None:
    """At 1e40 N a march leaves beta next to 1e38 rad: seconds a rod for numbers that mean nothing."""
    case = Case(Rod(1.07e4, 0.25, 0.25, 20.0), Cylinder(0.75), Start([0.5, 0.6], 0.5, F1=[3.4e40, 5.0], F3=10.0))
    seen = observe(solve(case, method="rk4", steps=4), ["kappa_max", "attached", "push_mean", "bending_energy"])
    for value in seen.values():
        assert np.isfinite(value).tolist() == [False, True]


def test_cautions_measure_nothing_again_and_derivatives_leave_what_is_measured(monkeypatch) -> None:
    rods = Case(Rod(np.linspace(5e3, 4e4, 20), 0.25, 0.25, 20.0), Cylinder(0.75), Start(0.5, 0.5, F1=5.0, F3=10.0))
    sol, measured, whole = solve(rods), [], MeasuredNumbers._measure
    seen = observe(sol, cautions.JUDGED, errors=True)

    def note_and_measure(self: MeasuredNumbers, wanted: set[str], until: float = 1.0, cases: Any = None) -> Any:
        measured.append(until)
        return whole(self, wanted, until, cases)

    monkeypatch.setattr(MeasuredNumbers, "_measure", note_and_measure)
    told = cautions.of_cases(sol, seen)
    assert "pulled" in "".join(told)
    assert 1.0 not in measured
    sol.sensitivity(["E"], ["attached", "push_max"])
    again = observe(sol, cautions.JUDGED, errors=True)
    for name, value in seen.items():
        np.testing.assert_array_equal(again[name], value)
