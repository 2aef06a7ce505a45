"""Maps of stored studies: they show the numbers of the file, where they hold, and nothing else."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch

from studies import load
from studies.laws.line_verdicts import HOLDS, VERDICTS, judge
from tests.workbench import small
from tests.workbench.small import THREE, law, study
from workbench.figures import canvas, colours, drawn_numbers, kinds, map_figure, map_panel, regions
from workbench.store import in_memory, law_verdicts


@pytest.fixture(scope="module")
def regimes() -> xr.Dataset:
    return small.study_dataset("regimes")


@pytest.fixture(scope="module")
def three() -> xr.Dataset:
    return in_memory.run(study(THREE, 'observables = ["turns", "wraps"]'))


def meshes(fig: Figure) -> list:
    """The coloured cells of each map, without strips of verdicts and bars of colours."""
    return [mesh for ax in maps(fig) for mesh in ax.collections if hasattr(mesh, "get_coordinates")]


def maps(fig: Figure) -> list:
    return [ax for ax in fig.axes if ax.get_title(loc="left")]


def with_cells(ds: xr.Dataset, unsolved: np.ndarray, pulled: np.ndarray, unknown: np.ndarray) -> xr.Dataset:
    """The dataset with other cells that are not solved, lift off, or have no number of bends."""
    texts = np.where(unsolved, "", np.where(pulled, "pulled", "")).astype(object)
    turns = np.where(unsolved | unknown, np.nan, ds["turns"].values)
    changed = {"solved": ~unsolved, "caution": texts, "turns": turns}
    return ds.assign({name: ds[name].copy(data=values) for name, values in changed.items()})


def test_a_map_shows_the_stored_number_in_the_cell_of_its_two_values(regimes) -> None:
    for x, y in (("E", "R"), ("R", "E")):
        fig = map_figure.figure(regimes, x, y)
        for mesh, name in zip(meshes(fig), ("turns", "attached"), strict=True):
            shown = mesh.get_array().reshape(regimes.sizes[y], regimes.sizes[x])
            straight = np.ptp(regimes["beta"].transpose(y, x, "u").values, axis=-1) < np.radians(10)
            assert 50 < straight.sum() < 200  # their bends are too slight to be coloured
            expected = np.ma.masked_where(straight & (name == "turns"), regimes[name].transpose(y, x).values)
            np.testing.assert_array_equal(np.ma.getmaskarray(shown), np.ma.getmaskarray(expected))
            np.testing.assert_array_equal(shown.compressed(), expected.compressed())
            edges = mesh.get_coordinates()
            told = [(x, y) for kind, *_, x, y, _ in drawn_numbers.rows(mesh.axes) if kind == "cell"]
            np.testing.assert_allclose(told, ((edges[1:, 1:] + edges[:-1, :-1]) / 2).reshape(-1, 2))
            for name_of, ends in ((x, edges[0, :, 0]), (y, edges[:, 0, 1])):
                values = regimes[name_of].values
                assert (ends[1:-1] > values[:-1]).all()
                assert (ends[1:-1] < values[1:]).all()
                np.testing.assert_allclose(ends[[0, -1]], values[[0, -1]])  # a map ends with its data


def test_a_map_shows_where_its_samples_are(regimes) -> None:
    ax = maps(map_figure.figure(regimes, show=["turns"]))[0]
    points = [line for line in ax.lines if line.get_label() == "_samples"]
    drawn = {(round(x, 6), round(y, 6)) for line in points for x, y in line.get_xydata().tolist()}
    assert drawn == {(round(E, 6), round(R, 6)) for E in regimes["E"].values for R in regimes["R"].values}


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
    ax = maps(map_figure.figure(regimes, show=["turns"]))[0]
    numbers = [text for text in ax.texts if text.get_text().isdigit()]
    assert {text.get_text() for text in numbers} == {str(n) for n in range(8)}
    for text in numbers:
        E, R = text.get_position()
        assert regimes["turns"].sel(E=E, R=R, method="nearest") == int(text.get_text())


def test_differences_that_the_errors_of_the_numbers_allow_are_no_structure(regimes) -> None:
    noise = 1e-12 * np.sin(np.arange(regimes["attached"].size)).reshape(regimes["attached"].shape)
    for error, is_level in ((2e-12, True), (1e-14, False)):
        ds = regimes.assign(attached=regimes["attached"].copy(data=noise))
        ds["attached_error"] = ds["attached"].copy(data=np.full(noise.shape, error))
        fig = map_figure.figure(ds, show=["attached"])
        assert (np.unique(meshes(fig)[0].to_rgba(noise.T)).tolist() == [1.0]) == is_level  # white
        assert ("0 within 10⁻¹² in all cases" in maps(fig)[0].get_title(loc="left")) == is_level


def test_a_cross_is_a_case_no_real_rod_takes_and_cells_without_a_solution_or_a_number_have_their_own_colours(
    regimes,
) -> None:
    shape, regimes = regimes["turns"].shape, regimes.drop_vars("beta")
    unsolved, pulled, unknown = (np.zeros(shape, dtype=bool) for _ in range(3))
    unsolved[:3, :4] = pulled[10:, 5:9] = unknown[20:, 15:] = True
    fig = map_figure.figure(with_cells(regimes, unsolved, pulled, unknown), show=["turns"])
    (ax,) = maps(fig)
    (patch,) = [patch for patch in ax.patches if isinstance(patch, PathPatch)]
    points = np.stack(np.meshgrid(regimes["E"], regimes["R"], indexing="ij"), axis=-1).reshape(-1, 2)
    points = np.exp(np.log(points) * (1 - 1e-6) + 1e-6 * np.log(points).mean(axis=0))  # off the edges of the map
    np.testing.assert_array_equal(patch.get_path().contains_points(points).reshape(shape), unsolved)
    assert to_rgb(patch.get_facecolor()) == to_rgb(colours.UNSOLVED)
    (crosses,) = [line.get_xydata() for line in ax.lines if line.get_marker() == "x"]
    expected = [
        (E, R) for i, E in enumerate(regimes["E"].values) for j, R in enumerate(regimes["R"].values) if pulled[i, j]
    ]
    np.testing.assert_allclose(sorted(crosses.tolist()), sorted(expected))
    np.testing.assert_array_equal(meshes(fig)[0].get_array().mask.reshape(shape[::-1]).T, unsolved | unknown)
    assert "solved, number unknown" in [text.get_text() for text in fig.legends[0].get_texts()]


def test_a_strip_beside_the_map_has_the_verdict_on_each_line_and_a_line_lies_where_the_law_is_decided(regimes) -> None:
    fig = map_figure.figure(regimes, show=["turns"])
    (ax,) = maps(fig)
    (strip,) = ax.child_axes
    (shown,) = strip.collections
    expected = [judge(line, "not-rising", True).verdict for line in regimes["turns"].values.T]
    drawn = shown.get_array().ravel().filled(VERDICTS.index(HOLDS))  # where the law holds nothing is drawn
    assert [VERDICTS[int(number)] for number in drawn] == expected
    assert 0 < expected.count(HOLDS) < len(expected)
    (row, _) = law_verdicts.verdicts(regimes)
    (line,) = [line for line in ax.lines if len(line.get_xdata()) == 2]
    assert set(line.get_ydata()) == {row["at"]["R"]}


def test_on_small_multiples_each_map_has_the_verdicts_of_its_own_lines_and_one_has_the_deciding_line(three) -> None:
    fig = map_figure.figure(three, show=["turns"])
    lines = 0
    for ax, i in zip(maps(fig), (0, 2, 4, 6, 8), strict=True):
        (shown,) = ax.child_axes[0].collections
        here = three["turns"].isel(F1=i).sortby("R").values.T
        expected = [judge(line, "falls", True).verdict for line in here]
        drawn = shown.get_array().ravel().filled(VERDICTS.index(HOLDS))
        assert [VERDICTS[int(number)] for number in drawn] == expected
        lines += sum(line.get_label() != "_samples" for line in ax.lines)
    assert lines == 1


def test_a_law_along_a_further_axis_has_a_map_of_verdicts_where_its_lines_differ() -> None:
    ds = in_memory.run(study(THREE + law("wraps", "F1", "falls"), 'observables = ["turns", "wraps"]'))
    fig = map_figure.figure(ds, "R", "E", at={"F1": 5.0})
    (ax,) = [ax for ax in maps(fig) if ax.get_title(loc="left") == "verdicts on wraps along F₁"]
    (shown,) = [mesh for mesh in ax.collections if hasattr(mesh, "get_coordinates")]
    here = ds["wraps"].sortby("R").transpose("E", "R", "F1").values
    expected = [[judge(line, "falls", False).verdict for line in row] for row in here]
    found = [[VERDICTS[int(number)] for number in row] for row in shown.get_array()]
    assert found == expected
    assert len(np.unique(expected)) > 1


def test_a_study_over_two_axes_is_a_map_and_over_one_it_is_lines(regimes) -> None:
    one = in_memory.run(study("[axes.E]\nvalues = [1e4, 2e4]"))
    narrow = in_memory.run(study("[axes.E]\nvalues = [1e4, 2e4]\n[axes.R]\nvalues = [0.75]"))
    assert [kinds.kind_of(ds) for ds in (regimes, one, narrow)] == ["map", "lines", "lines"]
    assert kinds.kind_of(regimes, "lines") == "lines"


def test_a_study_of_samples_over_two_axes_is_a_map_only_where_it_is_asked_for() -> None:
    axes = "[axes.E]\nvalues = [1e4, 2e4]\n[axes.R]\nvalues = [0.5, 1.0]\n"
    ds = in_memory.run(study(f"{axes}[sample]\nmethod = 'sobol'\nsize = 4\n[sample.F1]\nfrom = 1.0\nto = 9.0"))
    assert kinds.kind_of(ds) == "lines"
    fig = map_figure.figure(ds, show=["wraps"], at={"sample": 3})
    np.testing.assert_array_equal(
        meshes(fig)[0].get_array().reshape(2, 2), ds["wraps"].sel(sample=3).transpose("R", "E")
    )


def test_the_two_regimes_of_the_page_are_those_of_the_potential() -> None:
    ds = in_memory.run(load("regimes").at_stations(401))
    highest = np.degrees(ds["beta"].max("u").values)
    near, bent = highest < 30, ds["turns"].values > 0  # a rod that ends before its first bend has not turned yet
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


@pytest.mark.slow
def test_shapes_are_developed_curves_at_one_scale_each_in_its_cell(regimes, tmp_path) -> None:
    fig = map_figure.figure(regimes, show=["turns"], shapes=map_panel.Shapes(4, 3))
    canvas.save(fig, tmp_path / "shapes.png")
    panel = maps(fig)[-1]
    assert len(panel.child_axes) == 12
    inches = []
    for inset in panel.child_axes:
        box = inset.get_window_extent()
        inches.append((box.width / np.ptp(inset.get_xlim()), box.height / abs(np.ptp(inset.get_ylim()))))
        E, R = panel.transData.inverted().transform(((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2))
        one = regimes.sel(E=E, R=R, method="nearest")
        assert np.log([E / float(one["E"]), R / float(one["R"])]) == pytest.approx(0, abs=0.02)  # cells are 0.08 wide
        drawn = max((line.get_xdata() for line in inset.lines), key=len)
        np.testing.assert_array_equal(drawn, one["z"])
    np.testing.assert_allclose(inches, inches[0][0], rtol=1e-6)  # pixels per length, to the right and up
