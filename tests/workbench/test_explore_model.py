"""What the live page shows, without the page."""

import json

import numpy as np
import pytest

from solver import Ends, observe
from solver.observe.observables import OBSERVABLES
from tests.workbench.live import state
from workbench.web.live import page_model
from workbench.web.live.presets import PRESETS
from workbench.words import unit_habits

BY_NAME = {preset.name: preset for preset in PRESETS}


def shape(name: str = "table1", **changes: object) -> page_model.LiveRod:
    return page_model.shape(page_model.study_of(state(name, **changes)))


@pytest.mark.parametrize("name", BY_NAME)
def test_every_preset_is_solved_and_says_its_source_and_units(name) -> None:
    found = shape(name)
    assert found.whole
    units = BY_NAME[name].state["units"]
    assert f"{units['length']} and {units['force']}" in BY_NAME[name].source
    assert page_model.facts(found)["outcome"] == "solved"
    assert json.loads(json.dumps(page_model.numbers(found)))["rows"]


def test_the_pipe_has_the_bending_stiffness_of_its_hollow_section() -> None:
    rod = shape("pipe").sol.case.rod
    hollow = 206e6 * np.pi / 64 * (0.1270**4 - 0.1086**4)  # kN m^2
    assert rod.bending_stiffness == pytest.approx(hollow, rel=1e-12)


def test_the_dna_has_its_stiffnesses_and_the_nucleosomes_left_handed_superhelix() -> None:
    found = shape("dna").sol
    kT = 1.380649e-2 * 298  # pN nm
    assert found.case.rod.bending_stiffness == pytest.approx(50 * kT, rel=2e-3)
    assert 386 < found.case.rod.torsional_stiffness < 448
    assert found.case.rho == pytest.approx(4.18)
    turns = found.alpha[-1] / (2 * np.pi)
    assert turns == pytest.approx(-1.65, abs=0.005)  # round the other way as it rises
    assert found.z[-1] / -turns == pytest.approx(2.39, abs=0.005)  # the digits of the source


def test_a_tight_cable_presses_with_its_tension_over_the_radius() -> None:
    found = shape("cable")
    np.testing.assert_allclose(found.sol.push, 10e3 / 190.0, rtol=1e-3)  # the lay is a degree off the hoop's
    assert found.sol.alpha[-1] / (2 * np.pi) == pytest.approx(5.0, abs=0.01)


def test_a_rod_of_many_bends_gets_more_stations_and_a_very_long_one_is_shown_in_part() -> None:
    many = shape(L=200.0)
    assert (np.abs(np.diff(many.sol.beta)) < page_model.CHORD * 1.01).all()
    assert many.whole
    part = shape(L=2e4)
    assert not part.whole
    assert part.sol.s.size == page_model.MOST
    assert "Only the first" in page_model.facts(part)["notes"][0]


def test_of_more_equilibria_than_can_be_looked_through_the_default_one_is_shown() -> None:
    pipe = shape("pipe")
    middle = np.degrees(abs(pipe.sol.beta[pipe.sol.s.size // 2]))
    A, rho = pipe.sol.case.rod.bending_stiffness, float(pipe.sol.case.rho)
    # Lubinski's helix, F = 2 A sin(beta)^2 / rho^2, to the first order in beta, which is 0.013 rad
    assert middle == pytest.approx(np.degrees(np.sqrt(200.0 * rho**2 / (2 * A))), rel=1e-3)
    energy = float(observe(pipe.sol, ["energy"])["energy"])
    named = state("pipe") | {"equilibrium": {"dbeta0": float(pipe.sol.dbeta[0]), "energy": energy}}
    np.testing.assert_array_equal(page_model.shape(page_model.study_of(named)).sol.beta, pipe.sol.beta)
    other = page_model.study_of(state("pipe") | {"equilibrium": {"dbeta0": 0.2, "energy": 0.0}})
    np.testing.assert_array_equal(page_model.shape(other, lost=True).sol.beta, pipe.sol.beta)


def test_each_listed_equilibrium_is_a_point_of_a_branch_with_its_own_numbers() -> None:
    study = page_model.study_of(state("pipe", L=2.0))
    rows = page_model.list_equilibria(study)
    drawn = page_model.follow_branches(study, "FZ", -205.0, -200.0)
    names = ("field", "dbeta0", "height", "energy")
    points = np.concatenate([[piece[name] for name in names] for piece in drawn["pieces"]], axis=1)
    assert len(rows) > 2
    assert drawn["missing"] == 0
    for row in rows:
        wanted = [-200.0, row["dbeta0"], row["height"], row["energy"]]
        assert np.isclose(points.T, wanted, rtol=1e-6, atol=1e-9).all(axis=1).any(), row["index"]


def test_loads_and_every_observable_are_rows() -> None:
    rows = {row["name"]: row["value"] for row in page_model.numbers(shape())["rows"]}
    assert list(rows) == ["FZ", "MZ", "M3", *(name for name, row in OBSERVABLES.items() if not (row.holds or row.free))]
    assert rows["bends"] == 6
    assert rows["FZ"] == pytest.approx(10 * np.cos(np.pi / 6))


def test_off_the_wall_a_number_has_the_digits_that_its_error_allows() -> None:
    one, names = shape("pipe", L=30.0, contact="unilateral"), ("push_max", "kappa_max")
    seen = {name: float(value) for name, value in observe(one.sol, names, errors=True).items()}
    rows = {row["name"]: row["value"] for row in page_model.numbers(one)["rows"]}
    for name in names:
        wanted = float(unit_habits.within(seen[name], seen[f"{name}_error"]))
        assert rows[name] == page_model.facts(one)["numbers"][name] == wanted != seen[name]


def test_the_warnings_are_those_of_the_shape() -> None:
    assert "The rod passes through itself." in page_model.numbers(shape())["warnings"]
    assert page_model.numbers(shape("cable"))["warnings"] == []


def test_the_cable_has_the_ends_and_loads_of_its_helix() -> None:
    case = page_model.study_of(state("cable")).case()
    ends = Ends.helix(case.rod, case.cylinder, 1e4, np.radians(89.0))
    for name in ("beta0", "betaL", "FZ", "MZ", "M3"):
        assert getattr(case.given, name) == pytest.approx(getattr(ends, name), rel=1e-12)


def test_a_state_gives_no_notice_on_its_numbers(recwarn) -> None:
    base = {"EI": 1.0, "GJ": 1.0, "a": 0.05, "L": 4.0, "R": 1.0, "beta0": 4.4, "betaL": 4.4, "FZ": -0.1}
    study = page_model.study_of({"units": {"length": "m", "force": "N"}, "base": base})
    assert study.base.given["beta0"] == 4.4
    assert not recwarn
