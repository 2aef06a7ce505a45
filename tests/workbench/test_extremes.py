"""The map of the extremes: what is stored for each method, and that the drawing needs nothing else."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex

from solver.methods import available
from tests.workbench.command import exit_status
from workbench.figures import canvas
from workbench.figures import colours as palette
from workbench.lab import extreme_runs, measured_runs, robustness
from workbench.lab.extreme_runs import (
    INACCURATE,
    REFUSED,
    VERDICTS,
    Attempt,
    as_dataset,
    attempts_at,
    extremes,
    references,
)
from workbench.run import writing
from workbench.stored import reading
from workbench.stored.stored_study import StoredStudy


def test_every_extreme_has_a_name_of_its_own_and_a_reference_or_none_said() -> None:
    names = [one.name for one in extremes()]
    assert len(set(names)) == len(names)
    assert set(references()) == set(names)


def test_orbit_is_right_to_its_promise_at_every_extreme_that_a_march_of_25_digits_reaches() -> None:
    """Looser than the promise by ten only where rounding of the case's own numbers is amplified."""
    from solver import solve
    from workbench.lab.extreme_runs import SHARES

    for one in extremes():
        known = references()[one.name].beta
        sol = solve(one.case, tol=1e-9, stations=float(one.case.rod.L) * np.array((0.0, *SHARES)))
        if known is not None and sol.solved:
            assert np.abs(sol.beta[1:] - known).max() <= 10 * max(sol.error, 1e-15), one.name
        if known is not None and sol.condition < 1e10:
            assert sol.solved, (one.name, sol.outcome)


@pytest.mark.slow
def test_a_stored_map_holds_all_that_the_drawing_needs(tmp_path: Path) -> None:
    named = [one for one in extremes() if one.name in ("L/ρ = 1e-6", "R = 1e9 a")]
    ds = as_dataset({one.name: attempts_at(one, references()[one.name]) for one in named})
    writing.write(ds, tmp_path / "extremes.h5")
    again = reading.read(tmp_path / "extremes.h5", study=False)
    assert list(again["method"].values) == list(available())
    assert set(again["verdict"].values.flat) <= set(VERDICTS)
    assert not (again["verdict"].sel({"extreme": "L/ρ = 1e-6"}) == INACCURATE).any()
    assert (again["verdict"].sel({"extreme": "L/ρ = 1e-6", "method": "orbit"}) == "solved").all()
    assert (again["verdict"].sel({"extreme": "R = 1e9 a", "method": "euler"}) == REFUSED).all()
    fig = robustness.figure(StoredStudy(again))
    canvas.save(fig, tmp_path / "map.png")
    assert (tmp_path / "map.png").stat().st_size > 10_000
    kept = robustness.promise_kept(StoredStudy(again))
    here = {"extreme": "R = 1e9 a", "method": "dop853"}
    i, j = list(again["extreme"].values).index(here["extreme"]), list(again["method"].values).index(here["method"])
    one = again.sel(here)
    assert kept[i, j] == pytest.approx(np.log10(float(one["error"]) / (1e-6 * float(one["condition"]))))
    cells = [patch for patch in fig.axes[0].patches if patch.get_xy() in ((j, i), (0, i))]
    assert len({cell.get_facecolor() for cell in cells}) == 2  # dop853 keeps its promise less well than orbit


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_command_ends_with_status_1_where_a_method_calls_an_inaccurate_answer_solved(
    verdict: str, tmp_path: Path, monkeypatch
) -> None:
    row = extremes()[0].name, dict.fromkeys(available(), Attempt(verdict, verdict, 1e-7, 1e-7, 1.0, 1.0, 1.0))
    monkeypatch.setattr(extreme_runs, "rows_of", lambda named, step: (row for _ in "1"))
    assert exit_status("trade", "--extremes", "--out", tmp_path) == (1 if verdict == INACCURATE else 0)
    stored = reading.read(tmp_path / "extremes.h5", study=False)
    assert set(stored["verdict"].values.flat) == {verdict}


def test_a_solved_cell_whose_bound_is_wide_has_a_colour_of_its_own() -> None:
    ds = reading.read(measured_runs.SHIPPED / "extremes.h5", study=False)
    fig = robustness.figure(StoredStudy(ds))
    colours = {patch.get_xy(): to_hex(patch.get_facecolor()) for patch in fig.axes[0].patches}
    wide = robustness.vague(StoredStudy(ds))
    for (i, j), here in np.ndenumerate(wide):
        assert (colours[j, i] == palette.EXTREMES["vague"]) == here
    saddle = ds["extreme"].values.tolist().index("turns 1e-12 before a saddle")
    assert wide[saddle, ds["method"].values.tolist().index("euler")]
    assert not wide[ds["extreme"].values.tolist().index("Table 1 as printed")].any()
    ones = ds["condition"].copy(data=np.ones(ds["condition"].shape))
    assert not robustness.vague(StoredStudy(ds.assign(condition=ones))).any()
