"""The tube about the rod, and the pictures made of it."""

import re
import resource

import numpy as np
import pytest
import xarray as xr

from solver.errors import InputError
from studies import load
from studies.loader import loads
from workbench import gl, picking, runner, sheet, style, tube

from . import small
from .pictures import pixels, share_of_hue, share_of_ink

HEAD = 'title = "a rod"\nstations = %d\n[units]\nlength = "cm"\nforce = "N"\n'
BASE = """[base]
E = 1.07e4
nu = 0.25
a = 0.25
L = %s
R = 0.75
side = "%s"
beta = 0.5
dbeta = 0.1
F3 = %s
dgamma = 0.5
"""

draws = pytest.mark.skipif(not gl.probe()[0], reason=gl.probe()[1])


def dataset(
    side: str = "outside", axes: str = "", stations: int = 201, L: float = 20.0, outputs: str = ""
) -> xr.Dataset:
    base = BASE % (L, side, 10.0 if side == "outside" else -10.0)
    varied = {line.removeprefix("[axes.").removesuffix("]") for line in axes.splitlines()}
    base = "\n".join(line for line in base.splitlines() if line.partition(" ")[0] not in varied)
    text = f"{outputs}{HEAD % stations}{base}\n{axes}"
    return runner.run(loads(text, default_name="rod"))


@pytest.fixture(scope="module")
def fig6() -> xr.Dataset:
    return runner.run(load("fig6"))


def curve(ds: xr.Dataset, **where: int) -> tube.Curve:
    found = tube.read(ds, where)
    assert found is not None
    return found


@pytest.mark.parametrize("side", ["outside", "inside"])
def test_the_tube_touches_the_surface_and_has_the_rods_radius(side: str) -> None:
    rod = curve(dataset(side))
    points, *_ = tube.mesh(rod)
    away = np.hypot(points[:, 0], points[:, 1])
    rho = 0.75 + (0.25 if side == "outside" else -0.25)
    # the ring's own points at the innermost and outermost angle: exact to rounding
    assert away.min() == pytest.approx(rho - 0.25, abs=1e-12)
    assert away.max() == pytest.approx(rho + 0.25, abs=1e-12)


def test_the_tube_is_closed_and_its_faces_look_outward(fig6) -> None:
    points, normals, triangles, _ = tube.mesh(curve(fig6), sides=48)
    corners = points[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # inside a bend tighter than the rod is thick the tube folds; elsewhere faces and normals agree
    assert (np.einsum("ij,ij->i", face, normals[triangles[:, 0]]) > 0).mean() > 0.99
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert volume == pytest.approx(np.pi * 0.25**2 * 20, rel=5e-3)  # 48 sides: sin(x)/x is off by 3e-3
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 1).sum() == 4 * 48  # only the rims of the two flat ends, which have points of their own


def test_between_coarse_stations_the_curve_follows_the_fine_ones(fig6) -> None:
    coarse = curve(fig6.isel(u=slice(None, None, 10)))
    # measured 8e-4 with the stored tangents at a quarter of a centimetre, 4e-3 without
    np.testing.assert_allclose(np.interp(fig6["s"], coarse.s, coarse.alpha), fig6["alpha"], atol=1.5e-3)
    np.testing.assert_allclose(np.interp(fig6["s"], coarse.s, coarse.z), fig6["z"], atol=1.5e-3)
    steps = np.linalg.norm(np.diff(tube.frames.position(coarse.rho, coarse.alpha, coarse.z), axis=0), axis=1)
    assert steps.sum() == pytest.approx(20.0, rel=1e-3)  # the rod is not stretched; chords are a little short


def test_a_study_that_varies_the_angle_is_drawn_with_its_stored_tangents() -> None:
    ds = runner.run(load("fig7_3_start_angle"))
    first, last = curve(ds, beta=0), curve(ds, beta=8)
    assert np.rad2deg([first.beta[0], last.beta[0]]) == pytest.approx([15, 60])


def test_the_second_colour_covers_what_is_not_attached(fig6) -> None:
    rod = curve(fig6)
    *_, held = tube.mesh(rod)
    assert rod.lifts
    # rings are a hundredth of the rod apart or less
    assert held.mean() == pytest.approx(float(fig6["attached"]), abs=0.01)


def test_inside_the_push_is_toward_the_axis() -> None:
    ds = dataset("inside")
    rod = curve(ds)
    assert (rod.push >= 0).mean() == pytest.approx(float((ds["contact"] <= 0).mean()), abs=0.02)


def test_stations_that_miss_a_bend_are_refused() -> None:
    with pytest.raises(InputError, match="11 stations are too few to draw this rod of length 20"):
        tube.read(dataset(stations=11), {})


def test_where_the_stations_are_too_few_as_many_as_are_said_to_be_needed_are_enough() -> None:
    for L, stations in ((20.0, 11), (400.0, 201)):
        with pytest.raises(InputError, match="workbench run --stations") as refusal:
            curve(dataset(L=L, stations=stations))
        said = re.search(r"store (\d+) with", str(refusal.value))
        assert said is not None
        assert curve(dataset(L=L, stations=int(said[1]))).L == L


def test_whether_a_rod_meets_itself_is_known_whatever_the_study_asks_for() -> None:
    for wanted in ('observables = ["overlaps"]\n', "", "observables = []\n"):
        assert curve(runner.run(loads(wanted + small.HEAD))).overlaps  # the rod of Table 1
        assert not curve(dataset(outputs=wanted)).overlaps


def test_what_is_not_stored_is_named() -> None:
    with pytest.raises(InputError, match="stores no z"):
        tube.read(dataset().drop_vars("z"), {})


def test_a_very_long_rod_is_drawn_in_part_and_in_bounded_memory() -> None:
    rod = curve(dataset(stations=20_001, L=2000.0))
    assert not rod.whole
    assert rod.s.size <= tube.MOST_RINGS + 1
    assert np.ptp(rod.z) <= 1.05 * tube.TALLEST * 2 * (rod.rho + rod.a)
    assert len(tube.mesh(rod)[0]) * 24 < 100e6


def test_an_unsolved_case_has_no_curve(fig6) -> None:
    ds = fig6.assign(outcome=((), "the march went astray"))
    assert tube.read(ds, {}) is None


def test_a_row_runs_along_its_axis_with_the_others_at_table_1() -> None:
    ds = runner.run(load("fig7_5_forces"))
    cases = picking.line(ds, "F1")
    assert [case["F1"] for case in cases] == list(range(9))
    assert float(ds["F3"][cases[0]["F3"]]) == pytest.approx(10.0)
    assert [case["F3"] for case in picking.line(ds, "F3", {"F1": 10.0})] == list(range(9))
    assert {case["F1"] for case in picking.line(ds, "F3", {"F1": 10.0})} == {8}


def test_an_axis_or_value_that_is_not_there_is_answered_with_what_is() -> None:
    ds = dataset(axes="[axes.E]\nvalues = [1e4, 2e4]\n")
    with pytest.raises(InputError, match=r"'R'.*E"):
        picking.case(ds, {"R": 1.0})
    with pytest.raises(InputError, match="its values are 10000, 20000"):
        picking.case(ds, {"E": 3e4})
    assert picking.case(ds, {"E": 1.9e4}) == {"E": 1}


def test_at_most_so_many_are_chosen_and_both_ends_among_them() -> None:
    cases = [{"E": i} for i in range(200)]
    chosen = [case["E"] for case in picking.spread(cases, 9)]
    assert len(chosen) == 9
    assert (chosen[0], chosen[-1]) == (0, 199)
    assert np.ptp(np.diff(chosen)) <= 1


def test_a_scale_bar_is_a_round_length_that_fits() -> None:
    targets = np.geomspace(1e-3, 1e6, 200)
    bars = np.array([sheet.round_length(target) for target in targets])
    assert ((bars <= targets * (1 + 1e-9)) & (bars > targets / 2.6)).all()
    assert {f"{bar:.0e}"[0] for bar in bars} == {"1", "2", "5"}


@draws
def test_fig_6_is_large_and_shows_rod_cylinder_and_lift_off(fig6, tmp_path) -> None:
    from workbench import scenes

    picture = pixels(scenes.render(fig6, tmp_path / "fig6.png"))
    assert picture.shape == (1200, 1600, 3)
    assert share_of_ink(picture) > 0.25
    assert share_of_hue(picture, style.PUSHED) > 0.02
    assert share_of_hue(picture, style.LIFTED) > 0.05
    edge = np.concatenate([picture[:8].ravel(), picture[-8:].ravel(), picture[:, :8].ravel(), picture[:, -8:].ravel()])
    assert (edge > 0.98).all()  # nothing is cut off


@draws
def test_a_row_has_one_scale_and_one_camera() -> None:
    from workbench import stage
    from workbench.sheet import Cell

    ds = dataset(axes="[axes.E]\nvalues = [1e4, 2e4]\n")
    rods = [curve(ds, E=0), curve(ds, E=1), curve(ds, E=0), curve(ds, E=1)]
    ends = stage.ends_of(rods)
    view = stage.view_of(rods, ends, (160, 300), lying=False)
    picture = stage.photograph([[stage.Shot(rod, Cell("")) for rod in rods]], ends, view).astype(int)
    first, second, third, fourth = np.split(picture, 4, axis=1)
    # the same rod in another cell, even of another part of the picture: the ambient shading is random in places
    assert (np.abs(first - third).max(axis=-1) > 24).mean() < 0.002
    assert (np.abs(second - fourth).max(axis=-1) > 24).mean() < 0.002
    assert (np.abs(first - second).max(axis=-1) > 24).mean() > 0.02  # and another rod looks different


@draws
def test_the_cylinder_is_as_wide_as_the_scale_bar_says() -> None:
    from workbench import stage
    from workbench.sheet import Cell

    rod = curve(dataset())
    ends = stage.ends_of([rod])
    view = stage.view_of([rod], ends, (300, 600), lying=False)
    picture = stage.photograph([[stage.Shot(rod, Cell(""))]], ends, view)
    top = picture[:40].min(axis=-1) < 250  # only the cylinder reaches up there
    assert top.sum(axis=1).max() == pytest.approx(2 * 0.75 * view.per_unit, abs=2)  # a pixel on either side


@draws
def test_a_case_without_a_shape_leaves_a_labelled_empty_cell(tmp_path) -> None:
    from workbench import scenes

    ds = dataset(axes="[axes.E]\nvalues = [1e4, 2e4, 3e4]\n")
    ds["outcome"] = ("E", ["solved", "no solution", "solved"])
    ds["alpha"][1] = np.nan
    picture = pixels(scenes.render_row(ds, tmp_path / "row.png", "E"))
    assert share_of_hue(picture, style.PUSHED) + share_of_hue(picture, style.LIFTED) > 0.01
    with pytest.raises(InputError, match="nothing to draw at E = 20000 N/cm²: no solution"):
        scenes.render(ds, tmp_path / "one.png", {"E": 2e4})
    ds["outcome"] = ("E", ["no solution"] * 3)
    assert share_of_ink(pixels(scenes.render_row(ds, tmp_path / "none.png", "E"))) > 0.001


@draws
def test_inside_the_rod_is_seen_through_the_near_wall(tmp_path) -> None:
    from workbench import scenes

    picture = pixels(scenes.render(dataset("inside"), tmp_path / "inside.png"))
    assert share_of_hue(picture, style.PUSHED, 0.12) > 0.02


@draws
def test_only_pictures_can_be_asked_for(fig6, tmp_path) -> None:
    from workbench import scenes

    with pytest.raises(InputError, match=r"scene\.txt.*\.png"):
        scenes.render(fig6, tmp_path / "scene.txt")


@draws
def test_a_wound_rod_does_not_blow_the_memory(tmp_path) -> None:
    from workbench import scenes

    scenes.render(dataset(stations=20_001, L=2000.0), tmp_path / "long.png")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < 1.5e6  # kilobytes
