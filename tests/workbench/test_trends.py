"""The figures of stored datasets: they show the data, the law and its verdict; one rod alone is solved again."""

import sys

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.text import Text

from studies import load
from tests.slow import slow
from tests.workbench.page_faults import faults
from tests.workbench.small import grid, study
from workbench.figures import along, canvas, colours, drawn_rods, legend, study_figure, unrolled
from workbench.figures.laws import panel
from workbench.figures.sheet import sheet
from workbench.figures.trends import trend
from workbench.figures.unrolled import stretch
from workbench.store import in_memory, law_verdicts, selection


@pytest.fixture(scope="module")
def forces() -> xr.Dataset:
    return in_memory.run(load("fig7_5_forces"))


@pytest.fixture(scope="module")
def angles() -> xr.Dataset:
    return in_memory.run(load("fig7_3_start_angle"))


def axes():
    return Figure().subplots()


def panels(ds: xr.Dataset) -> list:
    """The panel of each law, and what is said below it."""
    rows = law_verdicts.verdicts(ds)
    drawn = [axes() for _ in rows]
    return [(ax, panel(ds, ax, row)) for ax, row in zip(drawn, rows, strict=True)]


def strips(ds: xr.Dataset, axis: str, inches: tuple[float, float] = (9.0, 4.5)):
    """The unrolled views along an axis, and what is said of them."""
    views = unrolled.Panel(drawn_rods.choose(ds, ("alpha", "z"), axis), inches, 8.0, coloured=False)
    ax = Figure(figsize=inches).subplots()
    views.draw(ax)
    return ax, views


def said(ax) -> str:
    return " ".join([ax.get_title(loc="left"), *(text.get_text() for text in ax.texts)]).replace("\n", " ")


def test_a_panel_shows_the_stored_numbers(angles) -> None:
    ax, _ = panels(angles)[0]
    drawn = np.vstack([points.get_offsets() for points in ax.collections if len(points.get_offsets()) == 9])
    np.testing.assert_allclose(drawn[:, 0], np.rad2deg(angles["beta0"]))
    np.testing.assert_array_equal(drawn[:, 1], angles["turns"])


def test_a_panel_tells_the_verdict_and_marks_each_step_the_wrong_way(angles) -> None:
    (holds, _), (qualified, _) = panels(angles)
    assert said(holds).endswith("true")
    assert "true in part" in said(qualified)
    assert holds.get_legend() is None
    (label,) = [text.get_text() for text in qualified.get_legend().get_texts()]
    assert label == "a step the wrong way"
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
    assert "F₃ = 10 N" in ax.get_xlabel()


@pytest.mark.slow
def test_an_unsolved_case_is_said_to_be_so() -> None:
    ds = in_memory.run(study("[axes.E]\nvalues = [1e4, 2e4, 4e4]\n", 'observables = ["kappa_mean"]'))
    for name in ("kappa_mean", "alpha", "z"):
        ds[name][1] = np.nan
    ds["solved"][1] = False
    assert "unsolved" in said(strips(ds, "E")[0])
    ax = trend(ds, axes(), "kappa_mean", "E")
    assert "unsolved" in ax.get_legend_handles_labels()[1]


@pytest.mark.parametrize("side", ["outside", "inside"])
def test_a_push_is_drawn_upward_on_either_side_and_lift_off_is_shaded(side: str) -> None:
    ds = in_memory.run(load("fig6")).assign_attrs(side=side)
    rods = drawn_rods.choose(
        ds.drop_attrs().assign_attrs({k: v for k, v in ds.attrs.items() if k != "study"}), ["push"]
    )
    ax = along.alone(axes(), rods, "push")
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
    canvas.save(study_figure.figure(in_memory.run(grid())), tmp_path / "figure.png")
    assert dict(matplotlib.rcParams) == before
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()


LAW = """
[[laws]]
claim = "a claim of many words"
observable = "contact_size_mean"
axis = "E"
direction = "not-falling"
also = ["kappa_mean", "kappa_max", "wraps", "attached", "amplitude"]
source = "s"
"""
ONE_VALUE, TWO, LARGE = ("values = [1e4]", "values = [1e4, 3.7e5]", "from = 123456.7\nto = 134567.8\ncount = 9")


def of_user(kind: str) -> xr.Dataset:
    """A study of a user's: few or many rods, thin ones, long words."""
    values = {"one value": ONE_VALUE, "large numbers": LARGE}.get(kind, TWO)
    laws = LAW if kind in ("wide verdict", "thin beside a law") else ""
    if kind == "wide verdict":
        values = "values = [1e4, 1.1e4, 1.2e4, 2e4, 5e4, 3.7e5]\n[axes.F3]\nvalues = [5.0, 20.0, 80.0]"
    ds = in_memory.run(study(f"[axes.E]\n{values}\n{laws}"))
    if kind == "wide verdict":
        ds = ds.assign_attrs(title="A title that goes on for longer than a page of this width can hold, " * 2)
    if kind.startswith("thin"):
        ds["z"] = 1000 * ds["z"]
    if kind == "flat":
        ds["z"] = ds["z"] / 1000
    return ds


@pytest.mark.parametrize(
    "kind",
    [
        "one value",
        slow("large numbers"),
        slow("wide verdict"),
        slow("thin beside a law"),
        slow("flat"),
    ],
)
def test_whatever_a_study_asks_for_no_word_is_cut_off_and_no_two_meet(kind: str) -> None:
    assert faults(study_figure.figure(of_user(kind))) == []


@pytest.mark.parametrize(("kind", "factor"), [("thin", 200), ("one value", 1)])
def test_curves_too_thin_to_see_are_drawn_at_two_scales_and_the_figure_says_so(kind: str, factor: float) -> None:
    _, views = strips(of_user(kind), "E")
    assert views.form.factor == factor
    assert (f"distance around the cylinder drawn {factor} times larger" in views.notes[0]) == (factor > 1)


def test_one_scale_is_left_only_where_the_curves_would_be_a_hair() -> None:
    room = (9.0, 4.5)
    assert stretch(149.0, 2.0, room) == 1  # 0.121 inches high
    assert stretch(151.0, 2.0, room) == 30  # to 4.5 inches would be 37.8 times
    assert stretch(1.0, 1000.0, room) == pytest.approx(1 / 2000)
    assert stretch(100.0, 0.0, room) == stretch(100.0, 1e-12, room) == 1  # a straight rod is straight


def test_what_differs_by_rounding_is_drawn_as_level() -> None:
    ds = of_user("large numbers")
    ds["wraps"] = ds["wraps"] * 0 + 3.5 + 1e-13 * np.arange(9)
    low, high = trend(ds, axes(), "wraps", "E").get_ylim()
    assert (low, high) == pytest.approx((3.15, 3.85))


def test_a_rod_that_bends_between_its_stations_is_dotted_and_said_to_be_and_else_a_line() -> None:
    for stations, dotted in ((21, True), (401, False)):
        ds = in_memory.run(study("").at_stations(stations))
        ds.attrs.pop("study")  # so that it is drawn at its stations
        fig = study_figure.figure(ds)
        words = " ".join(" ".join(text.get_text().split()) for text in fig.findobj(Text))
        assert (f"{stations} stations miss bends" in words) == dotted
        assert any(line.get_marker() == "." for ax in fig.axes for line in ax.lines) == dotted


def test_any_stored_observable_is_drawn_if_asked_for_and_what_is_left_out_is_said(angles, tmp_path) -> None:
    asked = study_figure.figure(angles, show=["wraps", "turns", "condition"])
    assert [ax.get_ylabel().split(" [")[0] for ax in asked.axes] == [
        "turns around the cylinder",
        "number of bends",
        "condition",
    ]
    assert "true" in said(asked.axes[1])  # an observable with a law has the panel of its law
    assert len(study_figure.figure(angles, sheet=sheet(panel="wraps")).axes) == 1
    (note,) = legend.notes_of(study_figure.figure(angles))
    judged = {row["observable"] for row in law_verdicts.verdicts(angles)}
    level = {name for name in selection.observables(angles) if selection.is_level(angles, name)}
    left = [name for name in selection.observables(angles) if name not in judged | level]
    assert note == f"Not drawn: {', '.join(left)}; choose with --show or --panel."
