"""A rod whose load is changed until it snaps, and the stable rods of a file of branches in three dimensions."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

from solver import Case, Cylinder, Ends, InputError, Rod, Solution, equilibria
from solver.orbits.potential import dimensional_slope
from studies import load
from tests.workbench.page_faults import faults
from tests.workbench.pictures import draws
from workbench.branches import branch_dataset, snap
from workbench.commands import study_scene
from workbench.figures import bifurcation, colours
from workbench.figures.print_heights import TALLEST
from workbench.run import writing
from workbench.scene import branch_rods, film, opengl, scene_kinds
from workbench.scene.settings import Settings
from workbench.stored.stored_study import StoredStudy

ROD, CYLINDER = Rod(E=325.95, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75)


def swept(low: float, high: float, count: int, name: str = "FZ", case: Case | None = None) -> StoredStudy:
    case = case or Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.5, FZ=-0.5))
    return StoredStudy(branch_dataset.sweep(load("fig6"), case, name, np.linspace(low, high, count), lambda *_: None))


@pytest.fixture(scope="module")
def stored() -> StoredStudy:
    """The stable branch from above ends in a fold at -0.967."""
    return swept(-1.4, 0.2, 5)


@pytest.fixture(scope="module")
def way(stored) -> list[snap.Moment]:
    return snap.way_of(stored)


def falling(way: list[snap.Moment]) -> list[snap.Moment]:
    """The shapes during the first snap: the load stays, also at the rod at rest that is then followed on."""
    loads = [shape.load for shape in way]
    return [shape for shape in way if loads.count(shape.load) > 1][:-1]


def energy(case: Case, beta: np.ndarray) -> float:
    """The integral of beta'^2 / 2 less that of H from 0 to beta, by the trapezoidal rule on a fine grid."""
    A, h = float(case.rod.bending_stiffness), float(case.rod.L) / (beta.size - 1)
    angle = np.linspace(beta.min() - 0.1, beta.max() + 0.1, 4001)
    l, m, p = (float(getattr(case.given, name)) / A for name in ("MZ", "M3", "FZ"))
    H = dimensional_slope(l, m, p, float(case.rho), angle)
    G = np.append(0.0, np.cumsum((H[1:] + H[:-1]) / 2 * np.diff(angle)))
    return float(np.sum(np.diff(beta) ** 2) / (2 * h) - h * np.sum(np.interp(beta[1:-1], angle, G)))


def test_a_rod_that_snaps_falls_in_energy_until_it_rests_in_a_listed_stable_equilibrium(stored, way) -> None:
    fall = falling(way)
    first = way.index(fall[0])
    assert way[first - 1].load == pytest.approx(stored["fold"].values[np.abs(stored["fold"].values + 0.967).argmin()])
    case = snap.case_at(stored, fall[0].load)
    energies = [energy(case, shape.beta) for shape in (way[first - 1], *fall)]
    assert (np.diff(energies) < 1e-9 * abs(energies[0])).all()
    listed = [one for one in equilibria(case, stations=snap.STATIONS) if one.index == 0]
    off = [np.abs(one.solution.beta - fall[-1].beta).max() for one in listed]
    assert min(off) < 1e-3  # of the grid of 401 stations
    np.testing.assert_allclose([shape.beta[[0, -1]] for shape in way], 0.5, atol=1e-9)  # the tolerance of the solves


def test_the_load_goes_one_way_and_each_shape_at_rest_is_listed_as_stable(way, stored) -> None:
    assert (np.diff([shape.load for shape in way]) <= 0).all()
    assert [way[0].load, way[-1].load] == pytest.approx([0.2, -1.4])
    for shape in (way[0], way[-1], next(shape for shape in way if shape.load < 0)):
        listed = equilibria(snap.case_at(stored, shape.load), stations=snap.STATIONS)
        nearest = min(listed, key=lambda one: np.abs(one.solution.beta - shape.beta).max())
        assert nearest.index == 0
        np.testing.assert_allclose(nearest.solution.beta, shape.beta, atol=1e-6)


def test_over_an_end_angle_the_rod_has_that_angle_also_while_it_snaps() -> None:
    way = snap.way_of(swept(-1.0, 1.5, 5, "betaL"))
    assert falling(way)
    ends = np.array([shape.beta[-1] for shape in way])
    np.testing.assert_allclose(ends, [shape.load for shape in way], atol=1e-9)  # the tolerance of the solves


def test_the_frames_of_a_snap_are_in_the_order_of_the_way_and_the_rod_moves_evenly(stored, way) -> None:
    ds = snap.evenly(snap.as_dataset(stored, way), 40)
    assert ds.sizes["FZ"] == 40
    rods, shown = StoredStudy(ds), film.Film("FZ", {}, "height", "plain", branches=stored)
    assert [where["FZ"] for where in film.cases_of(rods, shown)] == list(range(40))
    s = np.linspace(0, 5.0, snap.STATIONS)
    heights = [np.trapezoid(np.cos(shape.beta), s) for shape in (way[0], way[-1])]
    np.testing.assert_allclose(ds["height"][[0, -1]], heights, atol=1e-3)  # the trapezoidal rule at 401 stations
    place = np.stack([ds["rho"] * np.cos(ds["alpha"]), ds["rho"] * np.sin(ds["alpha"]), ds["z"]], axis=-1)
    far = np.linalg.norm(np.diff(place, axis=0), axis=-1).max(axis=-1)
    assert far.max() < 3 * far.mean()


def test_where_no_stable_branch_ends_in_a_fold_nothing_snaps() -> None:
    with pytest.raises(InputError, match="no rod snaps"):
        snap.way_of(swept(0.0, 0.2, 2))
    with pytest.raises(InputError, match="under dead loads"):
        snap.case_at(swept(4.0, 4.5, 2, "height"), 4.0)


def test_each_stable_shape_of_the_file_is_found_again(stored) -> None:
    for k in bifurcation.stable_shapes(stored):
        rod = snap.rod_of_shape(stored, k, stored.sizes["u"])
        np.testing.assert_allclose(rod.z, stored["shape_z"].values[k], atol=1e-7)
        np.testing.assert_allclose(rod.alpha, stored["shape_alpha"].values[k], atol=1e-7)


def test_a_stable_shape_of_a_slender_wire_is_found_again() -> None:
    """A spline through its stored places gives a poor slope at the start, which named another equilibrium."""
    wire = Case(Rod(E=1e5, nu=0.3, a=0.25, L=120.0), Cylinder(1.0, "inside"), Ends("-10deg", "-10deg"))
    stored = swept(-9.0, -8.9, 2, case=wire)
    for k in bifurcation.stable_shapes(stored):
        for stations in (stored.sizes["u"], 2 * stored.sizes["u"] - 1):
            rod = snap.rod_of_shape(stored, k, stations)
            np.testing.assert_allclose(rod.z[:: stations // 160], stored["shape_z"].values[k], atol=1e-6)


@draws
def test_a_dot_moves_in_the_diagram_of_the_branches_and_the_rod_beside_it(stored, way) -> None:
    ds = snap.evenly(snap.as_dataset(stored, way), 3).assign_attrs({scene_kinds.NOTE: study_scene.MOTION})
    shown = film.Film("FZ", {}, "height", "plain", Settings(1.0, 50), branches=stored)
    frames = list(film.frames(StoredStudy(ds), shown))
    assert len({frame.shape for frame in frames}) == 1
    blue = [np.argwhere((frame[..., 2] > 100) & (frame[..., 0] < 80) & (frame[..., 1] < 120)) for frame in frames]
    middles = np.array([places.mean(axis=0) for places in blue])
    assert (np.diff(middles[:, 1]) < 0).all()  # the load falls
    assert (np.diff(middles[:, 0]) > 0).all()  # and the far end too


@draws
def test_every_stable_rod_stands_below_the_diagram_with_the_number_of_its_point(stored) -> None:
    stable = bifurcation.stable_shapes(stored)
    rods = StoredStudy(snap.rods_of_shapes(stored, stable, 201)[0])
    fig, picture = branch_rods.figure(stored, stable, rods, Settings(dpi=200, pixel_error=2.0))
    assert (picture.pixels[0] == 255).all()  # no rim is cut at the top
    assert fig.get_figwidth() <= 183 / 25.4  # as every scene in print
    names = [bifurcation.names_of_shapes(stored)[k] for k in stable]
    diagram, words = fig.axes
    assert sorted(text.get_text() for text in diagram.texts) == sorted(names)
    assert [text.get_text() for text in words.texts if text.get_text() in names] == names
    far = {name: -1e3 * stored[name] for name in ("curve_height", "fold_height")}  # numbers of many digits on its left
    fig, _ = branch_rods.figure(StoredStudy(stored.ds.assign(far)), stable, rods, Settings(dpi=200, pixel_error=2.0))
    assert fig.axes[0].get_tightbbox().x0 > 0


@draws
@pytest.mark.parametrize("count", [1, 4, 9])
def test_the_words_of_rods_in_rows_stand_on_no_rod_and_a_journal_prints_the_picture(stored, count: int) -> None:
    stable = bifurcation.stable_shapes(stored)
    each = [k % len(stable) for k in range(count)]
    shapes, rods = [stable[k] for k in each], snap.rods_of_shapes(stored, stable, 201)[0].isel(equilibrium=each)
    fig, picture = branch_rods.figure(stored, shapes, StoredStudy(rods), Settings(dpi=100, pixel_error=2.0))
    assert fig.get_figheight() <= TALLEST
    assert 2 * float(rods["R"].max()) * picture.arrangement.scale > 0.25  # inches: no rod is too small to be seen
    assert faults(fig) == []
    (image,), names = fig.images, bifurcation.names_of_shapes(stored)
    pixels = np.asarray(image.get_array())
    texts = [text for text in fig.axes[1].texts if text.get_text() in names or text.get_text().endswith(" N")]
    assert len(texts) == 2 * count
    for text in texts:
        box = text.get_window_extent()
        rows = len(pixels) + round(image.oy) - np.array([np.ceil(box.y1), np.floor(box.y0)]).astype(int)
        columns = np.array([np.floor(box.x0), np.ceil(box.x1)]).astype(int) - round(image.ox)
        assert (pixels[slice(*np.maximum(rows, 0)), slice(*np.maximum(columns, 0))] == 255).all(), text.get_text()


@draws
def test_a_dark_scene_of_branches_has_a_dark_sheet_and_light_words(stored, tmp_path, monkeypatch, call) -> None:
    monkeypatch.chdir(tmp_path)
    writing.write(stored.ds, tmp_path / "branches.h5")
    options = "--theme dark --dpi 50 --pixel-error 2 --out dark.png"
    assert call("scene", "branches.h5", *options.split())[0] == 0
    seen, back = imread(tmp_path / "dark.png")[..., :3], to_rgb(colours.THEMES["dark"][0])
    assert (np.abs(seen - back).max(axis=-1) < 0.02).mean() > 0.5
    np.testing.assert_allclose(seen[[0, 0, -1, -1], [0, -1, 0, -1]], [back] * 4, atol=1 / 255)
    assert seen[: seen.shape[0] // 10].max() > 0.85  # the title


@draws
def test_a_rod_that_is_not_solved_again_is_named_and_the_others_are_drawn(stored, tmp_path, monkeypatch, call) -> None:
    lost, *others = bifurcation.stable_shapes(stored)
    file, solve_again = tmp_path / "branches.h5", snap.rod_of_shape
    writing.write(stored.ds, file)

    def fail(of: StoredStudy, k: int, stations: int) -> Solution:
        rod = solve_again(of, k, stations)
        if k in others:
            return rod
        unsolved = replace(rod.trajectory, solved=np.array([False]), outcome=np.array(["failed: no digit"]))
        return replace(rod, trajectory=unsolved)

    monkeypatch.setattr(snap, "rod_of_shape", fail)
    status, _, wrong = call("scene", str(file), "--dpi", "50", "--pixel-error", "2")
    value = float(stored["shape_FZ"].values[lost])
    name = bifurcation.names_of_shapes(stored)[lost]
    assert (status, f"rod {name}, at FZ = {value:.6g}, is not drawn: failed: no digit" in wrong) == (0, True), wrong
    assert (tmp_path / "branches_scene.png").exists()
    others.clear()
    status, _, wrong = call("scene", str(file), "--out", str(tmp_path / "none.png"))
    assert (status, "no stable rod of this file is solved again: failed: no digit" in wrong) == (2, True), wrong


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("--out x.png --frames 3", "are for films"),
        ("--frames 3", "are for films"),
        ("--out x.mp4 --fps 1000", "--fps must be between 0.1 and 60, got 1000"),
        ("--out x.mp4 --stored", "a scene of branches takes no --stored"),
        (
            "--at FZ=-1",
            "no --at: store the rods at one value of FZ, or another diagram, with workbench equilibria",
        ),
        ("--out frame_{:03d}.png", "a scene of branches takes no {} in --out"),
        ("--out x.html", "choose a name that ends in .png, .mp4, .webp, .gif"),
    ],
)
def test_no_option_is_ignored_by_a_scene_of_branches(options, said, stored, tmp_path, monkeypatch, call) -> None:
    monkeypatch.chdir(tmp_path)
    writing.write(stored.ds, tmp_path / "branches.h5")
    status, _, wrong = call("scene", "branches.h5", *options.split())
    assert (status, said in wrong) == (2, True), wrong
    assert [path.name for path in tmp_path.iterdir()] == ["branches.h5"]


@pytest.mark.parametrize("name", ["x.png", "x.gif"])
def test_without_opengl_a_scene_of_branches_says_so_before_it_solves(name, stored, tmp_path, monkeypatch, call) -> None:
    solved = []
    monkeypatch.setattr(opengl, "probe", lambda: (False, "OpenGL does not work here"))
    monkeypatch.setattr(snap, "equilibria", lambda *_, **__: solved.append("solved"))
    writing.write(stored.ds, tmp_path / "branches.h5")
    status, _, wrong = call("scene", str(tmp_path / "branches.h5"), "--out", str(tmp_path / name))
    assert (status, "OpenGL does not work here" in wrong, solved) == (1, True, []), wrong
    assert [path.name for path in tmp_path.iterdir()] == ["branches.h5"]
