"""What no real rod could do is said of every case, and of the study in one sentence."""

import re
from dataclasses import replace

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, Start, equilibria, solve
from studies.language.loader import loads
from tests.cases import in_units_of_rho
from tests.workbench import small
from workbench.store import dataset, in_memory
from workbench.store.block import columns
from workbench.words import cautions

STEEL = {"E": 2.1e8, "nu": 0.3, "L": 20.0}  # kN and m


def told(case: Case, stations: int = 401) -> str:
    return ", ".join(cautions.keys(str(cautions.of_cases(solve(case, stations=stations), {}))))


def test_a_rope_wound_under_tension_gives_no_cause_for_caution_outside_and_lifts_off_inside() -> None:
    """In tension a helix presses inwards with F3 sin^2(beta)/rho: the cylinder must be within."""
    T, beta = 1000.0, 0.5
    rope = {"rod": Rod(a=0.01, **STEEL), "given": Ends(beta, beta, FZ=T * np.cos(beta), MZ=1.01 * T * np.sin(beta))}
    assert told(Case(cylinder=Cylinder(1.0, "outside"), **rope)) == ""
    assert told(Case(cylinder=Cylinder(1.02, "inside"), **rope)) == "pulled"


def test_a_pipe_pushed_down_its_hole_lifts_off_only_next_to_its_ends() -> None:
    pipe = Case(Rod(a=0.0635, **{**STEEL, "L": 60.0}), Cylinder(0.108, "inside"), Ends(0.0, 0.0, FZ=-200.0))
    sol = solve(pipe, stations=401)
    text = str(cautions.of_cases(sol, unit="m"))
    off = np.minimum(sol.s, 60 - sol.s)[sol.push < 0]  # at stations 0.15 m apart
    share, near = (float(number) for number in re.findall(r"[\d.]+", text))
    assert text.startswith("pulled at the ends (no push on ")
    assert share == pytest.approx(100 * np.mean(sol.push < 0), abs=0.7)  # in whole percent
    assert near == pytest.approx(off.max(), abs=0.2)
    assert cautions.said(text) == (
        f"The rod would lift off next to its ends alone: no push on {share:g} % of the length, all within {near:g} m "
        "of the ends."
    )
    assert sol.caution == text.replace(f"{near:g} m", "14 % of it")


@pytest.mark.parametrize("tol", [1e-2, 1e-3, 1e-5, 1e-8])
def test_a_loose_tolerance_excuses_no_stretch_without_push(tol: float) -> None:
    """A cable around a drum lies free in the middle too, at 681 to 741 mm and elsewhere."""
    rod = Rod(EI=2e5, GJ=1.5e5, a=5.0, L=2500.0)
    sol = solve(Case(rod, Cylinder(100.0), Start(np.radians(70), 0.0, F2=0.0, F3=50.0, M3=0.0)), tol=tol, stations=801)
    assert (sol.push[np.abs(sol.s - 710) < 20] < 0).all()
    assert "pulled in part" in str(cautions.of_cases(sol))


@pytest.mark.parametrize("beta0, betaL", [(0.0, 0.0), (0.3, -0.2)])
def test_a_pipe_that_runs_against_both_its_ends_turns_back(beta0, betaL) -> None:
    """Pushed hard, a long pipe has its lowest energy turned round."""
    case = Case(Rod(EI=1.0, GJ=0.8, a=0.01, L=40.0), Cylinder(1.01, "inside"), Ends(beta0, betaL, FZ=-0.5))
    verdicts = set()
    for sol in (one.solution for one in equilibria(case) if one.index == 0):
        far = (np.abs(sol.beta - beta0) > np.pi / 2) & (np.abs(sol.beta - betaL) > np.pi / 2)
        behind = beta0 == betaL and sol.z[-1] * np.cos(beta0) < 0
        caution = str(cautions.of_cases(sol))
        assert ("turned back" in cautions.keys(caution)) == bool(far.any() or behind)
        verdicts.add(bool(far.any() or behind))
        if cautions.keys(caution) == ["turned back"]:
            assert cautions.said(caution) == "The rod turns back against the direction of both its ends."
            assert not cautions.is_barred(caution)
    assert True in verdicts


def test_a_straight_rod_without_any_contact_is_not_said_to_be_pulled() -> None:
    for F3 in (-10.0, 0.0, 10.0):
        assert told(Case(Rod(a=0.1, **STEEL), Cylinder(1.0), Start(1e-9, 0.0, M3=0.0, F3=F3))) == ""


def test_curvature_above_one_over_the_radius_is_too_tight_and_below_it_is_not() -> None:
    thick = Rod(a=1.0, **STEEL)
    assert "too tight" in told(Case(thick, Cylinder(5.0), Start(0.1, 1.05, M3=0.0)))
    assert "too tight" not in told(Case(thick, Cylinder(5.0), Start(0.1, 0.5, M3=0.0)))


def test_an_unsolved_case_gives_no_caution() -> None:
    study = small.study("[axes.E]\nvalues = [1e4, 2e4]")
    sol = solve(study.case(), stations=21)
    outcome, solved = np.array(["solved", "failed: on purpose"], dtype=object), np.array([True, False])
    sol = replace(sol, trajectory=replace(sol.trajectory, outcome=outcome, solved=solved))
    ds = dataset.make(study, study.dimensions(), columns(study, sol))
    assert [", ".join(cautions.keys(text)) for text in ds["caution"].values] == ["overlaps, pulled", ""]


@pytest.mark.parametrize("known", [0.0, 100.0])
def test_what_is_observed_already_is_taken_from_there(known: float) -> None:
    sol = solve(loads(small.HEAD).case())
    assert ("too tight" in str(cautions.of_cases(sol, {"kappa_max": known, "kappa_max_error": 0.0}))) == (known > 1)


LIFTS_OFF = {"E": 2.1e8, "nu": 0.3, "a": 0.01, "R": 1.0, "beta": 0.5, "dbeta": 0.0, "F2": 0.0, "dgamma": 0.0}


@pytest.mark.parametrize("observables", [["attached"], ["wraps"], []])
@pytest.mark.parametrize("outputs", [["z"], [], ["alpha", "z", "contact"]])
def test_the_caution_does_not_hang_on_what_is_stored(observables: list[str], outputs: list[str]) -> None:
    """In compression a helix presses outwards: outside the cylinder it lifts off, whoever asks."""
    if not (observables or outputs):
        return  # a study that asks for nothing at all is of no use
    axes = small.axis("L", [5.0, 8.0]) + small.axis("F3", [-900.0, -1000.0])
    ds = in_memory.run(loads(small.text(LIFTS_OFF, axes, "m kN", observables=observables, outputs=outputs)))
    assert all("pulled" in text for text in ds["caution"].values.ravel())
    assert "4 would lift off" in ds.attrs["caution"]


@pytest.mark.parametrize("stations", [3, 201, 5001])
def test_the_caution_does_not_hang_on_the_stations(stations: int) -> None:
    """A peak of curvature 2/a, a pull and a self-contact, each on a short stretch of the rod only."""
    b = 1e-2
    sharp = in_units_of_rho(0, 0, 0, 2 / np.tan(b), b, np.sin(b) ** 2)  # kappa = sqrt(2) in the middle, a = 1/4
    assert told(sharp, stations) == "overlaps, pulled"
    thick = Rod(E=1.0, nu=0.25, a=0.8, L=2 / np.tan(b))
    A, s, c = thick.bending_stiffness, np.sin(b), np.cos(b)
    case = Case(thick, Cylinder(0.2), Start(b, s**2, M3=0.0, F3=-A * s**4, F2=A * s**3 * c))
    assert told(case, stations) == "too tight, overlaps, pulled"


def test_a_march_at_few_stations_says_what_was_not_checked_and_at_many_what_the_orbit_says() -> None:
    case = in_units_of_rho(0.3, 0.2, -0.5, 20.0, 0.5, 0.3)
    few = str(cautions.of_cases(solve(case, tol=1e-7, method="dop853", stations=6)))
    assert cautions.keys(few) == ["pulled", "not checked: curvature", "not checked: self-contact"]
    assert cautions.said(np.array([few])).endswith("The rod was not checked for curvature and self-contact.")
    many = str(cautions.of_cases(solve(case, tol=1e-7, method="dop853", stations=2001)))
    assert many == str(cautions.of_cases(solve(case, stations=3)))


AT_ENDS = "pulled at the ends (no push on {} % of the length within {} m of an end)"


@pytest.mark.parametrize(("FZ", "kind"), [(-1000.0, "nearly everywhere (no push on 100 %"), (-50.0, "in part")])
def test_a_rod_that_would_lift_off_in_more_than_its_ends_is_barred(FZ: float, kind: str) -> None:
    """A helix wound under compression around a drum is held by nothing; a short pipe buckles between its ends."""
    rope = Case(Rod(a=0.01, **STEEL), Cylinder(1.0), Start(0.5, 0.0, M3=0.0, F3=FZ))
    pipe = Case(Rod(a=0.0635, **{**STEEL, "L": 60.0}), Cylinder(0.108, "inside"), Ends(0.0, 0.0, FZ=FZ))
    text = solve(rope if FZ == -1000 else pipe).caution
    assert text.startswith(f"pulled {kind}")
    assert cautions.is_barred(text)
    assert not cautions.is_barred(AT_ENDS.format(1.5, 3))


def test_a_caution_of_other_words_is_quoted_after_the_known_ones() -> None:
    """A file may be edited, or come from another version."""
    assert cautions.tell({"$\\mathrm{": 1}) == (
        "The rod is marked '$\\\\mathrm{': this shape is not physically realisable."
    )
    both = cautions.tell({"of old, overlaps": 2, "": 1})
    assert both.startswith("Of 3 rods 2 pass through themselves and 2 are marked 'of old'")
