"""Rods that may leave the cylinder in stored files, pictures and exports: drawn where they are, or refused in words."""

import json
import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from PIL import Image

from solver import Case, Cylinder, Ends, InputError, Rod, solve
from studies import load
from studies.language.loader import loads
from tests.workbench import small
from tests.workbench.command import exit_status
from tests.workbench.page_faults import words
from tests.workbench.pictures import draws
from workbench import accessor  # noqa: F401
from workbench.commands import study_scene
from workbench.export.file_format import ExportOptions
from workbench.export.stored_rod import export
from workbench.figures import canvas, figure_kinds, phase_portrait, trends, unrolled
from workbench.figures.drawn_rods import DrawnRod
from workbench.geometry.tube_tolerance import push_along
from workbench.run import in_memory, in_order, writing
from workbench.scene import opengl, signs
from workbench.scene.body import read
from workbench.scene.scene_kinds import LET_GO, NOTE, OFF_WALL, RELEASED, SIDES_OF_RELEASE, kind_of
from workbench.scene.settings import Settings
from workbench.stored import reading, solved_again
from workbench.stored.stored_study import StoredStudy
from workbench.web.live.page_model import study_of
from workbench.web.live.presets import own_preset
from workbench.web.turntable import turntable_page
from workbench.words import free_rod_words
from workbench.words.free_rod_words import amount, amounts

if opengl.probe()[0]:  # without the libraries of OpenGL it cannot be imported
    from workbench.scene import composition, layout

pytest.importorskip("unopy", reason="the extra contact is not installed")

STUDY = """
title = "A rod that is let go"
let_go = true
stations = 201
observables = ["gap_max", "contact_share"]
units = { length = "cm", force = "N" }
base = { E = 1.07e4, nu = 0.25, a = 0.25, L = 20.0, R = 0.75, beta0 = 0.5, betaL = 0.8, FZ = -8.66, MZ = 1.3, M3 = 6.1 }
"""
PUSHED = STUDY.replace("let_go = true", "").replace("R = 0.75", 'R = 0.75, contact = "unilateral"')


@pytest.fixture(scope="module")
def stored() -> xr.Dataset:
    return in_memory.run(loads(STUDY))


@pytest.fixture(scope="module")
def finer() -> Any:
    """The rod of the study at four times as many places."""
    case = Case(Rod(1.07e4, 0.25, 0.25, 20.0), Cylinder(0.75), Ends(0.5, 0.8, FZ=-8.66, MZ=1.3, M3=6.1))
    return solve(case, stations=801).let_go()


def test_a_cable_of_tension_and_lay_may_leave_its_drum(capsys) -> None:
    cable = "--length-unit mm --E 2e5 --nu 0.3 --a 6 --L 1300 --R 200 --tension 5000 --lay 80deg --contact unilateral"
    assert exit_status("solve", *cable.split()) == 0
    assert "found from the bilateral shape" in capsys.readouterr().out


def test_of_many_point_forces_those_no_larger_than_their_errors_are_counted_alone(monkeypatch) -> None:
    words = [("8.1", "3.01"), ("12", "0.07 ± 0.073"), ("91.9", "3.01")]
    sol = SimpleNamespace(point_forces=[(8.1, 3.01), (12.0, 0.07), (91.9, 3.01)])
    monkeypatch.setattr(free_rod_words, "MOST", 2)
    monkeypatch.setattr(free_rod_words, "point_forces", lambda _: words[: len(sol.point_forces)])
    for errors, said in (
        ([0.1, 0.073, 0.1], "3.01 kN at 8.1, 3.01 kN at 91.9 m; 1 more no larger than its error"),
        ([4.0, 0.073, 4.0], "3 no larger than their errors"),
        ([0.1, 0.01, 0.1], "3.01 kN at 8.1, 0.07 ± 0.073 kN at 12, 3.01 kN at 91.9 m"),
    ):
        monkeypatch.setattr(free_rod_words, "_errors_of_forces", lambda _, errors=errors: errors)
        found = free_rod_words.forces_in_words(sol, {"length": "m", "force": "kN"})
        assert found == [f"point forces of the wall: {said}"]
    sol.point_forces = []
    monkeypatch.setattr(free_rod_words, "_errors_of_forces", lambda _: [])
    assert free_rod_words.forces_in_words(sol, {"length": "m", "force": "kN"}) == []


def test_loads_that_hold_a_rod_off_the_wall_have_an_error_in_json_and_in_files(capsys) -> None:
    rod = "--E 1.07e4 --nu 0.25 --a 0.25 --L 20 --R 0.75 --beta0 0.5 --betaL 0.8 --FZ=-8.66 --MZ 1.3 --M3 6.1"
    assert exit_status("solve", *rod.split(), "--let-go", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["errors"].keys() >= {"FZ", "MZ", "M3"}
    assert found["observables"].keys().isdisjoint(found["loads"])
    in_file = in_memory.run(loads(STUDY.replace('"gap_max",', '"gap_max", "FZ", "MZ",')))
    for name in ("FZ", "MZ"):
        assert float(in_file[name]) == pytest.approx(found["loads"][name], rel=1e-9)
        assert float(in_file[f"{name}_error"]) == pytest.approx(found["errors"][name], rel=1e-6)


def test_a_study_lets_its_rods_go_and_stores_where_they_are(stored: xr.Dataset, finer: Any) -> None:
    assert stored.attrs["contact"] == "unilateral"
    np.testing.assert_allclose(stored.rod.position.values, finer.position[::4], atol=1e-6)
    assert float(stored["gap_max"]) == pytest.approx(finer.gap.max(), abs=1e-3)


def test_between_stations_a_rod_is_drawn_where_it_is(stored: xr.Dataset, finer: Any) -> None:
    line = StoredStudy(stored).centreline
    place, tangent, out, across = line.frame(finer.s)
    assert np.linalg.norm(place - finer.position, axis=1).max() <= line.error + finer.error * line.L
    assert line.error < 1e-3
    np.testing.assert_allclose(tangent, finer.tangent, atol=0.02)
    np.testing.assert_allclose(np.cross(out, tangent), across, atol=1e-12)
    np.testing.assert_allclose(out[finer.gap == 0], -finer.normal[finer.gap == 0], atol=0.02)


def test_cut_stations_lie_on_the_curve(stored: xr.Dataset) -> None:
    line = StoredStudy(stored).centreline
    cut = line.cut(3)
    np.testing.assert_allclose(cut.place, line.frame(cut.s)[0], atol=1e-12)
    np.testing.assert_allclose(cut.place[::3], line.place, atol=1e-12)


def test_the_edge_of_a_contact_asks_for_no_more_stations_and_a_rod_without_push_for_none(stored: xr.Dataset) -> None:
    line = StoredStudy(stored).centreline
    assert push_along(line).stations() == line.s.size
    off = StoredStudy(stored.assign(contact=0 * stored["contact"])).centreline
    assert push_along(off).stations() == off.s.size
    assert push_along(off).parts == 1


def test_a_table_of_a_rod_has_its_places_in_space(stored: xr.Dataset, tmp_path: Path) -> None:
    export(StoredStudy(stored), tmp_path / "rod.csv")
    head, *_ = (tmp_path / "rod.csv").read_text(encoding="utf-8").splitlines()
    table = np.loadtxt(tmp_path / "rod.csv", delimiter=",", skiprows=1)
    columns = dict(zip((name.partition(" ")[0] for name in head.split(",")), table.T, strict=True))
    np.testing.assert_allclose(np.hypot(columns["x"], columns["y"]), columns["radius"], rtol=1e-12)
    assert columns["radius"].max() > 1.2


def test_pictures_of_rods_on_the_wall_are_refused_for_others(stored: xr.Dataset) -> None:
    for draw in (phase_portrait.figure, turntable_page.html):
        with pytest.raises(InputError, match="needs rods that lie on the cylinder"):
            draw(StoredStudy(stored))


def test_a_cable_that_leaves_its_drum_is_stored_read_and_exported(tmp_path: Path) -> None:
    """In a plane across the axis a rod goes round the wall as far as it is long, but for the error of its places."""
    cable = """
        title = "A cable"
        observables = ["contact_count"]
        units = { length = "mm", force = "N" }
        [base]
        EI = 2e6
        GJ = 1.6e6
        a = 6.0
        L = 1450.0
        R = 200.0
        contact = "unilateral"
        beta0 = "90deg"
        betaL = "90deg"
        height = 0.0
        azimuth = "200deg"
        radiusL = 1000.0
        M2L = 0.0
        """
    ds = in_memory.run(loads(cable))
    writing.write(ds, tmp_path / "cable.h5")
    whole = reading.read(tmp_path / "cable.h5")
    assert float(whole["radius"][-1]) == pytest.approx(1000.0)
    assert int(whole["contact_count"]) == 1
    written = export(StoredStudy(whole), tmp_path / "cable.stl")
    assert written.facts["triangles"] > 100


@pytest.mark.parametrize("name", ["rod.stl", "rod.glb", "rod.step"])
def test_between_the_stations_of_a_rod_an_export_asks_for_no_more_than_the_error_of_the_rod(
    stored: xr.Dataset, name: str, tmp_path: Path
) -> None:
    if name == "rod.step":
        pytest.importorskip("OCP", reason="Open Cascade is not installed", exc_type=ImportError)
    alone = StoredStudy(stored.assign_attrs(study=""))
    line, own_error = alone.centreline, float(stored["error"]) * 20.0
    facts = export(alone, tmp_path / name, ExportOptions(overlap=True)).facts
    assert line.error < own_error == facts["solution_error"]
    assert line.error < facts["tolerance"] < own_error
    if name != "rod.step":
        assert export(alone, tmp_path / f"small_{name}", ExportOptions(triangles=20_000)).facts["triangles"] <= 20_000


@pytest.mark.parametrize("let_go", [True, False])
def test_the_frames_of_a_film_are_at_the_pace_of_the_stored_rods_and_kept_when_it_is_interrupted(
    let_go: bool, tmp_path: Path, monkeypatch
) -> None:
    """Rods that are not let go continue from the frame before."""
    axis = small.axis("FZ", [-8.66, -8.0, -5.0])
    text = STUDY if let_go else PUSHED
    ds = in_memory.run(loads(text.replace("FZ = -8.66, ", "").replace("201", "21\ntol = 1e-2") + axis))
    told, searched, search = [], [], in_order.solve_one
    monkeypatch.setattr(in_order, "solve_one", lambda *given: searched.append(given) or search(*given))

    def film(stop: int) -> StoredStudy:
        def step(*said) -> None:
            told.append(said)
            if said[1] == stop:
                raise KeyboardInterrupt

        run = partial(in_order.run_in_order, folder=tmp_path / "film.parts", step=step)
        cases = study_scene.film_cases(StoredStudy(ds), "FZ", {}, kind_of("contact"), "gap_max", 480, 5, run)
        assert cases is not None
        return cases

    with pytest.raises(KeyboardInterrupt, match=r"3 of 5 rods are kept in .*run the same command again to continue"):
        film(3)
    cases = film(5)
    assert [said[1:] for said in told] == [(i, 5) for i in (0, 1, 2, 3, 3, 4)]
    assert len(searched) == (5 if let_go else 2)
    assert (cases["solved"].shape, cases["beta"].shape) == ((5,), (5, 21))
    np.testing.assert_allclose(cases["FZ"].values[[0, -1]], [-8.66, -5.0])
    assert (np.diff(cases["FZ"].values) > 0).all()
    again = StoredStudy(cases.ds.isel(FZ=3)).solution
    np.testing.assert_allclose(again.z, cases["z"].values[3], atol=0.02)


def test_rods_on_the_wall_are_kept_for_a_film_as_they_are_solved(tmp_path: Path) -> None:
    study = small.study(small.axis("E", np.linspace(1e4, 2e4, 20).tolist()))
    told = []

    def run(stop: int) -> xr.Dataset:
        def step(*said) -> None:
            told.append(said[1:])
            if said[1] == stop:
                raise KeyboardInterrupt

        return in_order.run_in_order(study, tmp_path / "film.parts", step)

    with pytest.raises(KeyboardInterrupt, match=r"8 of 20 rods are kept in .*run the same command again to continue"):
        run(8)
    ds, whole = run(20), in_memory.run(study)
    assert told == [(0, 20), (8, 20), (8, 20), (16, 20)]
    np.testing.assert_allclose(ds["beta"], whole["beta"], atol=1e-9)


def test_a_change_of_the_energy_is_told_in_as_many_digits_as_show_it() -> None:
    each = {
        191.3717: "from 191.401 to 191.372 N mm",
        180.0: "falls by 5.96 %, from 191.4 to 180 N mm",
        200.0: "to 200 N mm; what is least is its sum with that of its weight and of kept loads",
    }
    for after, told in each.items():
        said = free_rod_words.release_sentence({"before": 191.4012, "after": after}, {"length": "mm", "force": "N"})
        assert said.endswith(told)


@pytest.mark.parametrize("alone", [False, True])
def test_errors_that_are_seen_beside_their_values_are_drawn_and_told(stored: xr.Dataset, alone: bool) -> None:
    ds = in_memory.run(loads(PUSHED.replace("FZ = -8.66, ", "") + small.axis("FZ", [-8.66, -7.0, -6.0])))
    ds = ds.assign_attrs(study=stored.attrs["study"]) if alone else ds
    ds["contact_share"].values[:] = [0.05, 0.3, 0.4]
    for error, said in ((1e-4, ""), (0.1, "Pale: the estimated error of share of the length on the wall, up to 0.1.")):
        ds["contact_share_error"].values[:] = [error, error / 2, 0.0]
        line = StoredStudy(ds).trend("contact_share", "FZ")
        assert line.alone == alone
        ax = trends.trend(line, Figure(figsize=(5, 3)).subplots())
        assert trends.say_errors(line) == [said] * bool(said)
        drawn = [part for part in ax.collections if part.get_label() == trends.WITHIN]
        assert [len(part.get_paths()) for part in drawn] == [3] * bool(said)  # one a case: it may jump to the next one
        for part in drawn:
            places = np.concatenate([path.vertices for path in part.get_paths()])
            first = places[places[:, 0] == ds["FZ"].values[0], 1]
            assert (first.min(), first.max()) == pytest.approx((0.0, 0.15))


def test_a_hinge_that_the_wall_holds_is_told_with_the_moment_of_the_rod() -> None:
    """Drawn, the rod is pressed on at both ends; compressed, it tilts out of the wall at its hinges."""
    told = []
    for FZ, MZ, M3 in ((20.0, 8.0, 0.0), (-8.66, 1.3, 6.1)):
        ends = Ends(0.5, 0.8, FZ=FZ, MZ=MZ, M3=M3, M20=0.0, M2L=0.0)
        sol = solve(Case(Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0), Cylinder(R=0.75, contact="unilateral"), ends))
        told.append([text for text in free_rod_words.sentences(sol, {"length": "cm", "force": "N"}) if "hinge" in text])
    assert ["at the start along it: M2 of the rod is 6.71 N cm" in text for text in told[0]] == [True, False]
    assert told[1] == []


def test_a_place_that_its_error_hides_is_told_with_the_error() -> None:
    """The cable of a drum whose far end is far off: its short contact is known to its own length."""
    cylinder = Cylinder(200.0, contact="unilateral")
    held = Ends("90deg", "90deg", height=0.0, azimuth="200deg", radiusL=1168.2, M2L=0.0)
    sol = solve(Case(Rod(EI=2e6, GJ=1.6e6, a=6.0, L=1616.0), cylinder, held))
    contact, forces = free_rod_words.sentences(sol, {"length": "mm", "force": "N"})
    ((low, high),) = sol.contacts
    errors = [free_rod_words.error_beside(sol, place, 0) * 206.0 for place in (low, high)]
    assert high - low < min(errors)
    number = r"([\d.]+) ± ([\d.]+)"
    told = re.search(
        rf"lies on less than ([\d.]+) % of its length on the wall, at s = {number} to {number} mm", contact
    )
    assert told is not None
    share, *places = map(float, told.groups())
    assert places == pytest.approx([low, errors[0], high, errors[1]], abs=min(errors) / 4)
    assert 100 * (high - low) / 1616.0 < share < 12
    each = rf"less than [\d.]+ N at {number}"
    assert re.fullmatch(f"point forces of the wall: {each}, {each} mm", forces)


def test_an_amount_whose_error_is_larger_than_itself_has_a_bound_alone() -> None:
    said = {(0.3, 1.3): "less than 1.6", (0.0, 0.2): "less than 0.2", (58.2, 42.1): "58 ± 43", (81.23, 0.4): "81"}
    assert {numbers: amount(*numbers) for numbers in said} == said
    assert (amount(0.0, 0.0), amount(81.23, 0.0), amount(2.0, np.inf)) == ("0", "81.23", "2")


def test_amounts_side_by_side_have_their_errors_all_or_none() -> None:
    assert amounts([3.742, 5.071, 0.2], [0.436, 0.134, 0.5]) == ["3.74 ± 0.44", "5.07 ± 0.14", "less than 0.7"]
    assert amounts([37.42, 5.071], [0.436, 0.134]) == ["37", "5.1"]


@pytest.mark.parametrize("text", [STUDY, PUSHED])
def test_the_live_page_begins_with_a_rod_that_may_leave_the_cylinder(text: str, tmp_path: Path) -> None:
    (tmp_path / "rod.toml").write_text(text, encoding="utf-8")
    own = own_preset(tmp_path / "rod.toml", {}, {})
    assert own is not None
    assert study_of(own.state).leaves


def said_by(stored: xr.Dataset, kind: str) -> str:
    """All words of a figure of a study, and of its caption."""
    drawn = figure_kinds.figure(StoredStudy(stored), kind)
    return " ".join(" ".join([*(text.get_text() for text in words(drawn)), *canvas.caption(drawn)]).split())


def test_an_unrolled_view_says_that_a_rod_off_the_wall_is_seen_along_the_radius(stored: xr.Dataset) -> None:
    radial = "Where a rod is off the wall, it is seen along the radius, at its azimuth times ρ."
    held = in_memory.run(loads(STUDY.replace("let_go = true", "").replace('"gap_max", "contact_share"', '"bends"')))
    for kind in ("curves", "rod"):
        assert radial in said_by(stored, kind)
        assert radial not in said_by(held, kind)


def test_ticks_across_an_unrolled_rod_are_where_its_contact_begins_and_ends(stored: xr.Dataset, finer: Any) -> None:
    drawn = figure_kinds.figure(StoredStudy(stored), "curves")
    (ax,) = [ax for ax in drawn.axes if ax.get_label() == unrolled.VIEWS]
    (dot,) = [line for line in ax.lines if line.get_gid() == "s = 0"]
    drawn.canvas.draw()  # only now both directions have one scale
    ticks = [ax.transData.transform(line.get_xydata()) for line in ax.lines if line.get_gid() == "contact"]
    edges = np.array(finer.contacts[0])
    rows = finer.z, float(finer.case.rho) * (finer.alpha - finer.alpha[0])
    before, at, after = (
        dot.get_transform().transform(np.transpose([np.interp(edges + off, finer.s, row) for row in rows]))
        for off in (-0.1, 0.0, 0.1)  # cm: a station
    )
    assert len(ticks) == 2
    for tick, place, way in zip(ticks, at, after - before, strict=True):
        assert np.linalg.norm(tick.mean(axis=0) - place) < np.linalg.norm(way) / 2
        across = tick[1] - tick[0]
        assert abs(across @ way) < 0.05 * np.linalg.norm(across) * np.linalg.norm(way)
    assert unrolled.EDGES in said_by(stored, "curves")


def test_an_unrolled_rod_is_white_where_it_is_off_the_wall_alone(stored: xr.Dataset) -> None:
    drawn = figure_kinds.figure(StoredStudy(stored), "curves")
    (ax,) = [ax for ax in drawn.axes if ax.get_label() == unrolled.VIEWS]
    lines = [line for line in ax.lines if str(line.get_gid()).endswith("off the wall")]
    assert len(lines) == 2  # next to both ends
    order = np.argsort(stored["z"].values)
    z, gap = (StoredStudy(stored).along(name).values[order] for name in ("z", "gap"))
    on_wall = z[gap == 0]
    for line in lines:
        x = np.asarray(line.get_xdata(), dtype=float)
        assert not np.any((on_wall > x.min()) & (on_wall < x.max()))
        assert np.interp(x, z, gap).max() > 0
    assert "off the wall" in {text.get_text() for text in words(drawn)}


def test_a_rod_in_one_colour_says_where_it_is_on_the_wall_and_has_a_dot_where_it_touches_it_at_one_place() -> None:
    radius = np.full(9, 0.9)
    radius[[0, 1, 2, 5, 8]] = 1.0  # a stretch at its start, a place in the middle, its held end
    s = np.arange(9.0)
    case = cast("StoredStudy", None)
    rod = DrawnRod("rod", "", {"s": s, "z": s, "alpha": 0 * s, "radius": radius}, 1.0, 0.1, "", case)
    (first, second, dot) = unrolled.parts_off_wall(rod)
    assert [part[0].tolist() for part in (first, second, dot)] == [[3.0, 4.0], [6.0, 7.0], [5.0]]
    assert dot[2]["label"] == "touches the wall at one place"


def test_stretches_that_cross_one_over_the_other_off_the_wall_have_no_ring() -> None:
    """A figure of eight that rises from the wall along the rod."""
    s = np.linspace(0.0, 1.0, 401)
    alpha, z = np.sin(2 * np.pi * s), 0.5 * np.sin(4 * np.pi * s)
    assert unrolled.crossings(6 * s, 1.0, alpha, z, 0.05, 1.0)
    assert unrolled.crossings(6 * s, 1.0, alpha, z, 0.05, 1.0 + s) == []


@draws
def test_a_rod_is_drawn_held_on_and_let_go_with_its_gap_and_the_forces_at_the_edges(
    stored: xr.Dataset,
) -> None:
    pair = study_scene.release_of(StoredStudy(stored), {})(101)
    free = np.asarray(pair["radius"].values[1])
    np.testing.assert_allclose(pair["radius"].values[0], float(pair["rho"][0]))
    rods = [read(pair, {RELEASED: side}, kind_of(LET_GO)) for side in (0, 1)]
    assert rods[0].widest_gap is None
    assert not rods[0].pushes
    assert not rods[0].contact_edges
    wall, rod = rods[1].widest_gap
    assert np.hypot(*wall[:2]) == pytest.approx(rods[1].R)
    gap = np.linalg.norm(rod - wall)
    assert gap == pytest.approx((free - float(pair["rho"][0])).max(), rel=1e-2)
    page = layout.compose(pair, None, LET_GO, [RELEASED], settings=Settings(2.0, 60))
    assert [view.cell.caption for row in page.scene.rows for view in row] == [*SIDES_OF_RELEASE]
    (said,) = [text.get_text() for text in page.ax.texts if text.get_text().endswith(" cm")][-1:]
    assert float(said.split()[0]) == pytest.approx(gap, rel=0.01)
    assert len([text for text in page.ax.texts if getattr(text, "arrow_patch", None)]) == 1 + len(rods[1].pushes)
    assert len(rods[1].pushes) == 2
    assert not [line for line in page.ax.lines if line.get_gid() == signs.EDGE]  # the arrows mark both edges
    assert len(replace(rods[1], point_forces=()).contact_edges) == 2
    again = read(StoredStudy(stored).solve(201, ["alpha", "beta", "z", "radius", "contact"]), {}, kind_of("contact"))
    for (at, away, force, _), (_, _, same, _) in zip(rods[1].pushes, again.pushes, strict=True):
        assert force == pytest.approx(same, rel=1e-6)
        assert force > 0
        assert at[:2] @ away[:2] == pytest.approx(rods[1].R + 2 * rods[1].a, rel=1e-3)


@draws
def test_a_rod_let_go_is_seen_from_the_side_where_most_of_it_and_of_the_held_rod_is() -> None:
    pair = study_scene.release_of(StoredStudy(in_memory.run(load("fig6"))), {})(401)
    scene = layout.compose(pair, None, LET_GO, [RELEASED], settings=Settings(2.0, 60)).scene
    for view in (view for row in scene.rows for view in row):
        assert np.mean(view.places(view.bodies[0])[:, :2] @ scene.camera.toward[:2] > 0) > 0.5


@draws
def test_the_size_of_a_gap_stands_behind_the_wall_where_it_covers_no_rod(stored: xr.Dataset) -> None:
    pair = study_scene.release_of(StoredStudy(stored), {})(101)
    page = layout.compose(pair, None, LET_GO, [RELEASED], settings=Settings(2.0, 60))
    (size,) = [text for text in page.ax.texts if text.get_text().endswith(" cm")][-1:]
    lines = [text for text in page.ax.texts if getattr(text, "arrow_patch", None) and not text.get_text()]
    gap = min(lines, key=lambda line: np.linalg.norm(np.subtract(line.xyann, size.get_position())))
    wall, rod = np.array(gap.xyann), np.array(gap.xy)
    assert (size.get_position() - wall) @ (wall - rod) > 0


def test_the_colour_of_a_push_begins_at_the_arrow_of_the_point_force(stored: xr.Dataset) -> None:
    pair = study_scene.release_of(StoredStudy(stored), {})(101)
    rod = read(pair, {RELEASED: 1}, kind_of(LET_GO))
    assert len(rod.point_forces) == 2
    for (at, *_), sense in zip(rod.point_forces, (1, -1), strict=True):
        off, on = rod.line.contact(at + sense * 1e-9 * rod.line.L * np.array([-1, 1]))
        assert off == 0 < on
        assert on == pytest.approx(rod.line.contact(np.array([at + sense * np.diff(rod.line.s)[0]]))[0], rel=0.1)


@draws
def test_the_end_view_shows_a_rod_at_true_scale_as_one_looks_along_the_axis_from_its_start(stored: xr.Dataset) -> None:
    taken = layout.compose(StoredStudy(stored), kind="plain", settings=Settings(dpi=100, camera="end"))
    np.testing.assert_allclose(taken.scene.camera.page, [[0, 1, 0], [1, 0, 0]], atol=1e-12)  # alpha = 0 is up
    place = stored.rod.position.values
    per_unit, bar = taken.arrangement.scale * 100, taken.scene.along
    assert bar == 1
    seen = (taken.pixels.min(axis=-1) < 250).nonzero()
    for pixels, across in zip(seen, place.T[:2], strict=True):  # up the page, to its right
        wide = max(across.max() + 0.25, 0.75) - min(across.min() - 0.25, -0.75)
        assert np.ptp(pixels) + 1 == pytest.approx(wide * per_unit, abs=4)  # one pixel is cut in two at each edge
    assert "seen along the axis from s = 0, α = 0 up" in taken.notes


@draws
@pytest.mark.parametrize("azimuth", (0, 60, 180, 270))
def test_arrows_and_gaps_are_drawn_as_far_as_the_cylinder_does_not_hide_them(stored: xr.Dataset, azimuth: int) -> None:
    pair = study_scene.release_of(StoredStudy(stored), {})(101)
    page = layout.compose(pair, {RELEASED: 100}, settings=Settings(4.0, 50, camera=f"{azimuth},10"))
    (view,), camera = page.scene.views, page.scene.camera
    seen, cut = 0, False
    for places, *_ in composition._lines_of_contact(page.scene, view):
        rays = places[:, None] + np.linspace(1e-6, 5.0, 2001)[:, None] * camera.toward  # to the eye
        (low, high), inside = view.cylinder, np.hypot(*np.moveaxis(rays, -1, 0)[:2]) < view.bodies[0].R - 1e-4
        hidden = (inside & (rays[..., 2] > low) & (rays[..., 2] < high)).any(axis=1)
        assert (hidden != view.covers(places, camera)).mean() <= 2 / len(places)
        seen, cut = seen + (not hidden.all()), cut or bool(hidden.any())
    drawn = [text for text in page.ax.texts if getattr(text, "arrow_patch", None)]
    assert len(drawn) == seen
    assert all(mark.get_annotation_clip() is False for mark in drawn)  # also where its end is beyond the panel
    assert any(composition.CUT in text for _, text in page.legend) == cut


@draws
@pytest.mark.parametrize("look", ("0,0", "60,30", "end"))
def test_the_arrow_of_a_point_force_is_as_long_on_the_page_as_it_is_large_and_says_its_size(
    stored: xr.Dataset, look: str
) -> None:
    pair = study_scene.release_of(StoredStudy(stored), {})(101)
    page = layout.compose(pair, {RELEASED: 100}, settings=Settings(4.0, 50, camera=look))
    (view,), across = page.scene.views, page.scene.camera.page
    (rod,) = view.bodies
    lines = [*composition._lines_of_contact(page.scene, view)]
    arrows = [(places @ across.T, words) for places, sign, words in lines if sign == signs.FORCE]
    forces = [force for *_, force, _ in rod.pushes]
    assert np.ptp(forces) > 0.1 * max(forces)
    lengths = np.array([np.linalg.norm(places[-1] - places[0]) for places, _ in arrows])
    for (places, _), (at, away, *_) in zip(arrows, rod.pushes, strict=True):
        axis, push = (across @ view.turn @ vector for vector in (at - rod.a * away, away))
        assert np.linalg.norm(places[0] - axis) == pytest.approx(rod.a)
        assert (places[-1] - axis) @ push == pytest.approx(np.linalg.norm(places[-1] - axis) * np.linalg.norm(push))
    np.testing.assert_allclose(lengths / lengths.max(), np.divide(forces, max(forces)), rtol=1e-9)
    pairs = [(force, error) for *_, force, error in rod.pushes]
    assert [words for _, words in arrows] == [f"{words} N" for words in amounts(*zip(*pairs, strict=True))]
    assert {words for _, words in arrows} & {text.get_text() for text in page.ax.texts}


@pytest.fixture(scope="module")
def cable() -> StoredStudy:
    """A cable on a drum, whose far end is held off it."""
    held = {"EI": 2e6, "GJ": 1.6e6, "a": 6.0, "L": 1616.0, "R": 200.0, "contact": "unilateral", "beta0": "90deg",
            "betaL": "90deg", "height": 0.0, "azimuth": "200deg", "radiusL": 1200.0, "M2L": 0.0}  # fmt: skip
    stored = StoredStudy(in_memory.run(loads(small.text(held, "", "mm N", observables=["gap_max"]))))
    return study_scene.solver_of(stored, kind_of("contact"), {}, [])(201)


def test_off_the_wall_has_in_the_legend_the_colour_of_the_rod_also_where_no_rod_touches_the_wall(
    cable: StoredStudy,
) -> None:
    away = StoredStudy(cable.ds.assign(contact=0 * cable["contact"]))
    scene = layout.compose(away, kind="contact", settings=Settings(2.0, 50)).scene
    legend = {words: colour for colour, words in composition.words_of(scene)[0]}
    assert [legend["off the wall"]] == [body.paint.colour for body in scene.bodies]


@draws
@pytest.mark.parametrize("look", (None, "120,20", "200,20"))
def test_the_arrow_of_a_force_is_drawn_whole_where_it_acts_and_its_words_are_on_the_page(
    cable: StoredStudy, look: str | None
) -> None:
    page = layout.compose(cable, kind="contact", settings=Settings(4.0, 100, camera=look))
    page.fig.canvas.draw()
    (view,), camera = page.scene.views, page.scene.camera
    ((places, _, words),) = [each for each in composition._lines_of_contact(page.scene, view) if each[1] == signs.FORCE]
    assert not view.covers(places, camera).any()
    (text,) = [text for text in page.ax.texts if text.get_text() == words]
    assert page.fig.bbox.containsx(text.get_window_extent().x0)
    assert page.fig.bbox.containsx(text.get_window_extent().x1)
    start, tip = (page.ax.transData.transform(place) for place in places_of_arrow(page, words))
    scale = page.arrangement.scale * 100
    assert np.linalg.norm(tip - start) == pytest.approx(scale * np.linalg.norm(places[-1] - places[0]), rel=1e-6)
    assert places_in_pixels(page, places[[0, -1]]) == pytest.approx(np.array([start, tip]), abs=1.0)  # a pixel


def test_the_signs_of_the_legend_are_drawn_as_the_marks_of_the_picture() -> None:
    gap, force = (signs.legend_sign(sign, "").get_marker().vertices for sign in (signs.GAP, signs.FORCE))
    for end in (gap.min(), gap.max()):  # a bar across each end
        assert sorted(gap[gap[:, 1] == end][:, 0]) == [-0.3, 0.0, 0.3]
    assert force[force[:, 0].argmax()].tolist() == [1, 0]  # the head is at the end


def test_the_sign_of_a_hidden_stretch_is_no_swatch_and_the_size_of_a_long_gap_stands_within_it() -> None:
    hidden, off = (signs.legend_sign(sign, "") for sign in (signs.OUTLINE, OFF_WALL))
    assert type(hidden) is not type(off)  # they are told apart in grey, too
    fig = Figure(figsize=(4, 4))
    ax = fig.add_axes((0, 0, 1, 1))
    ax.set(xlim=(0, 4), ylim=(4, 0))
    for places, within in (([[2.0, 1.0], [1.5, 3.0]], True), ([[2.0, 1.0], [2.0, 1.2]], False)):
        signs.draw_mark(ax, np.array(places), signs.GAP, "994 mm")
        x, y = ax.texts[-1].get_position()
        assert ((x, y) == (1.75, 2.0)) == within
        assert within or y < 1.0  # behind the wall


def places_of_arrow(page: Any, words: str) -> tuple[Any, Any]:
    """Start and tip of the mark with these words, in inches of the panel."""
    texts = page.ax.texts
    k = next(k for k, text in enumerate(texts) if text.get_text() == words)
    return texts[k - 1].xyann, texts[k - 1].xy


def places_in_pixels(page: Any, places: np.ndarray) -> np.ndarray:
    """Where places of the one view are in the picture, by its pixels, (n, 2) from the lower left of the page."""
    (image,) = page.fig.images
    ((view, middle),) = composition._middles(page.scene, page.arrangement)
    x, y = composition._in_picture(page.scene, page.arrangement, view, middle, places).T * page.fig.dpi
    return np.column_stack([image.ox + x, image.oy + image.get_size()[0] - y])


@draws
def test_marks_of_a_dark_scene_are_light_and_have_a_dark_edge_where_they_stand_on_the_cylinder(cable) -> None:
    look = Settings(4.0, 60, theme="dark")
    page, (back, ink, *_) = layout.compose(cable, kind="contact", settings=look), look.look.values()
    arrows = [text.arrow_patch for text in page.ax.texts if getattr(text, "arrow_patch", None)]
    words = [text for text in page.ax.texts if text.get_path_effects()]
    assert len(arrows) == len(words) == 2
    assert {to_hex(arrow.get_edgecolor()) for arrow in arrows} == {to_hex(text.get_color()) for text in words} == {ink}
    assert {effect.background for each in (*arrows, *words) for effect in each.get_path_effects()} == {back}


def test_a_film_of_letting_go_begins_on_the_cylinder_ends_at_rest_and_says_how_it_moves(stored: xr.Dataset) -> None:
    motion = study_scene.release_of(StoredStudy(stored), {}, 6)(101)
    pair = study_scene.release_of(StoredStudy(stored), {})(101)
    for frame, side in ((0, 0), (-1, 1)):
        for name in ("radius", "alpha", "z", "contact"):
            np.testing.assert_allclose(motion[name].values[frame], pair[name].values[side], atol=1e-9)
    assert motion[RELEASED].values.tolist() == [0, 20, 40, 60, 80, 100]
    assert (np.diff(motion[study_scene.ENERGY[0]].values) < 0).all()
    assert motion.attrs[NOTE] == study_scene.MOTION
    for k in range(1, 6):
        assert (motion["radius"].values[k] >= float(motion["rho"][k])).all()


@draws
def test_a_film_of_letting_go_is_made_by_one_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rod.toml").write_text(STUDY, encoding="utf-8")
    look = ["--kind", "let-go", "--frames", "3", "--dpi", "50", "--pixel-error", "5"]
    assert exit_status("scene", "rod.toml", "-o", "rod.gif", *look) == 0
    with Image.open("rod.gif") as gif:
        assert gif.n_frames == 3
    assert exit_status("scene", "rod.toml", "-o", "other.gif", *look, "--show", "gap_max") == 2


def test_a_scene_of_letting_go_shows_one_case_and_takes_no_axis(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rods.toml").write_text(STUDY.replace("E = 1.07e4, ", "") + "[axes.E]\nvalues = [1e4, 1.2e4]\n")
    assert exit_status("scene", "rods.toml", "--kind", "let-go", "--axis", "E", "-o", "rods.png") == 2


def test_no_line_joins_rods_that_were_let_go_each_by_itself() -> None:
    ds = in_memory.run(loads(STUDY.replace("E = 1.07e4, ", "") + "[axes.E]\nvalues = [1e4, 1.2e4, 1.4e4]\n"))
    drawn = figure_kinds.figure(StoredStudy(ds), "lines", show=["gap_max"])
    (ax,) = [ax for ax in drawn.axes if "wall" in ax.get_ylabel()]
    lines = [np.isfinite(np.asarray(line.get_ydata(), dtype=float)) for line in ax.lines if line.get_xdata().size > 1]
    assert lines
    assert not any((known[1:] & known[:-1]).any() for known in lines)
    assert trends.ALONE in canvas.caption(drawn)


def test_pictures_of_one_file_solve_its_rods_once_and_read_other_stations_from_the_same_shape(
    stored: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    own, calls = StoredStudy(stored), []
    solve = solved_again._solve
    monkeypatch.setattr(solved_again, "_solve", lambda *given: calls.append(given) or solve(*given))
    for kind in ("curves", "ridge"):
        figure_kinds.figure(own, kind)
    finer = own.solve(401, ["radius", "contact"])
    assert len(calls) == 1
    again = StoredStudy(stored).solve(401, ["radius", "contact"])
    assert len(calls) == 2
    for name in ("radius", "contact"):
        np.testing.assert_array_equal(finer[name], again[name])


CABLE = "--E 30GPa --nu 0.3 --a 1cm --L 200cm --R 10cm --tension 100 --lay 30deg --let-go"


def test_the_numbers_of_a_rod_that_hardly_leaves_are_in_their_ranges_and_a_file_holds_them(tmp_path: Path) -> None:
    """What was left to the limit of meshes made a push and a gap negative, and the file held an unsolved case."""
    assert exit_status("solve", *CABLE.split(), "--out", tmp_path / "cable.h5") == 0
    ds = reading.read(tmp_path / "cable.h5")
    assert ds["solved"].all()
    assert min(float(ds[name]) for name in ("gap_max", "push_mean", "point_force_max")) >= 0


def test_a_solved_case_that_no_file_can_hold_is_refused_and_not_stored(tmp_path, capsys, monkeypatch) -> None:
    run = in_memory.run
    monkeypatch.setattr(in_memory, "run", lambda study: run(study).assign(solved=False).assign(outcome="failed: why"))
    assert exit_status("solve", "--table1", "--out", tmp_path / "rod.h5") == 2
    assert "rod.h5: failed: why" in capsys.readouterr().err
    assert not (tmp_path / "rod.h5").exists()


CENTRED = """
title = "A pipe with centred ends in a hole"

[units]
length = "ft"
force = "klbf"

[base]
E = "30000 ksi"
nu = 0.3
a = "2.5 in"
inner_radius = "2.138 in"
L = 300.0
R = "4.25 in"
side = "inside"
weight = "19.5 lbf/ft"
inclination = "90deg"
contact = "unilateral"
beta0 = 0.0
betaL = 0.0
FZ = -45.0
radius0 = 0.0
radiusL = 0.0
"""


def test_a_pipe_with_centred_ends_has_a_state_numbers_along_it_and_a_gap_on_the_axis(capsys, tmp_path: Path) -> None:
    file, stored = tmp_path / "centred.toml", tmp_path / "centred.h5"
    file.write_text(CENTRED, encoding="utf-8")
    assert exit_status("solve", file, "--out", stored) == 0
    said = capsys.readouterr().out
    assert "state: sinusoidal all along" in said
    assert "the straight rod" not in said  # its ends are off the wall
    assert "expected of a long pipe at 45 klbf" in said
    force = next(line for line in said.splitlines() if line.startswith("axial force FZ"))
    assert [float(word) for word in force.split()[4:7]] == pytest.approx([-45.0] * 3, rel=1e-3)
    assert "dogleg" in said
    body = read(StoredStudy(reading.read(stored)), {}, kind_of("contact"))
    assert body.widest_gap is not None
    wall, rod = body.widest_gap
    assert np.hypot(*(rod - wall)[:2]) == pytest.approx((4.25 - 2.5) / 12)
    capsys.readouterr()
    assert exit_status("plot", stored, "--kind", "well", "--out", tmp_path / "w.png") == 0
    drawn = capsys.readouterr().out
    for row, name in (("push of the wall", "push of the wall"), ("dogleg", "dogleg")):
        largest = next(line for line in said.splitlines() if line.startswith(row)).split()[-3]
        assert float(drawn.split(f"Largest {name}: ")[1].split()[0]) == pytest.approx(float(largest), rel=1e-3)
    assert "Largest gap to the wall: 0.1458 ft" in drawn
    assert "Point forces of the wall: " in drawn
