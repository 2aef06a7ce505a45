"""Diagrams of branches: a shape and its point have one number and one colour, and lines that coincide are one line."""

import json
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text

from solver import Case, Cylinder, Ends, Rod
from solver import equilibria as all_equilibria
from solver.observe.observables import observe
from solver.problem.case_fields import value_of, with_field
from studies import load
from tests.slow import slow_but
from tests.workbench import stored_figures
from tests.workbench.page_faults import share_of_red
from workbench.branches import branch_dataset, tracing
from workbench.branches.equilibria_dataset import as_dataset
from workbench.figures import (
    bifurcation,
    branch_lines,
    colours,
    drawn_numbers,
    equilibria_figure,
    point_numbers,
    print_heights,
    unrolled,
)
from workbench.figures.point_numbers import NumberedPoint
from workbench.figures.sheet import Sheet, sheet
from workbench.stored.stored_study import StoredStudy

ROD, CYLINDER = Rod(E=325.95, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75)


def swept(ends: Ends, name: str, values: np.ndarray) -> xr.Dataset:
    return branch_dataset.sweep(load("fig6"), Case(ROD, CYLINDER, ends), name, values, lambda *_: None)


@pytest.fixture(scope="module")
def dead() -> xr.Dataset:
    """Mirror images of equal height and energy among them, as the two end angles are equal."""
    return swept(Ends(beta0=0.5, betaL=0.5, FZ=-2.5), "FZ", np.linspace(-3.0, -2.3, 3))


@pytest.fixture(scope="module")
def held() -> xr.Dataset:
    return swept(Ends(beta0=0.5, betaL=0.5, FZ=-0.5), "height", np.linspace(2.0, 4.5, 4))


@pytest.fixture(scope="module")
def judged() -> xr.Dataset:
    """Branches on which the laws of a study were judged."""
    case = Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.4, FZ=-0.5))
    return branch_dataset.sweep(load("fig7_4_end_angle"), case, "betaL", np.linspace(0.2, 0.5, 3), lambda *_: None)


@pytest.fixture(scope="module")
def drawn(dead, held) -> dict[str, Figure]:
    return {"dead": bifurcation.figure(StoredStudy(dead)), "held": bifurcation.figure(StoredStudy(held))}


def points_of(ax) -> list:
    """The numbered points."""
    return [line for line in ax.lines if line.get_marker() == "o" and line.get_markersize() == 4.2]


def bare(ax) -> int:
    """At most so many points have a line from their number in place of a dot."""
    return sum(text.arrow_patch is not None for text in ax.texts)


def shapes(fig: Figure) -> list:
    """The lines of the unrolled views."""
    (ax,) = [ax for ax in fig.axes if ax.get_label() == unrolled.VIEWS]
    return [line for line in ax.lines if line.get_gid() != "s = 0"]


@pytest.mark.parametrize("which", ["dead", "held"])
def test_a_shape_has_the_look_of_its_line_whose_weight_says_whether_it_is_stable(which, drawn) -> None:
    """Under held ends it changes along one branch."""
    fig = drawn[which]
    seen = [to_hex(line.get_color()) for line in shapes(fig)]
    dots, left = [to_hex(dot.get_color()) for dot in points_of(fig.axes[0])], iter(seen)
    assert all(colour in left for colour in dots)  # in the order of the shapes
    assert len(seen) - bare(fig.axes[0]) <= len(dots)
    assert len({line.get_linewidth() for line in shapes(fig)}) > 1


def test_red_is_for_what_fails_alone(drawn) -> None:
    case = Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.5, FZ=-2.0))
    listed = equilibria_figure.figure(StoredStudy(as_dataset(load("fig6"), case, all_equilibria(case))))
    for fig in (*drawn.values(), listed):
        assert share_of_red(fig) == 0.0


def test_the_legend_has_stable_branches_first_and_those_without_a_false_law_before_others(judged) -> None:
    """Whatever the order of the branches is."""
    rows = json.loads(judged.attrs["branches"])
    for order in (rows, rows[::-1]):
        fig = bifurcation.figure(StoredStudy(judged.assign_attrs(branches=json.dumps(order))))
        texts = [text.get_text() for legend in (*fig.legends, fig.axes[0].get_legend()) if legend
                 for text in legend.get_texts() if "stable" in text.get_text()]  # fmt: skip
        assert texts == [
            "stable: no law is false",
            "stable: a law is false",
            "unstable: a law is false",
        ]


def test_branches_are_told_apart_without_their_colours(judged) -> None:
    """By the weight of their lines, which says whether they are stable, and by dashes."""
    lines = {line.get_label(): line for line in bifurcation.figure(StoredStudy(judged)).axes[0].lines}
    looks = [(line.get_linewidth(), line.get_linestyle()) for label, line in lines.items() if "stable" in str(label)]
    assert looks == [(1.7, "-"), (1.7, "--"), (0.8, "--")]


def test_each_branch_with_room_has_one_number(dead) -> None:
    """At the point of its shape, or on its line."""
    stored = StoredStudy(dead)
    for most in (8, 1):  # shapes
        kept = list(range(most))
        ax = Figure(figsize=(7, 4)).add_subplot()
        said = bifurcation.panel(stored, ax, "height", 3.0, chosen=kept, others=True)[1]
        found = sorted(int(k) for text in ax.texts for k in numbers_in(text.get_text()))
        assert found == [row["branch"] + 1 for row in stored.data("branches")]
        assert said == []


def test_a_diagram_says_how_many_branches_have_no_number(dead) -> None:
    stored, ax = StoredStudy(dead), Figure(figsize=(7, 0.6)).add_subplot()
    (said,) = bifurcation.panel(stored, ax, "height", 0.15, chosen=bifurcation.stable_shapes(stored)[:1], others=True)[
        1
    ]
    found, count = {k for text in ax.texts for k in numbers_in(text.get_text())}, len(stored.data("branches"))
    assert 0 < len(found) < count
    assert said == f"{count - len(found)} of the {count} branches have no number, for which there is no room."


def test_the_number_of_a_line_stands_on_it_where_it_covers_nothing_else() -> None:
    fig = Figure(figsize=(6, 3))
    ax = fig.add_axes((0, 0, 1, 1))
    ax.set(xlim=(0, 6), ylim=(0, 3))  # inches
    rows = {"1": (0.5, 5.5, 1.0), "2": (0.5, 5.5, 1.04), "3": (0.5, 5.5, 2.0), "4": (1.0, 1.2, 2.5)}
    on = [([name], np.array([[left, high], [right, high]])) for name, (left, right, high) in rows.items()]
    assert point_numbers.write(ax, [NumberedPoint(3.0, 2.0, "9")], [], [], (6.0, 3.0), on) == ([0], {"3", "9"})
    (beside, number) = ax.texts  # 1 and 2 would cover each other, 4 is too short
    assert (beside.get_text(), number.get_text(), number.get_position()[1]) == ("9", "3", 2.0)
    fig.draw_without_rendering()
    assert not Text.get_window_extent(number).overlaps(Text.get_window_extent(beside))
    assert abs(number.get_position()[0] - 3.0) > 0.1


def test_dots_of_nearly_one_energy_stand_side_by_side_and_keep_their_numbers() -> None:
    case = Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.5, FZ=-2.5))
    stored = StoredStudy(as_dataset(load("fig6"), case, all_equilibria(case)))
    fig = equilibria_figure.figure(stored)
    fig.draw_without_rendering()
    (ax,) = [ax for ax in fig.axes if ax.axison]
    places = [of.get_offset_transform().transform(of.get_offsets()) for of in ax.collections]
    assert len(places) > 1
    for one, other in combinations(np.concatenate(places), 2):
        assert np.hypot(*(one - other)) / fig.dpi > 0.9 * equilibria_figure.DOT
    drawn = sorted((x, y) for _, _, x, y, _ in drawn_numbers.rows(ax))
    assert drawn == sorted(zip(stored["index"].values, stored["energy"].values, strict=True))


def test_diagrams_of_branches_and_of_equilibria_show_what_is_stored(dead, drawn, judged) -> None:
    case = Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.5, FZ=-2.5))
    listed = as_dataset(load("fig6"), case, all_equilibria(case))
    pictures = {
        "under dead loads": lambda: drawn["dead"],
        "with a held height": lambda: drawn["held"],
        "any observable": lambda: bifurcation.figure(StoredStudy(dead), show=["energy"]),
        "with laws": lambda: bifurcation.figure(StoredStudy(judged)),
        "equilibria": lambda: equilibria_figure.figure(StoredStudy(listed)),
        "pushes of equilibria": lambda: equilibria_figure.figure(StoredStudy(listed), show=["push_max"]),
    }
    stored_figures.check("pictures_branches", pictures)


def test_lines_that_coincide_are_drawn_once(dead) -> None:
    """Mirror images have one height and one energy."""
    ax = Figure().add_subplot()
    bifurcation.panel(StoredStudy(dead), ax, "energy")
    thin = [line.get_xydata() for line in ax.lines if line.get_label() == "unstable"]
    unstable = [row["branch"] for row in StoredStudy(dead).data("branches") if row["index"]]
    names = ("curve_FZ", "curve_energy")
    curves = [np.stack([dead[n].values[dead["curve_branch"].values == b] for n in names], axis=1) for b in unstable]
    apart = {tuple(np.round(curve[[0, -1]], 6).ravel()) for curve in curves}
    assert len(thin) <= len(apart) < len(unstable)
    size = np.array([np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())])
    for curve in curves:  # none is lost
        assert any(max(np.linalg.norm((line - point) / size, axis=1).min() for point in curve) < 0.01 for line in thin)


def test_a_whole_number_along_a_branch_is_drawn_at_its_points_and_nowhere_in_between(held) -> None:
    """It has a gap where it changes; a smooth line would show numbers that no rod has."""
    numbers = (held["curve_FZ"].values > np.median(held["curve_FZ"].values)) * 1.0
    counted = held.assign(curve_bends=("curve_point", numbers, {"long_name": "number of bends", "units": "1"}))
    ax = Figure().add_subplot()
    bifurcation.panel(StoredStudy(counted), ax, "bends")
    lines = [line for line in ax.lines if line.get_linestyle() != "None"]
    assert len(lines) > 1
    assert {tuple(np.unique(line.get_ydata())) for line in lines} == {(0.0,), (1.0,)}


def test_of_many_branches_on_one_line_a_few_are_named(dead, monkeypatch) -> None:
    monkeypatch.setattr(bifurcation, "MOST_NAMED", 1)
    (said,) = bifurcation._alike(bifurcation._on_one_line(StoredStudy(dead), "height"))
    assert said == "Branches that share a line: 3 and 4; 2 more."


def test_one_branch_alone_has_a_row_of_shapes(held) -> None:
    assert len(StoredStudy(held).data("branches")) == 1
    assert held.sizes["shape"] == 8
    assert (np.diff(held["shape_height"].values) > 0).all()
    assert set(held["shape_branch"].values) == {0}


def test_numbers_cover_neither_each_other_nor_a_point() -> None:
    fig = Figure(figsize=(6, 3))
    ax = fig.add_axes((0, 0, 1, 1))
    ax.set(xlim=(0, 6), ylim=(0, 3))  # inches
    rng = np.random.default_rng(2)
    points = [
        NumberedPoint(float(x), float(y), str(k)) for k, (x, y) in enumerate(rng.uniform((2, 1), (4, 2), (14, 2)))
    ]
    points += [NumberedPoint(5.0, 2.0, "20"), NumberedPoint(5.0, 2.0, "21"), NumberedPoint(5.0, 2.0, "22")]
    point_numbers.write(ax, points, [], [], (6.0, 3.0))
    fig.draw_without_rendering()
    assert "20–22" in [text.get_text() for text in ax.texts]
    boxes = [Text.get_window_extent(text).transformed(ax.transData.inverted()) for text in ax.texts]
    for i, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[i + 1 :])
        assert not any(box.contains(point.x, point.y) for point in points)


def unclear(ax) -> list[str]:
    """The numbers without a line to their point that are not nearest to it; all distances in pixels."""
    ax.figure.draw_without_rendering()
    texts = [text for text in ax.texts if text.get_fontweight() != "bold"]  # not the letter of the panel
    places = ax.transData.transform([text.xy for text in texts])
    found = []
    for k, text in enumerate(texts):
        box = Text.get_window_extent(text)
        low, high = np.array([box.x0, box.y0]), np.array([box.x1, box.y1])
        gaps = np.linalg.norm(np.maximum(np.maximum(low - places, places - high), 0), axis=1)
        if text.arrow_patch is None and (np.delete(gaps, k) <= gaps[k]).any():
            found.append(text.get_text())
    return found


CLOSE = {
    "column": [(3.0, 0.4 + 0.29 * (k // 2) + 0.16 * (k % 2)) for k in range(10)],
    "cluster": [(3.0, 1.5), (3.05, 1.49), (3.1, 1.48), (2.7, 1.52)],
    "steep pair": [(3.0, 1.5), (3.03, 1.36)],
}


@pytest.mark.parametrize("name", CLOSE)
def test_a_number_is_nearest_to_its_own_point_or_has_a_line_to_it(name) -> None:
    ax = Figure(figsize=(6, 3)).add_axes((0, 0, 1, 1))
    ax.set(xlim=(0, 6), ylim=(0, 3))  # inches
    points = [NumberedPoint(x, y, str(k + 5)) for k, (x, y) in enumerate(CLOSE[name])]
    point_numbers.write(ax, points, [], [], (6.0, 3.0))
    assert len(ax.texts) == len(points)
    assert unclear(ax) == []
    for text in ax.texts:  # and the line can be seen
        if text.arrow_patch is not None:
            x, y = text.arrow_patch.get_path().get_extents().size / 100
            assert np.hypot(x, y) > 0.05


@pytest.mark.parametrize("which", ["dead", "held"])
def test_no_number_of_a_diagram_of_branches_is_nearer_to_another_point(which, drawn) -> None:
    assert unclear(drawn[which].axes[0]) == []


@pytest.fixture(scope="module")
def many() -> StoredStudy:
    """More branches than have room for their numbers, two of them stable."""
    case = Case(replace(ROD, L=32.0), CYLINDER, Ends(beta0=0.5, betaL=0.4, FZ=-2.5))
    ds = branch_dataset.sweep(load("fig6"), case, "FZ", np.linspace(-2.6, -2.5, 3), lambda *_: None)
    stored = StoredStudy(ds)
    assert len(stored.data("branches")) > 22
    return stored


SHEETS = {"screen": sheet(), "page": sheet("paper", 183), "column": sheet("paper", 89)}


@pytest.fixture(scope="module")
def figures_of_many(many) -> dict[str, Figure]:
    figures = {name: bifurcation.figure(many, on) for name, on in SHEETS.items()}
    for fig in figures.values():
        fig.draw_without_rendering()
    return figures


MARKED = {*bifurcation.MARKS, "fold: snaps through under a dead load"}


def numbers_in(text: str) -> set[str]:
    """The numbers of a text such as ``1, 4–6``."""
    ends = [part.split("–") for part in text.split(", ") if part[:1].isdigit()]
    return {str(k) for part in ends for k in range(int(part[0]), int(part[-1]) + 1)}


@pytest.mark.parametrize("name", SHEETS)
def test_of_many_branches_each_stable_one_has_its_number_and_its_rod_and_no_number_cuts_an_unstable_line(
    many, figures_of_many, name
) -> None:
    fig = figures_of_many[name]
    ax = fig.axes[0]
    numbers = set().union(*(numbers_in(text.get_text()) for text in ax.texts))
    stable = {str(row["branch"] + 1) for row in many.data("branches") if row["index"] == 0}
    assert stable <= numbers
    drawn = {str(line.get_gid()) for line in shapes(fig)}
    assert stable <= drawn <= numbers
    assert len(drawn) - bare(ax) <= len(points_of(ax)) <= len(drawn)
    curves = [line for line in ax.lines if len(line.get_xdata()) > 2 and line.get_linestyle() != "None"]
    thin = [line for line in curves if line.get_linewidth() < 1]
    for text in (text for text in ax.texts if numbers_in(text.get_text()) & drawn - stable):
        assert text.arrow_patch is None
        box = Text.get_window_extent(text)
        paths = [line.get_transform().transform_path(line.get_path()) for line in thin]
        assert not any(path.intersects_bbox(box, filled=False) for path in paths), text.get_text()


def test_nothing_of_an_unstable_branch_is_drawn_over_a_stable_one(many, figures_of_many, dead, drawn) -> None:
    for stored, fig in (*((many, fig) for fig in figures_of_many.values()), (StoredStudy(dead), drawn["dead"])):
        ax = fig.axes[0]
        lines = [line for line in ax.lines if line.get_linewidth() > 1 and line.get_label() == "stable"]
        over = min(line.get_zorder() for line in lines)
        dots = [dot for dot in points_of(ax) if to_hex(dot.get_color()) == colours.UNSTABLE["color"]]
        assert dots
        assert all(dot.get_zorder() < over for dot in dots)
        steady = [row["branch"] for row in stored.data("branches") if row["index"] == 0]
        ends = stored["fold"].values[~np.isin(stored["fold_branches"].values, steady).any(axis=1)]
        marks = [line for line in ax.lines if line.get_label() == "fold" and set(line.get_xdata()) <= {*ends}]
        assert all(mark.get_zorder() < over for mark in marks)
        assert len(marks) == bool(ends.size)


def test_no_dot_of_a_stable_rod_covers_a_mark_or_another_dot(figures_of_many, drawn) -> None:
    left_out = 0
    for fig in (*figures_of_many.values(), *drawn.values()):
        ax, touching = fig.axes[0], 72 / fig.dpi
        stable = [dot for dot in points_of(ax) if dot.get_zorder() > 4]
        dots = [ax.transData.transform(dot.get_xydata())[0] for dot in stable]
        others = [line for line in ax.lines if line.get_linestyle() == "None" and line.get_label() in MARKED]
        marks = [place for line in others for place in ax.transData.transform(line.get_xydata())]
        assert all(np.hypot(*(dot - mark)) * touching > 5.2 for dot in dots for mark in marks)  # points
        apart = [np.hypot(*(dot - other)) * touching for dot, other in combinations(dots, 2)]
        assert all(gap > 4.2 or gap < 72 * point_numbers.SAME for gap in apart)  # mirror images have one place
        left_out += len(shapes(fig)) - len(points_of(ax))
    assert left_out


@pytest.mark.parametrize("name", SHEETS)
def test_a_rod_of_a_diagram_of_branches_is_stable_or_large_enough_to_be_seen(figures_of_many, name) -> None:
    fig = figures_of_many[name]
    for line in (line for line in shapes(fig) if line.get_linewidth() < 1):
        places = line.get_transform().transform(line.get_xydata())
        assert np.ptp(places, axis=0).max() / fig.dpi > bifurcation.SMALLEST


def test_a_rod_is_left_out_as_too_small_where_it_would_be_so_beside_those_that_are_drawn(dead, monkeypatch) -> None:
    """Of thirty rods the small ones, for which all would be drawn smaller, are left out before the others."""
    sides = [8.0, 1.5, *[0.02] * 28]

    def views(stored, chosen, sheet) -> unrolled.UnrolledPanel:
        lines = [np.array([0.0, sides[k]]) for k in chosen]
        each = [unrolled.UnrolledView(line, line, f"{k}", {}) for k, line in zip(chosen, lines, strict=True)]
        return unrolled.UnrolledPanel(each, (6.0, 2.5), 8.0, "cm")

    monkeypatch.setattr(bifurcation, "_views", views)
    monkeypatch.setattr(bifurcation, "_is_stable", lambda stored, k: k == 0)
    whole = views(None, range(30), None)
    assert whole.form.scale * sides[1] < bifurcation.SMALLEST
    assert bifurcation._large_enough(StoredStudy(dead), range(30), sheet()) == [0, 1]
    assert views(None, [0, 1], None).form.scale * sides[1] >= bifurcation.SMALLEST


def test_an_unstable_rod_that_looks_like_one_before_it_is_left_out(dead) -> None:
    stored = StoredStudy(dead)
    stable = bifurcation.stable_shapes(stored)
    unstable = next(k for k in range(stored.sizes["shape"]) if k not in stable)
    again = [stable[0], stable[0], unstable, unstable]
    assert bifurcation._different(stored, again) == [stable[0], stable[0], unstable]


def test_a_column_leaves_rods_out_where_they_leave_the_diagram_too_little_height(many, monkeypatch) -> None:
    def count_rods(inches: float) -> int:
        monkeypatch.setattr(print_heights, "LEAST_AXES", inches)
        fig = bifurcation.figure(many, SHEETS["column"])
        return sum(len(shapes(fig)) for ax in fig.axes if ax.get_label() == unrolled.VIEWS)

    assert count_rods(1.0) > count_rods(4.0) == 0


@pytest.mark.parametrize("sizes", [[(10.0, 3.0)] * 3, [(0.2, 7.0), (7.0, 0.2)], [(5.0, 0.0)] * 9])
def test_shapes_in_rows_have_one_scale_and_neither_meet_nor_leave_the_page(sizes) -> None:
    views = [
        unrolled.UnrolledView(np.linspace(1, 1 + wide, 9), np.linspace(0, tall, 9), f"{k}", {})
        for k, (wide, tall) in enumerate(sizes)
    ]
    form = unrolled.plan(views, (6.0, 3.0), 8.0, (0.9, 0.6), even=False)
    low = form.places[: len(sizes), :2] + [0, unrolled.words_size("1", 8.0)[1]]
    high = low + form.scale * np.array(sizes)
    assert low.min() >= 0
    assert (high - np.array(form.size)).max() <= 1e-9
    assert form.size[1] <= 3.0
    for i, j in combinations(range(len(views)), 2):
        assert ((high[i] < low[j]) | (high[j] < low[i])).any()
    assert (high - low).max() > 0.6  # inches


def test_closed_rods_on_a_column_have_one_scale_in_both_directions() -> None:
    """Their words and their bar of colours leave room for three rows, and no view is a hair."""
    views = [
        unrolled.UnrolledView(np.array([0.0, wide]), np.array([0.0, 6.3]), "1: 1 wave\nstable\nenergy 0.04218 N cm", {})
        for wide in (4.6, 2.2, 1.5)
    ]
    assert unrolled.plan(views, (3.0, 3.5), 7.0, (3.0, 0.75), even=False).factor == 1.0


def test_a_small_view_contains_its_curve_in_its_middle() -> None:
    ax = Figure().add_subplot()
    unrolled.draw_inset(ax, (0, 0, 1, 1), np.array([1.0, 3.0]), np.array([-1.0, 0.0]), (4.0, 2.0), 1.0)
    (view,) = ax.child_axes
    assert (view.get_xlim(), view.get_ylim()) == ((0.0, 4.0), (0.5, -1.5))


def test_a_smooth_line_passes_through_its_points_and_follows_a_circle() -> None:
    angle = np.linspace(0, np.pi, 14) + np.random.default_rng(1).uniform(-0.04, 0.04, 14)
    x, y = np.cos(angle), np.sin(angle)
    found = np.stack(branch_lines.smooth(x, y, np.stack([x, y], axis=1)))
    for point in zip(x, y, strict=True):
        assert np.linalg.norm(found.T - point, axis=1).min() < 1e-12
    straight = max(1 - np.cos(np.diff(angle) / 2))  # how far the polygon is off
    assert np.abs(np.hypot(*found) - 1).max() < 0.3 * straight


def test_a_line_breaks_at_a_point_that_is_not_solved(held) -> None:
    missing = held.copy(deep=True)
    on = np.flatnonzero(held["curve_branch"].values == 0)
    k = int(on[on.size // 2])
    missing["curve_FZ"][k] = np.nan
    value = float(held["curve_height"].values[k])
    for ds, passes in ((held, True), (missing, False)):
        ax = bifurcation.figure(StoredStudy(ds)).axes[0]
        lines = [line.get_xydata() for line in ax.lines if line.get_linestyle() != "None" and len(line.get_xdata()) > 2]
        near = [np.abs(points - [value, held["curve_FZ"].values[k]]).max(axis=1).min() for points in lines]
        assert (min(near) < 1e-9) == passes


def random_axis(seed: int) -> tuple[Case, str, np.ndarray]:
    """A rod of 5 to 36 rho between random ends, and four values of one of its fields."""
    random = np.random.default_rng(seed)
    L = float(random.uniform(5, 36))
    beta0, betaL, FZ, MZ, M3 = map(float, random.uniform(-1.5, 1.5, 5))
    case = Case(Rod(EI=1.0, GJ=0.8, a=0.1, L=L), Cylinder(R=0.9), Ends(beta0, betaL, FZ=FZ, MZ=MZ, M3=M3))
    name = str(random.choice(["FZ", "MZ", "M3", "betaL", "L"]))
    low = float(value_of(case, name))
    return case, name, np.linspace(low, low + (0.5 if name == "L" else 0.05) * random.uniform(0.2, 2), 4)


@pytest.mark.parametrize("seed", slow_but(range(50), 1, 9, 11))
def test_curves_show_at_every_place_what_the_list_there_says(seed: int) -> None:
    case, name, values = random_axis(seed)
    ds = branch_dataset.sweep(load("fig6"), case, name, values, lambda *_: None)
    keys = ("energy", str(ds.attrs["shown"]))
    assert all(np.isfinite(ds[f"curve_{key}"].values).all() for key in keys)
    along, energies = ds[f"curve_{name}"].values, ds["curve_energy"].values
    for k, value in enumerate(values):
        for branch, energy in zip(ds["branch"].values[k], ds["energy"].values[k], strict=True):
            if branch >= 0:
                on = (ds["curve_branch"].values == branch) & (along == value)
                np.testing.assert_allclose(energies[on], energy, rtol=1e-12, atol=1e-12)
    between = np.random.default_rng(seed).choice(np.setdiff1d(along, values))
    listed = all_equilibria(with_field(case, name, float(between)))
    rows = np.array([[one.energy, observe(one.solution, keys)[keys[1]]] for one in listed])
    for k in np.flatnonzero(along == between):
        drawn = np.array([ds[f"curve_{key}"].values[k] for key in keys])
        assert (np.abs(rows - drawn).max(axis=1) < 1e-8 * (1 + np.abs(drawn).max())).any()


def test_a_branch_is_followed_once_also_where_a_value_of_the_axis_is_another_one_of_its_points_but_for_rounding(
    dead,
) -> None:
    even = np.linspace(-3.0, -2.3, tracing.FINE)
    values = np.array([-3.0, np.nextafter(even[tracing.FINE // 2], 0.0), -2.3])
    ds = swept(Ends(beta0=0.5, betaL=0.5, FZ=-2.5), "FZ", values)
    assert len(StoredStudy(ds).data("branches")) == len(StoredStudy(dead).data("branches"))


def test_the_cost_of_branches_over_an_angle_is_told_first_and_in_degrees() -> None:
    case = Case(Rod(E=325.95, nu=0.25, a=0.25, L=2.0), CYLINDER, Ends(beta0=0.5, betaL=0.5))
    said: list[str] = []
    ends = [-np.pi / 6, np.pi / 3]
    seen = tracing.trace_branches(case, "betaL", ends, 21, lambda words, *_: said.append(words))
    assert [len(members) for members in seen.found] == [1, 1]
    assert said[0] == "1 equilibrium at betaL = -30 deg, 1 equilibrium at betaL = 60 deg"
    assert said[1:] == ["betaL = 60 deg", "betaL = -30 deg: branch 1"]


def test_the_branch_of_the_mirror_images_is_the_one_that_is_followed_from_them() -> None:
    """A rod whose ends lie along the axis has its equilibria in pairs, of which one is followed."""
    case = Case(Rod(E=325.95, nu=0.25, a=0.25, L=10.0), CYLINDER, Ends(beta0=0.0, betaL=0.0))
    said: list[tuple[str, int, int]] = []
    values = [-3.0, -2.8, -2.6]
    seen = tracing.trace_branches(case, "FZ", values, 21, lambda *words: said.append(words))
    assert said[0] == (
        f"{len(seen.found[0])} equilibria at FZ = -3, {len(seen.found[-1])} equilibria at FZ = -2.6",
        0,
        3,
    )
    assert len(said) - 3 < len(seen.curves)  # one call for each value and each branch that is followed
    assert min(map(min, seen.branch)) >= 0
    for members, numbers in zip(seen.found, seen.branch, strict=True):
        slopes = {number: member.dbeta0 for member, number in zip(members, numbers, strict=True)}
        assert len(slopes) == len(members)
        np.testing.assert_allclose(sorted(slopes.values()), sorted(-slope for slope in slopes.values()), atol=1e-9)
    for curve in seen.curves:
        for point in (curve.points[0], curve.points[len(curve) // 3]):
            assert point.solution.solved
            np.testing.assert_allclose(point.solution.beta[-1], 0.0, atol=1e-9)


def test_a_diagram_without_rods_that_turn_back_has_the_range_of_the_others(dead) -> None:
    own = dead.copy()
    back = own["curve_branch"].values == 0
    own["curve_turned_back"] = own["curve_turned_back"].copy(data=back)
    left = StoredStudy(own).without("turned back")
    assert np.isnan(left["curve_height"].values[back]).all()
    np.testing.assert_array_equal(left["curve_height"].values[~back], dead["curve_height"].values[~back])
    ax = Figure(figsize=(6, 4)).subplots()
    bifurcation.panel(left, ax, "height", sheet=Sheet(ranges={"height": (1.0, 9.0)}))
    assert ax.get_ylim() == (1.0, 9.0)
    assert all(np.isfinite(line.get_ydata()).all() for line in ax.lines if np.size(line.get_xdata()) > 1)
