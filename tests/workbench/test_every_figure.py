"""One checker over every figure of every study, at the widths of a journal: no word cut off, none over another."""

from collections.abc import Callable

import pytest
import xarray as xr
from matplotlib.figure import Figure

from solver import equilibria, solve
from studies import load, names
from tests.slow import slow_but
from tests.workbench import small
from tests.workbench.page_faults import faults, picture, words
from tests.workbench.pictures import share_of_ink
from workbench.branches.ends_study import ends_problem
from workbench.branches.equilibria_dataset import dataset_of
from workbench.figures import bars, canvas, equilibria_figure, kinds, robustness, story, work_precision
from workbench.figures.sheet import sheet
from workbench.influence.derivatives import local
from workbench.store import reading
from workbench.web.report import measured_runs, report_runs


@pytest.fixture(scope="module")
def told() -> dict[str, xr.Dataset]:
    found = {name: small.study_dataset(name) for name in (story.ROD, story.ALONG)}
    return found | {story.CLAIMS: report_runs.run_readings([load("fig7_1_modulus"), load("fig7_2_radius")])}


@pytest.mark.parametrize("width", slow_but([89, 183], 183))
def test_the_story_has_four_panels_that_can_be_read(told, width: float) -> None:
    fig = story.figure(told, sheet("paper", width, titled=False))
    assert faults(fig) == []
    assert fig.get_figheight() * 25.4 <= (120 if width == 89 else 140)
    law, table = fig.axes[2], fig.axes[3]
    steps = next(line for line in law.lines if line.get_drawstyle() == "steps-mid")
    assert steps.get_ydata().tolist() == told[story.ALONG]["turns"].values.tolist()
    assert len(table.lines) >= told[story.CLAIMS]["claim_verdict"].size


SHEETS = {"screen": sheet(), "column": sheet("paper", 89, titled=False), "page": sheet("paper", 183, titled=False)}


@pytest.mark.parametrize("page", SHEETS)
@pytest.mark.parametrize("kind", kinds.OF_STUDIES)
def test_every_kind_of_picture_can_be_read_at_every_width(six, kind: str, page: str) -> None:
    fig = kinds.figure(small.study_dataset("capstan") if kind == "states" else six, kind, SHEETS[page])
    assert fig.get_figwidth() == pytest.approx(SHEETS[page].width)
    assert faults(fig) == []


def test_bars_of_one_column_are_those_that_have_room_and_the_others_are_named() -> None:
    ds = small.study_dataset("fig7_1_modulus")
    drawn = [kinds.figure(ds, "bars", SHEETS[page]) for page in ("column", "page")]
    assert [faults(fig) for fig in drawn] == [[], []]
    few, more = (len([ax for ax in fig.axes if ax.containers]) for fig in drawn)
    assert few < more
    (left_out,) = (note for note in canvas.notes_of(drawn[0]) if note.startswith("Not drawn: "))
    assert "choose with --show or --panel" in left_out


def test_a_tornado_of_one_column_has_the_observables_that_have_room_and_names_the_others() -> None:
    table = local(solve(ends_problem(load("fig6")))).assign_attrs(title="many observables", reading="")
    fig = kinds.figure(table, "tornado", SHEETS["column"])
    assert faults(fig) == []
    (left_out,) = (note for note in canvas.notes_of(fig) if note.startswith("Not drawn: "))
    column, whole = (len([ax for ax in picture.axes if ax.containers]) for picture in (fig, bars.tornado(table)))
    assert whole - column == len(left_out.split(", ")) > 1


def every_equilibrium() -> Figure:
    case = ends_problem(load("fig6"))
    return equilibria_figure.figure(dataset_of(load("fig6"), case, equilibria(case)))


def shipped(name: str) -> xr.Dataset:
    return reading.read(measured_runs.SHIPPED / f"{name}.h5", study=False)


OTHERS: dict[str, Callable[[], Figure]] = {
    "equilibria": every_equilibrium,
    "trade": lambda: work_precision.figure(shipped("trade"), "seconds"),
    "extremes": lambda: robustness.figure(shipped("extremes")),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", OTHERS)
def test_the_letters_of_a_figure_can_be_read_in_two_columns(name: str) -> None:
    fig = OTHERS[name]()
    assert min(text.get_fontsize() for text in words(fig)) * min(183 / 25.4 / fig.get_figwidth(), 1.0) >= 5.99


@pytest.mark.slow
@pytest.mark.parametrize("page", SHEETS)
@pytest.mark.parametrize("name", names())
def test_the_pictures_of_every_study_can_be_read_at_every_width_and_are_not_empty(name: str, page: str) -> None:
    ds = small.study_dataset(name)
    for kind in dict.fromkeys((kinds.kind_of(ds), "lines")):
        fig = kinds.figure(ds, kind, SHEETS[page])
        assert faults(fig) == []
        assert 0.02 < share_of_ink(picture(fig)) < 0.6
