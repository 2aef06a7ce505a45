"""The figures of stored datasets: they show the data, the law and its verdict; one rod alone is solved again."""

import sys

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.text import Text

from solver import InputError
from tests.workbench import small
from tests.workbench.small import study
from workbench.figures import along, canvas, colours, drawn_rods, kinds, scales, study_figure
from workbench.figures.laws import panel
from workbench.figures.unrolled import stretch
from workbench.store import in_memory, law_verdicts, selection


@pytest.fixture(scope="module")
def forces() -> xr.Dataset:
    return small.study_dataset("fig7_5_forces")


@pytest.fixture(scope="module")
def angles() -> xr.Dataset:
    return small.study_dataset("fig7_3_start_angle")


def axes():
    return Figure().subplots()


def panels(ds: xr.Dataset) -> list:
    """The panel of each law, and what is said below it."""
    rows = law_verdicts.verdicts(ds)
    drawn = [axes() for _ in rows]
    return [(ax, panel(ds, ax, row)) for ax, row in zip(drawn, rows, strict=True)]


def said(ax) -> str:
    return " ".join([ax.get_title(loc="left"), *(text.get_text() for text in ax.texts)]).replace("\n", " ")


@pytest.mark.parametrize(
    ("values", "spacing", "logarithmic"),
    [
        (np.geomspace(1, 10, 4), None, True),
        (np.linspace(1, 10, 4), None, False),
        ([1.0, 2.0, 5.0, 10.0], None, True),
        ([1.0, 10.0], None, False),  # two values have no spacing
        ([1.0, 1.7, 2.9], None, False),  # a narrow range
        ([-8.0, -4.0, -2.0, -1.0], None, False),
        ([1.0, 1.1, 1.2, 10.0], "linear", False),  # refined at its low end
        ([1.0, 8.0, 9.0, 10.0], "geometric", True),
        (np.exp(np.random.default_rng(1).uniform(0, 3, 99)), None, True),
        (np.random.default_rng(1).uniform(1, 20, 99), None, False),
    ],
)
def test_an_axis_is_logarithmic_where_its_values_lie_more_evenly_so(values, spacing, logarithmic: bool) -> None:
    axis = xr.DataArray(values, attrs={} if spacing is None else {"spacing": spacing})
    assert scales.is_logarithmic(axis) == logarithmic


def test_a_panel_shows_the_stored_numbers(angles) -> None:
    ax, _ = panels(angles)[0]
    drawn = np.vstack([points.get_offsets() for points in ax.collections if len(points.get_offsets()) == 9])
    np.testing.assert_allclose(drawn[:, 0], np.rad2deg(angles["beta0"]))
    np.testing.assert_array_equal(drawn[:, 1], angles["turns"])


def test_a_panel_marks_each_step_the_wrong_way(angles) -> None:
    _, (qualified, _) = panels(angles)
    row = law_verdicts.verdicts(angles)[1]
    marked = [line.get_ydata().tolist() for line in qualified.lines if line.get_linewidth() == 3]
    assert marked == [step["values"] for step in row["exceptions"]]


def test_the_verdict_of_a_qualified_law_has_its_colour(angles) -> None:
    ax, _ = panels(angles)[1]
    told = next(text for text in ax.get_children() if said(ax) in getattr(text, "get_text", str)())
    assert told.get_color() == colours.VERDICTS["qualified"]


def test_on_a_grid_the_deciding_line_stands_out_from_the_others(forces) -> None:
    ax, _ = panels(forces)[0]
    faint = [line for line in ax.lines if line.get_color() == colours.FAINT]
    (strong,) = [line for line in ax.lines if line.get_color() == colours.DATA and len(line.get_xdata()) == 9]
    assert len(faint) == 9
    np.testing.assert_array_equal(strong.get_ydata(), forces["contact_size_mean"].sel(F3=10.0, method="nearest"))


@pytest.mark.parametrize("side", ["outside", "inside"])
def test_a_push_is_drawn_upward_on_either_side_and_lift_off_is_shaded(side: str) -> None:
    ds = small.study_dataset("fig6").assign_attrs(side=side)
    rods = drawn_rods.choose(
        ds.drop_attrs().assign_attrs({k: v for k, v in ds.attrs.items() if k != "study"}), ["push"]
    )
    ax = axes()
    along.alone(ax, rods, "push")
    np.testing.assert_array_equal(ax.lines[0].get_ydata(), ds["contact"] * (1 if side == "outside" else -1))
    assert any("lift off" in entry for entry in ax.get_legend_handles_labels()[1])


def test_equal_peaks_of_push_are_drawn_equal_however_few_stations_are_stored() -> None:
    ds = in_memory.run(
        study("[axes.E]\nvalues = [1e4]\n", 'observables = ["push_max"]\noutputs = ["contact", "beta"]\n')
    )
    for stored in (ds, ds.isel(E=0)):
        push = study_figure.figure(stored).axes[1].lines[0].get_ydata()
        peaks = push[1:-1][(push[1:-1] > push[:-2]) & (push[1:-1] > push[2:]) & (push[1:-1] > 160)]
        assert peaks.size == 6
        np.testing.assert_allclose(peaks, ds["push_max"].values[0], rtol=1e-3)  # a third of a pixel


def test_where_a_law_decides_is_where_a_picture_is_taken(forces) -> None:
    for row in law_verdicts.verdicts(forces):
        for name, value in row["at"].items():
            assert float(forces[name][selection.case(forces)[name]]) == pytest.approx(value)


def test_drawing_leaves_no_state_behind(tmp_path) -> None:
    import matplotlib

    before = dict(matplotlib.rcParams)
    canvas.save(study_figure.figure(small.six()), tmp_path / "figure.png")
    assert dict(matplotlib.rcParams) == before
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()


def test_one_scale_is_left_only_where_the_curves_would_be_a_hair() -> None:
    room = (9.0, 4.5)
    assert stretch(149.0, 2.0, room) == 1  # 0.121 inches high
    assert stretch(151.0, 2.0, room) == 30  # to 4.5 inches would be 37.8 times
    assert stretch(1.0, 1000.0, room) == pytest.approx(1 / 2000)
    assert stretch(100.0, 0.0, room) == stretch(100.0, 1e-12, room) == 1  # a straight rod is straight


def test_a_rod_that_bends_between_its_stations_is_dotted_and_said_to_be_and_else_a_line() -> None:
    for stations, dotted in ((21, True), (401, False)):
        ds = in_memory.run(study("").at_stations(stations))
        ds.attrs.pop("study")  # so that it is drawn at its stations
        fig = study_figure.figure(ds)
        words = " ".join(" ".join(text.get_text().split()) for text in fig.findobj(Text))
        assert (f"{stations} stations miss bends" in words) == dotted
        assert any(line.get_marker() == "." for ax in fig.axes for line in ax.lines) == dotted


def test_observables_that_are_left_out_are_said(angles) -> None:
    (note,) = canvas.notes_of(study_figure.figure(angles))
    judged = {row["observable"] for row in law_verdicts.verdicts(angles)}
    level = {name for name in selection.observables(angles) if selection.is_level(angles, name)}
    left = [name for name in selection.observables(angles) if name not in judged | level]
    assert note == f"Not drawn: {', '.join(left)}; choose with --show or --panel."


def test_bars_have_the_stored_number_of_each_case_along_a_short_axis() -> None:
    ds = small.six()
    fig = kinds.figure(ds, "bars", x="R", show=["kappa_max"], at={"E": 2e4})
    (bars,) = fig.axes[0].containers
    np.testing.assert_array_equal([bar.get_width() for bar in bars], ds["kappa_max"].sel(E=2e4).sortby("R"))
    assert [text.get_text() for text in fig.axes[0].get_yticklabels()] == ["R = 0.5 cm", "0.75", "1"]
    assert "E = 20000" in fig.legends[0].get_title().get_text()


def test_bars_of_a_long_axis_or_of_one_case_are_refused() -> None:
    with pytest.raises(InputError, match="at most 12 values of an axis, and E has 13: choose --kind lines"):
        kinds.figure(in_memory.run(study("[axes.E]\nfrom = 1e4\nto = 2e4\ncount = 13")), "bars")
    with pytest.raises(InputError, match="the file holds one case"):
        kinds.figure(in_memory.run(study()), "bars")
