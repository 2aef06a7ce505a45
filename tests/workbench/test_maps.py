"""Maps of stored studies: borders, regions and their numbers; what maps show is in `test_words`."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from solver import solve
from solver.observe.observables import observe
from studies import load
from studies.language.loader import loads
from tests.workbench import small
from workbench.figures import canvas, map_cells, map_figure, map_panel, regions
from workbench.run import in_memory
from workbench.stored.stored_study import StoredStudy


@pytest.fixture(scope="module")
def regimes() -> xr.Dataset:
    return small.study_dataset("regimes")


def maps(fig: Figure) -> list:
    return [ax for ax in fig.axes if ax.get_title(loc="left")]


def test_borders_lie_between_cells_of_different_numbers_and_nowhere_else() -> None:
    numbers = np.array([[1, 1, 2], [1, 3, np.nan]])
    lines = regions.borders(numbers, np.arange(4.0), np.arange(3.0))
    found = {tuple(map(tuple, line)) for line in lines.tolist()}
    assert found == {((2, 0), (2, 1)), ((1, 1), (1, 2)), ((1, 1), (2, 1))}


def test_the_path_of_a_mask_covers_its_cells_alone() -> None:
    mask = np.random.default_rng(0).random((7, 9)) < 0.5
    path = regions.path(mask, np.arange(10.0), np.arange(8.0))
    middles = np.stack(np.meshgrid(np.arange(9) + 0.5, np.arange(7) + 0.5), axis=-1).reshape(-1, 2)
    np.testing.assert_array_equal(path.contains_points(middles).reshape(mask.shape), mask)


def test_a_box_lies_inside_its_region_and_has_no_place_where_it_does_not_fit() -> None:
    numbers = np.ones((40, 60))
    numbers[:, 30:] = 2
    numbers[5:8, 5:8] = 7  # too small for a number
    found = {number: regions.place(area, (0.05, 0.05), (0.4, 0.4)) for number, area in regions.areas(numbers)}
    assert found.pop(7) is None
    for number, (j, i) in found.items():
        assert (numbers[int(j) - 4 : int(j) + 4, int(i) - 4 : int(i) + 4] == number).all()


def test_the_regions_of_a_count_carry_their_counts(regimes) -> None:
    ax = maps(map_figure.figure(StoredStudy(regimes), show=["bends"]))[0]
    numbers = [text for text in ax.texts if text.get_text().isdigit()]
    assert {text.get_text() for text in numbers} == {str(n) for n in range(8)}
    for text in numbers:
        E, R = ax.transData.inverted().transform(ax.transAxes.transform(text.get_position()))
        assert regimes["bends"].sel(E=E, R=R, method="nearest") == int(text.get_text())


def test_a_rod_is_nearly_straight_by_its_angle_along_it_and_by_its_stored_amplitude_alike(regimes) -> None:
    stored = StoredStudy(regimes)
    choice = map_cells.choose(stored)
    along = map_cells.cells(stored, choice, {}).straight
    swing = regimes["beta"].max("u") - regimes["beta"].min("u")
    number = StoredStudy(regimes.drop_vars("beta").assign(amplitude=swing))
    assert 0 < along.mean() < 1
    np.testing.assert_array_equal(map_cells.cells(number, choice, {}).straight, along)


def test_the_two_regimes_of_the_page_are_those_of_the_potential() -> None:
    ds = in_memory.run(load("regimes").at_stations(401))
    highest = np.degrees(ds["beta"].max("u").values)
    near, bent = highest < 30, ds["bends"].values > 0  # a rod that ends before its first bend has not turned yet
    assert highest[near & bent].max() < 28
    assert highest[~near & bent].min() > 50
    # beta'^2 + G(beta) = h: beta turns where G is again that of the start, near the helix or beyond its saddle
    case, start = load("regimes").case(), np.radians(10.0)
    A, rho = (np.broadcast_to(one, near.shape)[..., None] for one in (case.rod.bending_stiffness, case.rho))
    FZ, FY = -10.0 * np.cos(start), -10.0 * np.sin(start)  # F3 = -10 and F2 = 0 at the start; M3 = 0
    twice_l = 2 * (FY * rho / A + np.sin(start) ** 3 / rho)

    def G(beta):
        return (twice_l - np.sin(beta) ** 3 / rho) * np.sin(beta) / rho + 2 * FZ / A * np.cos(beta)

    turns = (G(np.radians(np.linspace(10.01, 30, 2000))) > G(start)).any(axis=-1)
    np.testing.assert_array_equal(turns[bent], near[bent])
    np.testing.assert_array_equal((ds["attached"].values > 1 - 1e-9)[bent], near[bent])


def test_regions_reach_to_their_curves_and_into_a_cusp() -> None:
    """A wedge between two lines that meet: a lattice of nine cells a side shows it as steps."""
    x, y = np.meshgrid(*2 * [(np.arange(9) + 0.5) / 9])
    coarse = np.where(np.abs(y - 0.5) < 0.4 * (x - 0.15), 1, 0)
    lines = [np.array([[0.15, 0.5], [1.2, 0.5 + sign * 0.42]]) for sign in (-1, 1)]
    fine = regions.fine(coarse, lines)
    rows, columns = (np.indices(fine.shape) + 0.5) / np.array(fine.shape)[:, None, None]
    true = np.abs(rows - 0.5) < 0.4 * (columns - 0.15)
    repeated = np.kron(coarse, np.ones(np.array(fine.shape) // 9, dtype=int))
    assert (fine == true).mean() > 0.995
    assert (repeated == true).mean() < 0.97


def test_regions_without_a_curve_between_them_stay_as_they_are_stored() -> None:
    coarse = np.array([[0, 0, 1, 1], [0, 0, 1, 1]])
    fine = regions.fine(coarse, [])
    np.testing.assert_array_equal(fine, np.kron(coarse, np.ones(np.array(fine.shape) // (2, 4), dtype=int)))


@pytest.fixture(scope="module")
def refined() -> StoredStudy:
    """The shipped refined study, four times as coarse."""
    return StoredStudy(in_memory.run(loads(load("regimes_refined").text.replace("points = 400", "points = 100"))))


def test_a_rod_between_the_cases_of_a_refined_study_is_nearly_straight_where_its_own_angle_varies_little(refined):
    """In cells that are halved no more, beta of neighbours may jump, and the limit lies somewhere between the two."""
    raster = map_cells.raster_of(refined)
    choice = map_cells.choose(raster, show=["bends"])
    cells = map_cells.cells(raster, choice, choice.places()[0], refined)
    some = np.ix_(*(np.arange(0, size, 3) for size in cells.solved.shape))
    R, E = (row[some] for row in np.meshgrid(cells.y.values, cells.x.values, indexing="ij"))
    case = load("regimes_refined").case_of({"E": E, "R": R})
    amplitude = np.degrees(np.asarray(observe(solve(case), ["amplitude"])["amplitude"]))
    wrong = cells.straight[some] != (amplitude < 10)
    large = cells.stored["level"].values[some] < refined.refinement.lattice.depth
    assert 0.1 < cells.straight.mean() < 0.9
    assert large.mean() > 0.5
    assert not (wrong & large & (np.abs(amplitude - 10) > 1)).any()


def test_a_map_of_bends_shows_no_cases_that_were_added_where_a_number_changes_that_it_does_not_show(refined):
    (ax,) = maps(map_figure.figure(refined, show=["bends"]))
    shown = np.concatenate([line.get_xydata() for line in ax.lines if line.get_label() == "_samples"])
    level = dict(zip(zip(refined["E"].values, refined["R"].values, strict=True), refined["level"].values, strict=True))
    straight = dict(zip(level, refined.swings.values < np.radians(10), strict=True))
    pale = [level[tuple(place)] for place in shown if straight[tuple(place)]]
    assert pale == [0] * sum(straight[place] and level[place] == 0 for place in level)
    assert max(level[tuple(place)] for place in shown) > 3
    key = [text.get_text() for legend in ax.figure.legends for text in legend.get_texts()]
    assert [text.partition("; ")[2] for text in key if text.startswith("β varies")] == [map_panel.COARSE[2:]]
    assert [text for text in key if "(one of" in text] == [text for text in key if "outside the pale area" in text]
    assert len([text for text in key if "outside the pale area" in text]) == 1


def test_a_rod_that_turns_back_sets_no_scale_and_a_size_of_rounding_neither() -> None:
    axes = small.axis("E", [1e4, 2e4, 3e4]) + small.axis("R", [1.0, 1.2])
    ds = in_memory.run(small.study(axes, 'observables = ["push_max"]'))
    push = np.array([[1.0, 2.0], [3.0, 1e-13], [5.0, -4e8]])
    ds = ds.assign(push_max=(("E", "R"), push), caution=(("E", "R"), [["", ""], ["", ""], ["", "turned back"]]))
    stored = StoredStudy(ds)
    fig = map_figure.figure(stored, show=["push_max"])
    (mesh,) = [one for one in maps(fig)[0].collections if one.get_array() is not None]
    assert (mesh.norm.vmin, mesh.norm.vmax) == (1.0, 5.0)
    said = canvas.caption(fig)
    assert "1 of 6 rods turns back against both its ends and has no colour." in said
    assert "turns back against both its ends" in [text.get_text() for key in fig.legends for text in key.get_texts()]
    every = map_figure.figure(StoredStudy(ds.assign(caution=(("E", "R"), np.full((3, 2), "turned back")))))
    assert not any("no colour" in text for text in canvas.caption(every))  # all of them do


def test_one_case_far_from_all_others_does_not_take_the_scale_of_colours_and_is_told() -> None:
    axes = small.axis("E", [1e4, 2e4, 3e4, 4e4, 5e4, 6e4, 7e4]) + small.axis("R", [1.0, 1.1, 1.2, 1.3, 1.4, 1.5])
    ds = in_memory.run(small.study(axes, 'observables = ["push_max"]'))
    push = np.linspace(10.0, 20.0, 42).reshape(7, 6)
    for farthest, ends, extend in ((20.0, (10.0, 20.0), "neither"), (700.0, (10.0, push[-1, -2]), "max")):
        push[-1, -1] = farthest
        fig = map_figure.figure(StoredStudy(ds.assign(push_max=(("E", "R"), push))), show=["push_max"])
        (mesh,) = [one for one in maps(fig)[0].collections if one.get_array() is not None]
        assert (mesh.norm.vmin, mesh.norm.vmax) == pytest.approx(ends)
        assert mesh.colorbar.extend == extend
        told = [text for text in canvas.caption(fig) if "Beyond the colours" in text]
        assert [text.endswith("up to 700.") for text in told] == [True] * (extend == "max")


def test_each_mark_of_a_case_on_a_map_stands_in_its_legend(regimes) -> None:
    for cautions, marks in ((["", "lifts off"], 2), (["", ""], 1), (["lifts off"] * 2, 1)):
        ds = regimes.assign(caution=regimes["caution"].copy(data=np.resize(cautions, regimes["caution"].shape)))
        fig = map_figure.figure(StoredStudy(ds))
        words = [text.get_text() for key in fig.legends for text in key.get_texts()]
        assert sum(text.startswith("a case") for text in words) == marks


def test_maps_of_a_study_are_four_those_of_laws_first_and_the_others_are_named() -> None:
    names = ["bends", "height", "turns_around", "push_max", "attached", "kappa_max"]
    axes = small.axis("E", [1e4, 2e4]) + small.axis("R", [1.0, 1.2])
    law = small.law("kappa_max", "E", "falls")
    ds = in_memory.run(small.study(axes + law, f"observables = {names}"))
    stored = StoredStudy(ds)
    choice = map_cells.choose(stored)
    assert choice.shown[0] == "kappa_max"
    assert len(choice.shown) == 4
    varying = [name for name in stored.observables if not stored.is_level(name)]
    assert sorted([*choice.shown, *choice.left_out]) == sorted(varying)
    said = canvas.caption(map_figure.figure(stored))
    assert f"Not drawn: {', '.join(choice.left_out)}; choose with --show." in said
    assert map_cells.choose(stored, show=names).shown == tuple(names)
