"""One checker over every figure of every study, at the widths of a journal: no word cut off, none over another."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from scipy.spatial import KDTree

from solver import equilibria, solve
from studies import load, names
from tests.workbench import small, stored_figures, study_kinds
from tests.workbench.page_faults import faults, largest_empty, picture
from tests.workbench.pictures import share_of_ink
from workbench.branches.ends_study import ends_problem
from workbench.branches.equilibria_dataset import as_dataset
from workbench.figures import bars, canvas, equilibria_figure, figure_kinds, unrolled
from workbench.figures.sheet import sheet
from workbench.influence.derivatives import local
from workbench.lab import measured_runs, robustness, trade_figure
from workbench.paper import report_runs, story
from workbench.stored import reading
from workbench.stored.stored_study import StoredStudy

SHEETS = {"screen": sheet(), "column": sheet("paper", 89, titled=False), "page": sheet("paper", 183, titled=False)}
IN_PRINT = 25.0  # millimetres that axes are high at least
LOW = "bars", "section"  # without a scale upward, or with equal scales


@pytest.mark.parametrize("page", SHEETS)
@pytest.mark.parametrize("kind", figure_kinds.OF_STUDIES)
def test_every_kind_of_picture_can_be_read_at_every_width(six, kind: str, page: str) -> None:
    own = {"states": "capstan", "samples": "samples_pipe"}
    ds = study_kinds.well() if kind == "well" else small.study_dataset(own[kind]) if kind in own else six
    fig = figure_kinds.figure(StoredStudy(ds), kind, SHEETS[page])
    assert fig.get_figwidth() == pytest.approx(SHEETS[page].width)
    assert faults(fig, axes=0.0 if page == "screen" or kind in LOW else IN_PRINT) == []


@pytest.mark.parametrize("name", ["fig7_1_modulus", "fig7_2_radius"])
def test_sentences_below_a_narrow_picture_leave_its_panels_their_room(name: str) -> None:
    fig = figure_kinds.figure(StoredStudy(small.study_dataset(name)), "lines", sheet("paper", 89))
    assert [fault for fault in faults(fig) if "over one another" in fault] == []


@pytest.mark.parametrize("name", ["fig6", "let_go"])
def test_a_picture_for_one_column_has_room_for_its_panels_and_for_views_at_their_own_size(name: str) -> None:
    stored = StoredStudy(small.study_dataset(name))
    fig = figure_kinds.figure(stored, figure_kinds.kind_without_map(stored), sheet("paper", 89))
    assert faults(fig, axes=IN_PRINT) == []
    (views,) = (ax for ax in fig.axes if ax.get_label().startswith("unrolled views"))
    assert views.get_window_extent().height / fig.dpi > 0.9 * np.ptp(views.get_ylim())


@pytest.mark.parametrize(
    ("name", "kind"),
    [("fig7_1_modulus", "curves"), ("fig7_2_radius", "curves"), ("fig7_3_start_angle", "lines"),
     ("pipe_vertical", "lines"), ("pole_greenhill", "curves")],
)  # fmt: skip
def test_no_eighth_of_a_page_with_unrolled_views_is_empty(name: str, kind: str) -> None:
    fig = figure_kinds.figure(StoredStudy(small.study_dataset(name)), kind, SHEETS["page"])
    assert largest_empty(fig) < 1 / 8


@pytest.mark.parametrize("name", ["pipe_centred", "fig7_5_forces"])
def test_the_title_of_a_law_is_one_line(name: str) -> None:
    fig = figure_kinds.figure(StoredStudy(small.study_dataset(name)), "lines", SHEETS["page"])
    titles = [title for ax in fig.axes if (title := ax.get_title(loc="left"))]
    assert titles
    assert not any("\n" in title for title in titles)


@pytest.mark.parametrize("page", SHEETS)
def test_the_titles_of_a_picture_all_name_their_claims_and_their_letters_stand_on_the_first_line(page: str) -> None:
    for name, claim in (("fig7_3_start_angle", "(3)"), ("fig7_4_end_angle", "(4)")):
        fig = figure_kinds.figure(StoredStudy(small.study_dataset(name)), "lines", SHEETS[page])
        titles = [ax for ax in fig.axes if ax.get_title(loc="left")]
        assert len(titles) == 2
        assert all(claim in ax.get_title(loc="left") for ax in titles)
        fig.draw_without_rendering()
        tops = [ax._left_title.get_window_extent().y1 for ax in titles]  # type: ignore[attr-defined]
        letters = [text.get_window_extent().y1 for ax in titles for text in ax.texts if text.get_fontweight() == "bold"]
        assert page == "screen" or np.abs(np.subtract(letters, tops)).max() < 0.5 * fig.dpi * 8 / 72


@pytest.mark.parametrize("name", ["fig7_1_modulus", "fig7_2_radius", "fig7_3_start_angle", "fig7_5_forces"])
def test_rods_are_long_enough_in_a_column_and_every_ring_encloses_its_lines(name: str) -> None:
    stored = StoredStudy(small.study_dataset(name))
    fig = figure_kinds.figure(stored, "lines", SHEETS["column"])
    strips = [ax for ax in fig.axes if ax.get_label() == unrolled.VIEWS]
    assert len(strips) == len(stored.varied)
    fig.draw_without_rendering()
    for ax in strips:
        rods = [line for line in ax.lines if line.get_marker() == "None"]
        boxes = [line.get_window_extent() for line in rods]
        assert 25.4 * max(max(box.width, box.height) for box in boxes) / fig.dpi > 30  # millimetres
        (rings,) = (dots for dots in ax.collections if isinstance(dots, PathCollection))
        radii = np.sqrt(rings.get_sizes()) / 2 / 72 * fig.dpi  # pixels
        assert 25.4 * 2 * radii.max() / fig.dpi < 4  # millimetres: a loop is about 8 mm wide
        lines = np.concatenate([line.get_transform().transform(np.asarray(line.get_xydata())) for line in rods])
        nearest = KDTree(lines).query(ax.transData.transform(np.asarray(rings.get_offsets())))[0]
        assert (nearest < radii).all()
    assert sum("of the 9 values" in sentence for sentence in canvas.caption(fig)) == len(strips)


@pytest.mark.parametrize("page", SHEETS)
def test_a_legend_without_a_free_place_stands_below_its_panel(page: str) -> None:
    """The line of the expected load passes through every corner of the panel that has room for three entries."""
    fig = figure_kinds.figure(StoredStudy(small.study_dataset("pipe_centred")), "lines", SHEETS[page])
    assert [fault for fault in faults(fig) if "over" in fault] == []


def test_a_legend_keeps_off_the_lines_of_axes_that_became_lower_in_print() -> None:
    fig = figure_kinds.figure(StoredStudy(small.study_dataset("pipe_lubinski")), "lines", sheet("paper", 183))
    assert [fault for fault in faults(fig) if "over" in fault] == []


def test_a_long_formula_below_a_narrow_panel_is_typeset_in_lines_that_fit() -> None:
    stored = StoredStudy(small.study_dataset("pipe_centred"))
    fig = figure_kinds.figure(stored, "lines", sheet("paper", 89), show=["all_push"])
    assert [fault for fault in faults(fig) if "cut off" in fault] == []
    texts = [text for ax in fig.axes if (legend := ax.get_legend()) for text in legend.get_texts()]
    formulas = [text for text in texts if "$" in text.get_text()]
    assert formulas
    assert all(text.get_parse_math() for text in formulas)


@cache
def chosen() -> dict[str, StoredStudy]:
    """The files of the story."""
    claims = report_runs.run_readings([load("fig7_1_modulus"), load("fig7_2_radius")])
    files = {name: small.study_dataset(name) for name in (story.ROD, story.ALONG)} | {story.CLAIMS: claims}
    return {name: StoredStudy(ds) for name, ds in files.items()}


@cache
def effects() -> xr.Dataset:
    return local(solve(ends_problem(load("fig6")))).assign_attrs(title="many observables", reading="")


@cache
def equilibria_of_fig6() -> xr.Dataset:
    case = ends_problem(load("fig6"))
    return as_dataset(load("fig6"), case, equilibria(case))


def shipped_measurements(name: str) -> xr.Dataset:
    return reading.read(measured_runs.SHIPPED / f"{name}.h5", study=False)


OTHERS: dict[str, Callable[[], Figure]] = {
    "the story": lambda: story.figure(chosen(), SHEETS["page"]),
    "the story, in a column": lambda: story.figure(chosen(), SHEETS["column"]),
    "bars that have room": lambda: figure_kinds.figure(
        StoredStudy(small.study_dataset("fig7_1_modulus")), "bars", SHEETS["column"]
    ),
    "effects that have room": lambda: figure_kinds.figure(StoredStudy(effects()), "tornado", SHEETS["column"]),
    "effects": lambda: bars.tornado(StoredStudy(effects())),
    "equilibria": lambda: equilibria_figure.figure(StoredStudy(equilibria_of_fig6())),
    "trade": lambda: trade_figure.figure(StoredStudy(shipped_measurements("trade"))),
}


def test_other_pictures_can_be_read_and_show_what_is_stored() -> None:
    stored_figures.check("pictures_others", OTHERS)


@pytest.mark.parametrize(
    ("name", "figure", "least"), [("trade", trade_figure.figure, 7.0), ("extremes", robustness.figure, 6.0)]
)
def test_a_picture_of_measurements_fits_one_column(name: str, figure: Callable[..., Figure], least: float) -> None:
    fig = figure(StoredStudy(shipped_measurements(name)), sheet=SHEETS["column"])
    assert fig.get_figwidth() == pytest.approx(SHEETS["column"].width)
    assert faults(fig, least, axes=IN_PRINT) == []


@pytest.mark.slow
def test_the_shipped_map_of_extremes_can_be_read_and_shows_what_is_stored() -> None:
    """Numbers of a cell are smaller than other letters."""
    stored_figures.check(
        "pictures_extremes",
        {"extremes": lambda: robustness.figure(StoredStudy(shipped_measurements("extremes")))},
        least=6.0,
    )


@pytest.mark.slow
@pytest.mark.parametrize("page", SHEETS)
@pytest.mark.parametrize("name", names())
def test_the_pictures_of_every_study_can_be_read_at_every_width_and_are_not_empty(name: str, page: str) -> None:
    ds = small.study_dataset(name)
    for kind in stored_figures.kinds_of(StoredStudy(ds)):
        fig = figure_kinds.figure(StoredStudy(ds), kind, SHEETS[page])
        assert faults(fig, axes=0.0 if page == "screen" else IN_PRINT) == []
        assert 0.02 < share_of_ink(picture(fig)) < 0.6
