"""The command trade, its dataset and its diagrams; and the dial of fidelities."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from solver.observe.observables import OBSERVABLES
from solver.problem.errors import InputError
from studies.language.loader import loads
from studies.language.study import OFF_WALL
from tests.workbench import forked, small
from workbench.commands.fidelity import FIDELITIES
from workbench.lab import measured_runs, trade, trade_figure
from workbench.lab.benchmark import available_ladders, measure
from workbench.lab.trade_runs import CASES, advice, reference
from workbench.run import in_memory
from workbench.stored import reading
from workbench.stored.quantity_variables import CURVES
from workbench.stored.stored_study import StoredStudy

NUMBERS = (
    "seconds", "evaluations", "error", "error_beta", "error_position", "error_contact", "estimate", "condition",
    "drift_h", "drift_FZ", "drift_MZ",
)  # fmt: skip


def workbench(*args: object) -> subprocess.CompletedProcess[str]:
    return forked.run("-m", "workbench", *args)


@pytest.fixture(scope="module")
def ran(tmp_path_factory) -> tuple[Path, dict]:
    """Two cases by three methods, from the command line; what it stored and what it said."""
    out = tmp_path_factory.mktemp("trade")
    run = workbench(
        "trade", "--cases", "elliptic,ends elliptic", "--methods", "orbit,difference", "--out", out, "--json"
    )
    assert run.returncode == 0, run.stderr
    return out, json.loads(run.stdout)


@pytest.fixture(scope="module")
def ds(ran) -> xr.Dataset:
    return reading.read(ran[0] / "trade.h5", study=False)


def test_the_dataset_is_labelled(ds) -> None:
    assert dict(ds.sizes) == {"case": 2, "ladder": 3, "rung": 10, "level": 4}
    assert list(ds["case"].values) == ["elliptic", "ends elliptic"]
    assert list(ds["ladder"].values) == ["orbit", "difference", "difference extrapolated"]
    for name in (*NUMBERS, "value"):
        assert {"units", "long_name"} <= set(ds[name].attrs), name
        assert ds[name].dims[-1] == "rung"
    assert ds["seconds"].attrs["units"] == "s"
    assert ds.attrs["machine"]
    assert "numpy" in json.loads(ds.attrs["versions"])


def test_a_rung_that_was_tried_has_all_its_numbers_and_one_that_was_not_has_none(ds) -> None:
    tried = ~np.char.startswith(ds["outcome"].values.astype(str), "not ")
    assert tried.any()
    assert (~tried).any()
    for name in NUMBERS:
        assert (np.isnan(ds[name].values) == ~tried).all(), name
    # a method is tried on its own kind of problem only
    assert set(ds["outcome"].sel(case="ends elliptic", ladder="orbit").values[:8]) == {
        "not tried: it solves another kind of problem"
    }


def test_what_is_told_is_what_is_stored(ran, ds) -> None:
    out, told = ran
    assert told["cases"] == ["elliptic", "ends elliptic"]
    for row in told["table"]:
        for best in row["cheapest"]:
            here = ds.sel(case=row["case"], level=best["level"])
            assert best["method"] == str(here["cheapest"].item())
            rungs = here.sel(ladder=best["method"])
            good = rungs["error"].values <= best["level"]
            assert best["seconds"] == rungs["seconds"].values[good].min()
    assert [Path(picture).name for picture in told["pictures"]] == ["trade_seconds.png", "trade_evaluations.png"]
    assert all((out / Path(picture).name).stat().st_size > 10_000 for picture in told["pictures"])


def test_a_diagram_draws_every_rung_that_was_tried_failures_as_crosses(ds) -> None:
    from matplotlib.figure import Figure

    failed = ds.copy(deep=True)
    failed["outcome"] = ds["outcome"].astype(object)
    failed["outcome"].loc[{"case": "elliptic", "ladder": "orbit"}] = "failed: made up"
    for data, crosses in ((ds, 0), (failed, 8)):
        ax = trade_figure.panel(StoredStudy(data), Figure().add_subplot(), "elliptic")
        drawn = {line.get_marker(): line for line in ax.lines if len(line.get_xdata()) and line.get_marker() in "ox"}
        assert len(drawn["x"].get_xdata() if "x" in drawn else ()) == crosses
        assert len(drawn["o"].get_xdata() if "o" in drawn else ()) == 8 - crosses


def test_the_crosses_of_each_method_have_a_height_of_their_own() -> None:
    from matplotlib.figure import Figure

    stored = StoredStudy(reading.read(measured_runs.SHIPPED / "trade.h5", study=False))
    for case in trade_figure.cases_to_show(stored):
        ax = trade_figure.panel(stored, Figure().add_subplot(), case)
        crosses = [line for line in ax.lines if line.get_marker() == "x"]
        heights = {float(height) for line in crosses for height in line.get_ydata()}
        assert len(heights) == len(crosses) == len({line.get_color() for line in crosses})
        assert all(trade_figure.LOST < height < trade_figure.TOP for height in heights)


def test_a_method_that_hands_over_has_two_lines_and_no_line_between_them(ds) -> None:
    from matplotlib.figure import Figure

    handed = ds.copy(deep=True)
    handed["answered"] = ds["answered"].astype(object)
    handed["answered"].loc[{"case": "elliptic", "ladder": "orbit"}] = ["swing"] * 3 + ["orbit"] * 7
    ax = trade_figure.panel(StoredStudy(handed), Figure().add_subplot(), "elliptic")
    assert sorted(len(line.get_xdata()) for line in ax.lines if line.get_marker() == "o") == [3, 5]
    swing = {"swing": available_ladders()["swing"]}
    rows = measure({"x": (CASES["gap 1e-08"].case, reference("gap 1e-08"), None)}, swing)
    assert {row.answered for row in rows} == {"orbit"}
    assert {str(name) for name in np.unique(ds["answered"].sel(ladder="orbit"))} == {"", "orbit"}


def test_the_advice_names_the_method_that_reaches_a_level_in_the_most_cases(ran, ds, capsys) -> None:
    _, told = ran
    rows = {(row["kind"], row["level"]): row for row in told["advice"]}
    assert set(rows) == {(kind, level) for kind in ("start", "ends") for level in ds["level"].values}
    one = rows["ends", 1e-3]
    spent = ds.sel(case="ends elliptic", ladder=one["method"])
    assert one["reached"] == one["cases"] == 1
    assert one["seconds"] == spent["seconds"].values[spent["error"].values <= 1e-3].min()
    slow = ds.copy(deep=True)
    slow["error"].loc[{"case": "elliptic", "ladder": "orbit"}] = 1.0
    found = [row for row in advice(slow) if row["kind"] == "start"]
    assert all(row["method"] is None and row["reached"] == 0 for row in found)
    trade._print(told | {"advice": [*found, one]}, [])
    lines = capsys.readouterr().out.splitlines()
    assert "For an error of 1e-06 in start problems: no method reaches it." in lines
    assert f"For an error of 1e-03 in ends problems: {one['method']} (1 of 1 cases, median" in lines[-1]


def test_each_panel_of_a_trade_has_the_numbers_of_its_cost_and_many_cases_are_six(ds) -> None:
    many = ds.isel(case=[0] * 8).assign_coords(case=[f"case {k}" for k in range(8)])
    assert trade_figure.cases_to_show(StoredStudy(many.isel(case=slice(5)))) == [f"case {k}" for k in range(5)]
    fig = trade_figure.figure(StoredStudy(many), "seconds")
    fig.draw_without_rendering()
    assert len(fig.axes) == 6
    assert any("6 of 8 cases" in text.get_text() for text in fig.texts)
    for ax in fig.axes:
        assert any(text.get_visible() and text.get_text() for text in ax.get_xticklabels())


# fidelities


def test_a_file_that_no_trade_wrote_is_replaced_by_force_alone(tmp_path: Path) -> None:
    file, args = tmp_path / "trade.h5", ("trade", "--cases", "elliptic", "--methods", "orbit", "--out", tmp_path)
    file.write_text("mine")
    refused = workbench(*args)
    assert (refused.returncode, file.read_text()) == (2, "mine")
    assert "give --force to replace it" in refused.stderr
    assert workbench(*args, "--force").returncode == 0
    assert reading.read(file, study=False).sizes["case"] == 1


def test_a_study_at_a_fidelity_has_its_tolerance_its_stations_and_what_it_computes() -> None:
    study = small.grid()
    found = {name: in_memory.run(level.of(study)) for name, level in FIDELITIES.items()}
    for name, ds in found.items():
        assert ds.attrs["tolerance"] == FIDELITIES[name].tol
        assert (ds["error"] <= FIDELITIES[name].tol * np.maximum(1, ds["condition"])).all()
    assert {name: ds.sizes["u"] for name, ds in found.items()} == {
        "draft": 51,
        "standard": 21,
        "fine": 801,
        "exact": 1601,
    }
    assert "F1_along" in found["standard"]
    assert "F1_along" not in found["draft"]
    assert "turns_around" in found["draft"]  # a law admits it
    assert "bends" not in found["draft"]
    for name in ("fine", "exact"):
        along = set(CURVES) - set(OFF_WALL)
        assert along | {name for name, row in OBSERVABLES.items() if not row.free} <= set(found[name].data_vars)


def test_a_rod_off_the_wall_has_what_a_fidelity_computes_but_for_the_first_integral() -> None:
    ends = {"beta0": "90deg", "betaL": "90deg", "height": 0.0, "azimuth": "200deg", "radiusL": 1000.0, "M2L": 0.0}
    rod = {"EI": 2e6, "GJ": 1.6e6, "a": 6.0, "L": 1450.0, "R": 200.0, "contact": "unilateral"}
    study = loads(small.text(rod | ends, "", "mm N"))
    ds = in_memory.run(FIDELITIES["fine"].of(study).with_values(tol=1e-3))
    assert bool(ds["solved"])
    assert set(CURVES.values()) - {"h"} <= {CURVES.get(name) for name in ds.data_vars}
    with pytest.raises(InputError, match="has no first integral: omit the output h"):
        loads(small.text(rod | ends, "", "mm N", outputs=["beta", "h"]))
