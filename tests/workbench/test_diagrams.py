"""The kinds curves, ridge and portrait: the numbers of the dataset, the colours of the push, the level sets of G."""

import json
import sys
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from solver.orbits.potential import Loads, potential
from solver.problem.errors import InputError
from studies import load
from studies.grammar.axes import Axis
from studies.language.loader import loads
from studies.laws.line_verdicts import HOLDS, UNDECIDED
from tests.workbench import small
from tests.workbench.command import exit_status
from tests.workbench.page_faults import faults
from tests.workbench.small import six, study
from workbench.figures import (
    along_rods,
    arrangement,
    canvas,
    colours,
    drawn_numbers,
    drawn_rods,
    figure_kinds,
    fonts,
    legend_room,
    one_rod,
    phase_portrait,
    push_scale,
    section,
    study_figure,
    trends,
    unrolled,
    waves,
)
from workbench.figures.sheet import Sheet, sheet
from workbench.run import in_memory, writing
from workbench.stored.stored_study import StoredStudy
from workbench.words import labels

OUTPUTS = 'outputs = ["beta", "dbeta", "alpha", "z", "kappa", "contact"]\n'
AXIS = "[axes.E]\nvalues = [5e3, 1e4, 2e4, 4e4]\n"


@pytest.fixture(scope="module")
def ds() -> xr.Dataset:
    return in_memory.run(study(AXIS, OUTPUTS).at_stations(201))


@pytest.mark.parametrize("way", [1, -1])
def test_a_rod_that_winds_comes_back_on_the_unrolled_view_of_one_turn(way: int) -> None:
    rho, alpha, z = 2.0, way * np.linspace(0.0, 5 * np.pi, 400), np.linspace(0.0, 100.0, 400)
    view, _ = unrolled.view_of(z, rho, alpha, z, 0.1, "", {"color": "black"}, ringed=False)
    turn = 2 * np.pi * rho
    x, y = (np.concatenate([first, *(part[k] for part in view.over)]) for k, first in enumerate((view.x, view.y)))
    np.testing.assert_allclose(x, z)
    np.testing.assert_allclose(np.cos(y / rho), np.cos(alpha), atol=1e-9)
    assert len(view.over) == 2
    assert np.ptp(y) <= turn * (1 + 1e-9)
    assert y[0] == 0


def test_the_values_of_the_axis_stand_at_the_same_height_in_every_panel_of_a_ridge(ds) -> None:
    fig = along_rods.figure(StoredStudy(ds))
    fig.draw_without_rendering()
    heights = [[ax.transAxes.inverted().transform(ax.transData.transform((0, y)))[1] for y in ax.get_yticks()]
               for ax in fig.axes]  # fmt: skip
    np.testing.assert_allclose(heights[1], heights[0])
    np.testing.assert_allclose(heights[2], heights[0])
    assert [text.get_text() for text in fig.axes[0].get_yticklabels()] == ["5000", "10000", "20000", "40000"]


def test_no_curve_of_a_ridge_reaches_the_next_one(ds) -> None:
    for name, rad in (("beta", np.radians(1)), ("kappa", 1.0), ("push", 1.0)):
        (ax,) = along_rods.figure(StoredStudy(ds), show=[name]).axes
        steps = np.diff(ax.get_yticks())
        assert np.ptp(steps) < 1e-9 * steps.sum()
        curves = [rod[name] / rad for rod in drawn_rods.choose(StoredStudy(ds), (name,)).rods]
        assert all((low < high + steps[0]).all() for low, high in pairwise(curves))


def test_no_curve_of_a_ridge_reaches_the_line_of_a_rod_that_is_not_solved(ds) -> None:
    first = ds["E"] == ds["E"].min()
    alone = StoredStudy(ds.assign(solved=ds["solved"] & first, outcome=ds["outcome"].where(first, "failed: of no rod")))
    for name in ("kappa", "push"):
        (ax,) = along_rods.figure(alone, show=[name]).axes
        assert drawn_rods.choose(alone, (name,)).rods[0][name].max() < np.diff(ax.get_yticks())[0]


@pytest.mark.slow
def test_a_ridge_of_sixty_values_names_as_many_as_have_room() -> None:
    many = in_memory.run(study("[axes.E]\nfrom = 5e3\nto = 4e4\ncount = 61\n"))
    fig = along_rods.figure(StoredStudy(many))
    fig.draw_without_rendering()
    texts = [text for text in fig.axes[0].get_yticklabels() if text.get_text()]
    boxes = sorted((text.get_window_extent().y0, text.get_window_extent().y1) for text in texts)
    assert 15 < len(texts) <= 60
    assert all(low[1] <= high[0] for low, high in pairwise(boxes))
    assert "60 of the 61 values of E are shown" in " ".join(canvas.caption(fig))


def test_the_colours_of_a_line_are_those_of_the_one_definition() -> None:
    shares, shades = zip(*colours.DIVERGING, strict=True)
    norm = push_scale.scale([100.0 * np.array(shares)])
    drawn = 255 * colours.push_ramp()(norm(100.0 * np.array(shares)))[:, :3]
    far = np.array([abs(share) > 0.01 for share in shares])
    np.testing.assert_allclose(drawn[far], np.array(shades)[far], atol=3)
    assert drawn[~far].min(axis=-1).max() > 150  # pale at 0
    assert norm(-50.0) + norm(50.0) == pytest.approx(1.0)


def test_the_push_next_to_a_clamp_does_not_decide_the_colours_of_a_pipe() -> None:
    s = np.linspace(0, 20, 801)
    push = 2.0 + np.sin(s) ** 2 + 30 * np.exp(-8 * s) + 60 * np.exp(-8 * (20 - s))
    assert push_scale.away_from_ends(push).max() == pytest.approx(3.0, abs=1e-3)
    assert push_scale.away_from_ends(push[:200]).size < 200
    for other in (np.exp(-s), np.exp(s), np.ones(9)):
        assert push_scale.away_from_ends(other) == pytest.approx(other)
    klbf = {"length": "ft", "force": "klbf"}
    assert (push_scale.unit(klbf), push_scale.size(klbf)) == ("lbf/ft", pytest.approx(1000.0))


def test_rings_stand_on_the_rods_whose_caution_says_that_they_pass_through_themselves(ds) -> None:
    views = unrolled.panel_of(drawn_rods.choose(StoredStudy(ds), unrolled.NAMES), (8.0, 5.0), 8.0).views
    ringed = [bool(view.rings) for view in views]
    assert ringed == ["overlaps" in text for text in ds["caution"].values]
    assert any(ringed)
    assert not all(ringed)


def test_views_along_an_axis_have_columns_of_one_width_do_not_touch_and_are_as_large_as_the_page_allows(ds) -> None:
    rods = drawn_rods.choose(StoredStudy(ds), unrolled.NAMES)
    for room in ((8.0, 5.0), (2.9, 3.0), (8.0, 1.6)):
        panel = unrolled.panel_of(rods, room, 8.0)
        form, sizes = panel.form, np.array([view.size for view in panel.views])
        assert form.factor == 1
        assert (np.array(form.size) <= np.array(room) * (1 + 1e-9)).all()
        rows = [form.places[form.places[:, 1] == top, 2] for top in np.unique(form.places[:, 1])]
        wide = max(row.sum() + arrangement.GAP * (row.size - 1) for row in rows)  # with the key
        assert np.isclose((wide, form.size[1]), room, rtol=1e-5).any()
        np.testing.assert_allclose(np.diff(np.unique(form.places[:4, 0]), 2), 0, atol=1e-12)
        boxes = [
            (low, low + form.scale * size * [0, 1] + form.scale * sizes.max(axis=0) * [1, 0])
            for low, size in zip(form.places[:4, :2], sizes, strict=True)
        ]
        for k, (low, high) in enumerate(boxes):
            assert not any((low < other[1]).all() and (high > other[0]).all() for other in boxes[:k])


def test_unrolled_views_stand_in_falling_order_where_the_values_of_the_study_fall() -> None:
    for values, first, last in (([4e4, 1e4, 5e3], 4e4, 5e3), ([1e4, 4e4, 5e3], 5e3, 4e4)):
        rods = drawn_rods.choose(StoredStudy(in_memory.run(study(small.axis("E", values), OUTPUTS))), unrolled.NAMES)
        texts = [view.text for view in unrolled.panel_of(rods, (8.0, 5.0), 8.0).views]
        assert texts[0].startswith(f"E = {first:.0f}")
        assert texts[-1] == f"{last:.0f}"


def test_no_view_of_a_list_stands_before_the_one_that_it_follows() -> None:
    sizes = np.random.default_rng(0).uniform(0.1, 3.0, (200, 13, 2))
    stacked = 0
    for boxes in sizes:
        boxes[-1] = 0.0  # the key
        words = np.broadcast_to([0.3, 0.15], boxes.shape)
        places = arrangement.flow(boxes, words, (9.0, 7.0), 4, even=False, least=1e-3).places[:-1]
        for before, after in pairwise(places):
            assert after[1] > before[1] or (after[1] == before[1] and after[0] > before[0])
            stacked += bool(after[1] > before[1] and after[0] == before[0] > 0)
    assert stacked


def test_the_key_of_a_list_in_one_row_covers_no_view() -> None:
    sizes = np.random.default_rng(1).uniform(0.1, 3.0, (200, 4, 2))
    for boxes in sizes:
        boxes[-1] = 0.0
        words = np.array([*[[0.3, 0.15]] * 3, [0.75, 0.55]])
        *views, key = arrangement.flow(boxes, words, (3.0, 2.2), 1, even=False, least=1e-3).places
        assert all((key[:2] >= view[:2] + view[2:] - 1e-9).any() or (view[:2] >= key[:2] + key[2:]).any()
                   for view in views)  # fmt: skip


def test_flat_views_at_the_end_of_one_row_stand_one_below_the_other_and_the_key_below_them() -> None:
    """Side by side they would leave most of the page below them empty."""
    boxes = np.array([[1.2, 3.0], [1.2, 2.8], [1.3, 0.4], [1.2, 0.4], [0.0, 0.0]])
    words = np.array([*[[0.3, 0.15]] * 4, [0.9, 0.6]])
    places = arrangement.flow(boxes, words, (9.0, 3.2), 1, even=False, least=1e-3).places
    np.testing.assert_allclose(places[2:, 0], places[2, 0])
    assert (np.diff(places[2:, 1]) > 0).all()
    assert (places[:3, 1] == 0).all()
    assert (places[2:, 1] + places[2:, 3]).max() <= places[0, 3] + 1e-9


def test_the_key_of_one_row_covers_no_view() -> None:
    for boxes in np.random.default_rng(1).uniform(0.3, 3.0, (200, 4, 2)):
        boxes[-1] = 0.0  # the key
        words = np.array([*[[0.3, 0.15]] * 3, [0.9, 0.6]])
        places = arrangement.flow(boxes, words, (2.9, 2.4), 1, even=False, least=1e-3).places
        left, top, wide, high = places.T
        beside = (left[:-1] + wide[:-1] <= left[-1] + 1e-9) | (left[-1] + wide[-1] <= left[:-1] + 1e-9)
        above = (top[:-1] + high[:-1] <= top[-1] + 1e-9) | (top[-1] + high[-1] <= top[:-1] + 1e-9)
        assert (beside | above).all()


def test_a_label_is_in_words_where_two_lines_have_room_for_them_and_no_line_ends_within_its_symbol() -> None:
    array = xr.DataArray(1.0, attrs={"symbol": "max κ", "long_name": "largest curvature", "units": "1/cm"})
    label = partial(labels.label, array)
    assert fonts.fit_label(label, 9.0) == "largest curvature  max\N{NO-BREAK SPACE}κ [1/cm]"
    assert fonts.fit_label(label, 1.5).split("\n") == ["largest curvature", "max\N{NO-BREAK SPACE}κ [1/cm]"]
    assert fonts.fit_label(label, 1.5, most=1) == fonts.fit_label(label, 0.5) == "max κ [1/cm]"
    assert fonts.fit_label(lambda full: "mean curvature [1/cm]" if full else "mean κ [1/cm]", 1.05) == "mean κ [1/cm]"
    assert fonts.fit_label(lambda full: "mean curvature [1/cm]", 1.25).split("\n") == ["mean", "curvature [1/cm]"]


def test_a_line_in_the_colours_of_the_push_is_thin_where_the_rod_would_lift_off_and_grey_without_a_push() -> None:
    ax, push = Figure().add_subplot(), np.array([2.0, 1.0, -1.0, -1e-12, 0.0, 0.0])
    s = np.arange(6.0)
    push_scale.line(ax, s, np.zeros(6), push, push_scale.scale([push]), 2.0)
    (coloured,) = ax.collections
    np.testing.assert_allclose(coloured.get_linewidths(), [2.0, 2.0, 0.8, 2.0, 0.0, 0.0])  # no colour without a push
    thin, wide = ax.lines
    assert 2 * thin.get_linewidth() < wide.get_linewidth() + 0.1
    for casing, stations in ((thin, [2, 4, 5]), (wide, [0, 1, 3])):
        x = np.asarray(casing.get_xdata(), dtype=float)
        assert {*np.rint(x[1::3][np.isfinite(x[1::3])])} == {*map(float, stations)}


def test_a_legend_that_covers_a_word_of_its_axes_is_put_below_them() -> None:
    for covered in (False, True):
        fig = Figure(figsize=(4, 3), dpi=100, layout="constrained")
        FigureCanvasAgg(fig)
        ax = fig.add_subplot()
        ax.plot([0, 1], [0, 0], label="line")
        ax.scatter([0, 1], [0, 0], label="dot")  # whose box in the legend is not known
        ax.set_ylim(-1, 1)
        ax.text(0.95 if covered else 0.05, 0.9, "word")
        ax.legend(loc="upper right")
        assert bool(legend_room.clear(fig)) is covered
        assert {text.get_text() for text in ax.get_legend().get_texts()} == {"line", "dot"}


def wound(turns: float, side: str = "outside", a: float = 1.0, beta: float = np.radians(80.0)) -> StoredStudy:
    """A helix, with the forces that keep it: A sin^3/rho^2 across the axis."""
    A, R = 200.0, 5.0
    rho = R + a if side == "outside" else R - a
    across = A * np.sin(beta) ** 3 / rho**2
    rod = {
        "EI": A,
        "GJ": 2 * A,
        "a": a,
        "R": R,
        "L": turns * 2 * np.pi * rho / np.sin(beta),
        "beta": beta,
        "dbeta": 0.0,
    }
    text = small.text(rod | {"F2": -across * np.cos(beta), "F3": across * np.sin(beta), "M3": 0.0, "side": side},
                      outputs=["beta", "dbeta", "alpha", "z"], stations=101)  # fmt: skip
    return StoredStudy(in_memory.run(loads(text)))


@pytest.mark.parametrize(("side", "rho"), [("outside", 6.0), ("inside", 4.0)])
def test_the_gaps_of_a_section_are_the_pitch_of_a_helix_less_its_thickness_along_the_axis(
    side: str, rho: float
) -> None:
    stored, beta = wound(3.5, side), np.radians(80.0)
    cut = section.section_of(stored.centreline)
    assert cut.z.size == 4
    np.testing.assert_allclose(cut.radius, rho)
    # the helix of the march, not the formula's: tol 1e-8 of a rod of some 100 lengths
    np.testing.assert_allclose(cut.gaps, 2 * np.pi * rho / np.tan(beta) - 2 / np.sin(beta), atol=1e-5)
    said = " ".join(canvas.caption(section.figure(stored)))
    assert f"4 turns of radius 1 cm, with gaps of {cut.gaps[0]:.4g} cm between them" in said


@pytest.mark.parametrize("side", ["outside", "inside"])
@pytest.mark.parametrize(("a", "beta"), [(0.1, 80.0), (1.0, 88.0)], ids=["wide gaps", "turns through each other"])
def test_the_gaps_of_a_section_are_written_beside_its_turns_and_clear_of_each_other(
    side: str, a: float, beta: float
) -> None:
    stored = wound(3.5, side, a, np.radians(beta))
    fig = section.figure(stored)
    assert faults(fig) == []
    (ax,) = fig.axes
    z = section.section_of(stored.centreline).z
    for text in ax.texts:
        assert np.abs((z[1:] + z[:-1]) / 2 - text.xy[0]).min() < 1e-3 * a  # between turns of one size
        box = text.get_window_extent()
        assert ax.bbox.y0 < box.y0
        assert box.y1 < ax.bbox.y1


def test_a_section_of_less_than_two_turns_is_refused() -> None:
    with pytest.raises(InputError, match=r"makes 0\.9 turns around the cylinder; choose --kind lines or curves"):
        section.figure(wound(0.9))


def test_a_section_whose_turns_are_points_at_one_scale_is_refused() -> None:
    with pytest.raises(InputError, match=r"its 4 turns at one scale, and these are 280 times as far apart"):
        section.figure(wound(3.5, a=0.01))


def test_of_more_than_twelve_rods_nine_are_read_the_first_and_the_last_among_them() -> None:
    stored = StoredStudy(in_memory.run(study(small.axis("E", (1e4, 2e4, 17)), 'outputs = ["alpha", "z"]')))
    for count, drawn in ((17, 9), (12, 12)):
        chosen = drawn_rods.choose(stored.select({"E": [*range(count)]}), ("alpha", "z"))
        assert [float(chosen.rods[k].case["E"]) for k in (0, -1)] == [*stored["E"].values[[0, count - 1]]]
        assert len(chosen.rods) == drawn


def test_the_states_of_a_legend_stand_in_their_order_before_lines_and_marks() -> None:
    ax = Figure().subplots()
    ax.plot([0, 1], "o", linestyle="None", label="a mark")
    for name in ("a line", "helical", "sinusoidal", "straight but for slight bends"):
        ax.plot([0, 1], label=name)
    names = [entry.get_label() for entry in canvas.legend_entries(ax)]
    assert names == ["straight but for slight bends", "sinusoidal", "helical", "a line", "a mark"]


def test_a_rod_lies_on_its_level_and_a_separatrix_passes_through_the_saddles(ds) -> None:
    fig = phase_portrait.figure(StoredStudy(ds), at={"E": 1e4})
    phase, well = fig.axes
    one = ds.sel(E=1e4)
    A = np.pi / 16 * 1e4 * 0.25**4  # the paper's stiffness
    rho = float(one["rho"])
    loads = Loads(float(one["MZ"]) * rho / A, float(one["M3"]) * rho / A, float(one["FZ"]) * rho**2 / A)
    h = float(one["dbeta"][0] ** 2 + potential(loads, float(one["beta"][0])) / rho**2)
    (level,) = [line for line in well.lines if line.get_gid() == "h"]
    np.testing.assert_allclose(level.get_ydata(), h)
    saddles = np.concatenate([line.get_xdata() for line in phase.lines if line.get_gid() == "saddle"])
    assert saddles.size
    for line in (line for line in phase.lines if line.get_gid() in ("separatrix", "rod", "_level")):
        beta, rate = np.radians(line.get_xdata()), np.asarray(line.get_ydata())
        drawn = np.isfinite(rate)
        E = rate[drawn] ** 2 + potential(loads, beta[drawn]) / rho**2
        np.testing.assert_allclose(E, E[0], atol=1e-6 * np.abs(E).max())
        if line.get_gid() == "separatrix":
            np.testing.assert_allclose(E[0], potential(loads, np.radians(saddles[0])) / rho**2, rtol=1e-6)
            assert np.interp(saddles[0], np.degrees(beta[drawn]), rate[drawn]) == pytest.approx(0, abs=1e-6)
    e = 1e-4
    for saddle in np.radians(saddles):
        G = potential(loads, saddle + np.array([-e, 0, e]))
        assert G[1] > max(G[0], G[2])


def test_a_file_that_no_longer_fits_its_study_is_drawn_as_stored_and_says_so(ds) -> None:
    changed = ds.assign_attrs(study=str(ds.attrs["study"]).replace("[axes.E]", "[base]\ndbeta = 0.51\n[axes.E]"))
    found = drawn_rods.choose(StoredStudy(changed), ("alpha", "z", "push"))
    parts = (found.rods[0]["z"].size - 1) // 200
    np.testing.assert_allclose(found.rods[0]["z"][::parts], ds["z"][0], atol=1e-12)
    why = "solved again, the cases have other shapes than the file: alpha differs"
    assert found.notes == [f"Drawn at the 201 stored stations: {why}."]
    unknown = ds.drop_vars("contact").drop_vars("beta")
    unknown.attrs.pop("study")
    with pytest.raises(
        InputError, match="does not store push, and its cases cannot be solved again: the dataset holds no"
    ):
        drawn_rods.choose(StoredStudy(unknown), ("alpha", "z", "push"))


def test_what_is_drawn_between_stored_stations_is_what_a_dense_solve_says(ds) -> None:
    dense = in_memory.run(study(AXIS, OUTPUTS).at_stations(8001)).assign_attrs(study="")
    names = ("beta", "alpha", "z", "kappa", "push")
    true = drawn_rods.choose(StoredStudy(dense), names)
    for file in (ds, ds.assign_attrs(study="")):
        for rod, other in zip(drawn_rods.choose(StoredStudy(file), names).rods, true.rods, strict=True):
            for name in names:
                off = np.abs(np.interp(other["s"], rod["s"], rod[name]) - other[name]).max()
                assert off <= np.ptp(np.concatenate([one[name] for one in true.rods])) / drawn_rods.SHADES


@pytest.mark.parametrize("stations", [5, 21])
def test_a_file_whose_stations_are_too_few_for_a_picture_is_refused_with_their_number(stations: int) -> None:
    few = in_memory.run(study(AXIS, OUTPUTS).at_stations(stations)).assign_attrs(study="")
    for draw in (unrolled.figure, along_rods.figure, phase_portrait.figure, study_figure.figure):
        with pytest.raises(InputError, match=rf"{stations} stations are too few to draw .*: store about \d+ \(station"):
            draw(StoredStudy(few))


def test_waves_of_less_than_four_pixels_are_the_band_from_their_least_to_their_largest() -> None:
    x = np.linspace(0, 1, 20001)
    swings = 3 + (1 + x) * np.cos(2 * np.pi * 400 * x)
    (band,) = waves.stretches(x, swings, 10.0)  # 2.5 pixels a wave
    at, low, high = band.band
    inner = (at > 0.01) & (at < 0.99)
    np.testing.assert_allclose(high[inner], 4 + at[inner], atol=0.005)  # a wave in 400 grows by 0.0025
    np.testing.assert_allclose(low[inner], 2 - at[inner], atol=0.005)
    (line,) = waves.stretches(x, swings, 20.0)  # 5 pixels a wave
    assert line.band is None
    both = np.where(x < 0.5, swings, np.sin(2 * np.pi * x))
    kinds = [(stretch.band is None, stretch.of.start, stretch.of.stop) for stretch in waves.stretches(x, both, 10.0)]
    assert [is_line for is_line, _, _ in kinds] == [False, True]
    assert abs(kinds[0][2] - 10001) <= 60  # within a wave of 50 points
    assert kinds[1][1] == kinds[0][2] - 1


def test_a_band_of_waves_as_wide_as_its_pieces_has_no_notches() -> None:
    x = np.linspace(0, 1, 20001)
    crests = np.cos(2 * np.pi * 130 * x + 40 * x**2)  # 3.1 pixels a wave at first, 1.9 at last
    swings = 2 + crests + 0.5 * np.cos(np.pi * 130 * x + 20 * x**2)  # every other crest is lower
    (band,) = waves.stretches(x, swings, 4.0)
    _, low, high = band.band
    np.testing.assert_allclose(high, 3.5, atol=0.02)  # at its ends too
    assert np.ptp(low) < 0.02


def test_what_is_not_stored_is_solved_again(ds) -> None:
    bare = in_memory.run(study(AXIS, "outputs = []\n").at_stations(201))
    for name in ("beta", "kappa"):
        for one, other in zip(
            drawn_rods.choose(StoredStudy(bare), (name,)).rods,
            drawn_rods.choose(StoredStudy(ds), (name,)).rods,
            strict=True,
        ):
            np.testing.assert_allclose(one[name][::5], np.interp(one["s"][::5], other["s"], other[name]), atol=1e-5)


def test_equal_peaks_of_push_are_drawn_equal_however_few_stations_are_stored() -> None:
    ds = in_memory.run(
        study("[axes.E]\nvalues = [1e4]\n", 'observables = ["push_max"]\noutputs = ["contact", "beta"]\n')
    )
    for stored in (ds, ds.isel(E=0)):
        push = one_rod.figure(StoredStudy(stored)).axes[1].lines[1].get_ydata()  # where the cylinder pushes
        peaks = push[1:-1][(push[1:-1] > push[:-2]) & (push[1:-1] > push[2:]) & (push[1:-1] > 160)]
        assert peaks.size == 6
        np.testing.assert_allclose(peaks, ds["push_max"].values[0], rtol=1e-3)  # a third of a pixel


def test_a_whole_number_is_drawn_where_a_case_has_it_and_brackets_hold_its_changes() -> None:
    coarse = small.study_dataset("fig7_1_modulus")
    axis = Axis.model_validate({"from": 5e3, "to": 4e4, "count": 400, "spacing": "geometric"})
    lean = {"axes": {"E": axis}, "laws": [], "observables": ["bends"], "outputs": []}
    fine = in_memory.run(load("fig7_1_modulus").model_copy(update=lean))
    E, turns = fine["E"].values, fine["bends"].values
    jumps = [(E[k], E[k + 1]) for k in np.flatnonzero(np.diff(turns))]
    assert len(jumps) == 3
    for ds, wide in ((coarse, True), (fine, False)):
        ax = trends.trend(StoredStudy(ds).trend("bends", "E"), Figure(figsize=(5, 3)).subplots())
        brackets = [line for line in ax.lines if line.get_label() == trends.BRACKET]
        assert len(brackets) == 3 * wide
        for (low, high), line in zip(jumps, brackets, strict=wide):
            first, last = line.get_xdata()
            assert (first <= low) & (high <= last)
        (curve, *steps) = [line for line in ax.lines if line not in brackets]
        rises = np.diff(curve.get_ydata())
        assert not rises[np.isfinite(rises)].any()
        for line in steps:
            x, y = line.get_xdata(), line.get_ydata()
            places = x[np.flatnonzero(np.abs(np.diff(y)) > 0)]
            assert [low < place < high for place, (low, high) in zip(places, jumps, strict=True)] == [True] * 3
        assert len(steps) == (not wide)
        assert {y for *_, y, _ in drawn_numbers.rows(ax)} == set(turns)


def test_drawing_leaves_no_state_behind(tmp_path) -> None:
    import matplotlib

    before = dict(matplotlib.rcParams)
    canvas.save(study_figure.figure(StoredStudy(small.six())), tmp_path / "figure.png")
    assert dict(matplotlib.rcParams) == before
    assert "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()


def test_rods_that_turn_back_enter_no_law_unless_it_says_so_and_a_diagram_can_leave_them_out() -> None:
    ds = small.study_dataset("fig7_1_modulus")
    texts = ds["caution"].values.astype(object)
    texts[3] = "turned back"
    ds["caution"] = ds["caution"].copy(data=texts)
    stored = StoredStudy(ds)
    (law,) = stored.verdicts
    assert law["verdict"] == UNDECIDED
    assert law["reason"].endswith("1 of 9 rods turns back and is left out")
    own = ds.assign_attrs(laws=json.dumps([row | {"turned_back": True} for row in json.loads(ds.attrs["laws"])]))
    assert StoredStudy(own).verdicts[0]["verdict"] == HOLDS
    left = stored.without("turned back")
    assert np.flatnonzero(np.isnan(left["bends"].values)).tolist() == [3]
    np.testing.assert_array_equal(np.delete(left["bends"].values, 3), np.delete(ds["bends"].values, 3))
    with pytest.raises(InputError, match="no caution 'far away'"):
        stored.without("far away")


def test_the_vertical_axis_of_an_observable_has_the_range_that_is_asked_for() -> None:
    drawn = study_figure.figure(
        StoredStudy(six()), sheet=Sheet(ranges={"turns_around": (0.5, 2.0)}), show=["bends", "turns_around"]
    )
    ends = {ax.get_label(): ax.get_ylim() for ax in drawn.axes}
    assert (0.5, 2.0) in ends.values()
    assert len(set(ends.values())) > 1


@pytest.mark.parametrize(
    "words",
    [
        "bends=-inf:inf", "bends=0:inf", "bends=1:1", "bends=2:1", "bends=-1e308:1e308", "bends=nan:1",
        "E=0:1", "bends=1:2 --kind curves",
    ],
)  # fmt: skip
def test_a_range_that_no_axis_can_have_is_refused_and_nothing_is_drawn(words: str, ds, tmp_path, capsys) -> None:
    file = writing.write(ds, tmp_path / "mine.h5")
    assert exit_status("plot", str(file), "--range", *words.split()) == 2
    assert "--range" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [file]


def test_a_range_without_an_axis_in_the_picture_is_said(ds, tmp_path, capsys) -> None:
    file = writing.write(ds, tmp_path / "mine.h5")
    assert exit_status("plot", str(file), "--show", "height", "--range", "bends=0:9", "--range", "height=-9:99") == 0
    said = capsys.readouterr().err
    assert "no vertical axis of bends" in said
    assert "height" not in said


def test_pale_lines_and_formulas_of_a_grid_are_named_and_bars_are_of_what_varies_along_their_axis() -> None:
    stored = StoredStudy(small.study_dataset("capstan"))
    drawn = figure_kinds.figure(stored, "lines")
    told = {text.get_text() for ax in drawn.axes for text in ax.texts}
    assert {"w = 0 N/m", "w = 20 N/m"} <= told
    for axis, varies in (("friction", True), ("weight", False)):
        bars = figure_kinds.figure(stored, "bars", x=axis)
        titles = {ax.get_title(loc="left") for ax in bars.axes}
        assert ("gain" in titles) == varies
        assert any(sentence.startswith("Here pull = ") for sentence in canvas.caption(bars))


def test_helices_of_many_turns_are_drawn_among_lines() -> None:
    column = Sheet(style="paper", width=89 / 25.4)
    drawn = figure_kinds.figure(StoredStudy(small.study_dataset("pipe_lubinski")), "lines", column)
    assert any(ax.get_label() == unrolled.VIEWS for ax in drawn.axes)
    assert not any(study_figure.BEND_LESS in sentence for sentence in canvas.caption(drawn))


@pytest.mark.parametrize(
    ("name", "kind"), [("capstan", "map"), ("capstan", "bars"), ("capstan", "lines"), ("pipe_vertical", "lines")]
)
def test_each_observable_is_drawn_or_named_in_the_caption(name: str, kind: str) -> None:
    stored = StoredStudy(small.study_dataset(name))
    fig = figure_kinds.figure(stored, kind, sheet("paper", 89, titled=False))
    (left_out,) = (text for text in canvas.caption(fig) if text.startswith(canvas.NOT_DRAWN))
    judged = {law.observable for law in stored.laws}
    drawn = " ".join(" ".join(text.get_text().split()) for text in fig.findobj(Text)).lower()
    for observable in stored.observables:
        noun = labels.long_name(stored[observable]).lower()
        if stored.is_level(observable):  # it is written, if not by a law
            assert noun in " ".join(canvas.caption(fig)).lower() or observable in judged
        else:
            assert observable in left_out or noun in drawn, observable


def test_what_is_the_same_along_all_rods_is_written_and_not_drawn() -> None:
    stored = StoredStudy(small.study_dataset("capstan"))
    for kind, whose, panels in (("ridge", "all rods", 1), ("rod", "the rod", 2)):
        fig = figure_kinds.figure(stored, kind)
        assert f"Angle β to the axis: 90° along {whose}." in canvas.caption(fig)
        assert len(fig.axes) == panels
    fig = figure_kinds.figure(stored, "ridge", show=["beta", "kappa"])
    assert len(fig.axes) == 2  # as it was asked for
    assert not any(" along all rods" in text for text in canvas.caption(fig))


@pytest.mark.parametrize(("name", "bends"), [("pipe_vertical", True), ("pole_greenhill", False)])
@pytest.mark.parametrize("kind", ["states", "pipe"])
def test_slight_bends_are_told_where_a_straight_pipe_has_some(name: str, bends: bool, kind: str) -> None:
    fig = figure_kinds.figure(StoredStudy(small.study_dataset(name)), kind)
    (legend,) = fig.legends
    assert ("straight but for slight bends" in {text.get_text() for text in legend.get_texts()}) == bends
    assert any("bend is slight" in text for text in canvas.caption(fig)) == bends
