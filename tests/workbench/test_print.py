"""Pictures for print: diagrams as vectors with their letters, scenes and diagrams at a number of dots an inch."""

import csv
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from solver import InputError
from studies import load
from studies.language.loader import loads
from tests.slow import slow
from tests.workbench import small
from tests.workbench.command import exit_status, run
from tests.workbench.page_faults import faults
from tests.workbench.pictures import draws
from workbench.branches.ends_study import ends_problem
from workbench.branches.equilibria_dataset import as_dataset
from workbench.figures import (
    axis_scales,
    canvas,
    drawn_rods,
    equilibria_figure,
    fonts,
    map_figure,
    print_heights,
    scatter,
    study_figure,
)
from workbench.figures.sheet import sheet
from workbench.run import in_memory, writing
from workbench.stored import stored_verdicts
from workbench.stored.stored_study import StoredStudy


@pytest.fixture(scope="module")
def ds() -> xr.Dataset:
    axes = "[axes.E]\nvalues = [1e4, 2e4]\n"
    return in_memory.run(loads(small.HEAD.replace("[units]", 'observables = ["turns_around"]\n[units]') + axes))


def equilibria(path: Path) -> None:
    study = load("fig6")
    case = ends_problem(study)
    from solver import equilibria as every

    canvas.save(equilibria_figure.figure(StoredStudy(as_dataset(study, case, every(case)[:2]))), path)


@pytest.mark.parametrize("name", ["plot", slow("equilibria")])
def test_a_diagram_for_print_is_vectors_with_its_letters_inside(ds, tmp_path, name: str) -> None:
    for kind in ("pdf", "svg"):
        path = tmp_path / f"one.{kind}"
        canvas.save(study_figure.figure(StoredStudy(ds)), path) if name == "plot" else equilibria(path)
        said = path.read_bytes()
        assert b"/Subtype /Image" not in said
        assert b"<image" not in said
        if kind == "pdf":
            assert b"/FontFile2" in said  # TrueType, embedded
            assert b"/Type3" not in said  # which printers and editors refuse
        else:
            assert b"<text" not in said  # outlines: no font is needed where it is opened
            assert said.count(b"<path") > 20


@draws
def test_a_scene_has_the_same_page_at_any_dots_an_inch(ds, tmp_path) -> None:
    from workbench.scene import composition, layout, page

    pages, sizes = [], []
    for dpi in (60, 75, 110):  # with fewer, letters of five pixels differ
        path = tmp_path / f"{dpi}.png"
        layout.render(StoredStudy(ds), path, kind="plain", settings=composition.Settings(1.0, dpi))
        with Image.open(path) as picture:
            sizes.append(np.array(picture.size) / dpi)
            assert picture.info["dpi"] == pytest.approx((dpi, dpi), abs=0.1)
            pages.append(np.asarray(picture.convert("L").resize((200, 150), Image.Resampling.BOX), dtype=float))
    np.testing.assert_allclose(sizes, [sizes[0]] * 3, atol=0.04)  # two pixels of the coarsest
    assert sizes[0][0] == page.WIDE
    # the same picture, but for edges that fall elsewhere between pixels
    assert (np.abs(pages[0] - pages[2]) > 40).mean() < 0.025


@draws
def test_without_background_only_what_is_drawn_is_opaque(ds, tmp_path) -> None:
    from workbench.scene import composition, layout

    settings = composition.Settings(1.0, 60, transparent=True, bare=True, size=(500, 400))
    layout.render(StoredStudy(ds), tmp_path / "clear.png", kind="plain", settings=settings)
    layout.render(StoredStudy(ds), tmp_path / "white.png", kind="plain", settings=replace(settings, transparent=False))
    with Image.open(tmp_path / "clear.png") as clear, Image.open(tmp_path / "white.png") as white:
        assert clear.size == white.size == (500, 400)
        over = Image.new("RGBA", clear.size, "white")
        over.alpha_composite(clear.convert("RGBA"))
        assert np.asarray(clear)[..., 3].min() == 0
        differ = np.abs(np.asarray(over.convert("RGB")).astype(int) - np.asarray(white.convert("RGB")))
    assert np.quantile(differ, 0.999) <= 6


@pytest.mark.slow
def test_the_table_of_a_figure_has_the_numbers_that_are_drawn(six, tmp_path, capsys) -> None:
    writing.write(six, tmp_path / "small.h5")
    for kind in ("lines", "map"):
        run(f"plot {tmp_path}/small.h5 --kind {kind} --out {tmp_path}/{kind}.png --data {tmp_path}/{kind}.csv --dpi 50")
    lines, cells = (
        list(csv.DictReader((tmp_path / f"{kind}.csv").read_text("utf-8").splitlines())) for kind in ("lines", "map")
    )
    law = [row for row in lines if row["y_label"].endswith("max κ [1/cm]") and row["kind"] == "dot"]
    at = stored_verdicts.verdicts(six)[0]["at"] or {"E": float(six["E"][0])}
    np.testing.assert_allclose([float(row["y"]) for row in law], six["kappa_max"].sel(at).values)
    curve = [row for row in lines if row["series"] == "R = 0.5 cm"]
    assert len(curve) >= six.sizes["u"]
    turns = {(float(row["x"]), float(row["value"])) for row in cells if row["panel"].endswith("number of bends")}
    assert {value for _, value in turns} == set(six["bends"].values.ravel().tolist())
    assert capsys.readouterr().out.splitlines()[-1] == str(tmp_path / "map.csv")


def test_a_full_disk_is_a_sentence_and_an_existing_picture_stays(tmp_path) -> None:
    class OnFullDisk(Figure):
        def savefig(self, fname, **options) -> None:
            Path(fname).write_bytes(b"half a pic")
            raise OSError(28, "No space left on device")

    path = tmp_path / "figure.png"
    path.write_bytes(b"earlier")
    with pytest.raises(InputError, match=r"cannot write .*figure.png: No space left on device"):
        canvas.save(OnFullDisk(), path)
    assert [one.read_bytes() for one in tmp_path.iterdir()] == [b"earlier"]


def test_maps_that_stand_one_below_the_other_have_equal_widths() -> None:
    ds = small.six()
    fig = map_figure.figure(StoredStudy(ds), sheet=sheet("paper", 89))
    fig.draw_without_rendering()
    boxes = [ax.get_position() for ax in fig.axes if ax.get_label() != "<colorbar>"]
    assert len(boxes) > 1
    np.testing.assert_allclose([box.x0 for box in boxes], boxes[0].x0, atol=1e-6)
    np.testing.assert_allclose([box.x1 for box in boxes], boxes[0].x1, atol=1e-6)


@pytest.mark.parametrize("inches", (0.7, 1.2, 2.0, 6.0))
@pytest.mark.parametrize("low, high", [(5e3, 4e4), (1e-3, 8e5), (0.5, 2.0), (12000.0, 98000.0)])
def test_no_two_numbers_of_an_axis_meet(low: float, high: float, inches: float) -> None:
    for logarithmic in (True, False):
        fig = Figure(figsize=(inches + 2, 1))
        ax = fig.add_axes((1 / (inches + 2), 0.5, inches / (inches + 2), 0.4))
        ax.set_yticks([])
        ax.tick_params(labelsize=fonts.SMALL)
        axis_scales.set_scale(ax.xaxis, (low, high), logarithmic)
        assert faults(fig) == []


def test_rods_are_solved_once_for_a_page_however_many_panels_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    page, choose = canvas.page, drawn_rods.choose
    pages, chosen = list[object](), list[object]()

    def page_that_is_too_low_once(*given, **more) -> Figure:
        pages.append(given)
        if len(pages) == 1:
            raise print_heights.TooLow("too low")
        return page(*given, **more)

    monkeypatch.setattr(canvas, "page", page_that_is_too_low_once)
    monkeypatch.setattr(drawn_rods, "choose", lambda *given, **more: (chosen.append(given), choose(*given, **more))[1])
    study_figure.figure(StoredStudy(small.study_dataset("pipe_horizontal")), sheet=sheet("paper", 89))
    assert len(pages) > 1
    assert len(chosen) == 1


def test_a_text_is_broken_where_it_leaves_its_room_and_not_before() -> None:
    text = "Developed curves: ρα to the right, z up, at one scale"
    whole = fonts.width_of(text, 9.5)
    assert fonts.break_lines(text, whole + 0.01, 9.5) == text
    lines = fonts.break_lines(text, 0.6 * whole, 9.5).split("\n")
    assert " ".join(lines) == text
    assert len(lines) == 2
    assert max(fonts.width_of(line, 9.5) for line in lines) <= 0.6 * whole
    cut = fonts.break_lines("a" * 200, 2.0, 9.5).split("\n")
    assert "".join(cut) == "a" * 200
    assert max(fonts.width_of(line, 9.5) for line in cut) <= 2.0


@pytest.mark.parametrize("inches", [1.5, 2.0, 2.5, 3.0])
def test_no_line_of_a_label_begins_with_a_unit_or_with_what_a_symbol_equals(inches: float) -> None:
    text = "internal force along the inward normal  F₁ [N], at FZ = −400 kN · sideways: true"
    lines = fonts.break_lines(text, inches, 9.5).split("\n")
    assert not [line for line in lines if line.startswith(("[", "·", "=", "−"))]
    assert max(fonts.width_of(line, 9.5) for line in lines) <= inches


def test_a_low_axis_has_the_first_and_the_last_of_its_numbers_where_two_have_room() -> None:
    fig = Figure(figsize=(3, 1))
    ax = fig.add_axes((0.3, 0.5, 0.22, 0.4))
    ax.tick_params(labelsize=fonts.SMALL)
    axis_scales.set_scale(ax.xaxis, (4500.0, 44000.0), True)
    fig.draw_without_rendering()
    assert len(ax.get_xticks()) == 2
    assert faults(fig) == []


def test_the_panels_of_samples_are_wide_enough_to_read_on_a_column() -> None:
    text = small.HEAD.replace("[units]", 'observables = ["turns_around", "kappa_max"]\n[units]')
    text += '[sample]\nsize = 32\nE = { from = 5e3, to = 4e4, distribution = "log-uniform" }\n'
    text += "".join(
        f"{name} = {{ from = {low}, to = {2 * low} }}\n" for name, low in (("R", 0.5), ("L", 10.0), ("F1", 3.0))
    )
    fig = scatter.figure(StoredStudy(in_memory.run(loads(text))), sheet=sheet("paper", 89))
    fig.draw_without_rendering()
    panels = [ax for ax in fig.axes if " against " in ax.get_label()]
    assert len(panels) == 8
    assert min(ax.get_window_extent().width for ax in panels) / fig.dpi > 0.55
    for ax in panels:
        boxes = [
            label.get_window_extent() for label in ax.get_xticklabels() if label.get_text() and label.get_visible()
        ]
        assert all(a.x1 < b.x0 for a, b in pairwise(boxes))


def test_the_tornado_and_its_options_are_for_print_too(tmp_path, capsys) -> None:
    picture = tmp_path / "tornado.pdf"
    line = ["sensitivity", "fig6", "--show", "height", "--fields", "E,R"]
    refused = {
        "--width is an option of the picture: give also --plot FILE": ["--width", "89"],
        "--dpi is an option of the picture: give also --plot FILE": ["--dpi", "100"],
        "the width must be from 60 to 500 mm, got 9": ["--plot", str(picture), "--width", "9"],
    }
    for said, more in refused.items():
        assert exit_status(*line, *more) == 2
        assert said in capsys.readouterr().err
    assert not picture.exists()
    assert exit_status(*line, "--plot", picture, "--style", "paper", "--width", "89", "--no-title") == 0
    assert "The change of each observable if a field rises by the amount beside it." in capsys.readouterr().out
    box = re.search(rb"/MediaBox \[ ?0 0 ([0-9.]+) ", picture.read_bytes())
    assert box is not None
    assert float(box[1]) == pytest.approx(72 * 89 / 25.4, abs=0.5)


def test_a_figure_without_a_title_has_no_room_for_one(six) -> None:
    tops = []
    for title in ("A title", ""):
        fig = canvas.figure((5, 3), lambda fig: fig.add_subplot(), StoredStudy(six).with_title(title))
        fig.draw_without_rendering()
        tops.append((1 - fig.axes[0].get_position().y1) * fig.get_figheight())
    assert tops[0] - tops[1] == pytest.approx(fonts.height_of("A title", fonts.LARGE), abs=0.02)  # one line


def test_an_entry_of_a_key_is_left_out_only_where_one_of_the_same_mark_says_more() -> None:
    fig = Figure(layout="constrained")
    ring, dash = {"marker": "o", "linestyle": "none", "color": "k"}, {"linestyle": "--", "color": "k"}
    labels = [("crossed", ring), ("crossed, also in a bend", ring), ("stable", {"color": "k"}), ("stable, held", dash)]
    canvas.write_below(fig, [Line2D([], [], label=label, **look) for label, look in labels])
    (legend,) = fig.legends
    assert [text.get_text() for text in legend.get_texts()] == ["crossed, also in a bend", "stable", "stable, held"]
