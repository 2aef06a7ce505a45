"""What no real rod could do is said of every case, and of the study in one sentence."""

import re
from dataclasses import replace

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, Start, equilibria, solve
from tests.workbench import small
from workbench.store import assembly
from workbench.store.block import columns
from workbench.words import cautions

STEEL = {"E": 2.1e8, "nu": 0.3, "L": 20.0}  # kN and m


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


def test_an_unsolved_case_gives_no_caution() -> None:
    study = small.study("[axes.E]\nvalues = [1e4, 2e4]")
    sol = solve(study.case(), stations=21)
    outcome, solved = np.array(["solved", "failed: on purpose"], dtype=object), np.array([True, False])
    sol = replace(sol, trajectory=replace(sol.trajectory, outcome=outcome, solved=solved))
    ds = assembly.make(study, study.dimensions(), columns(study, sol))
    assert [", ".join(cautions.keys(text)) for text in ds["caution"].values] == ["overlaps, pulled", ""]
