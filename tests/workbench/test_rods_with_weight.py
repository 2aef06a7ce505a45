"""Stored rods with weight: their curve between stations, exports, and scenes in which the weight points down."""

import csv
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from solver import Case, Cylinder, Ends, InputError, Rod, Solution, Start, observe, solve
from studies import loads
from tests.workbench import small, stored_figures, study_kinds
from tests.workbench.command import exit_status
from workbench.export import csv_table, stored_rod
from workbench.figures import along_rods, canvas, drawn_numbers, well_tracks
from workbench.figures.trends import trend
from workbench.run import in_memory, writing
from workbench.scene import body as body_of
from workbench.scene import layout, long_rod, scene_kinds, views
from workbench.scene.settings import Settings
from workbench.stored.stored_study import StoredStudy
from workbench.words import caution_words, pipe_words

PIPE = {"EI": 1228.0, "GJ": 945.0, "a": 0.0635, "L": 60.0, "weight": 0.242, "R": 0.10795}
HELD = {**PIPE, "side": "inside", "beta0": 0.0, "betaL": 0.0, "FZ": -220.0}
ANGLES = small.axis("inclination", ["60deg", "90deg"])


def pipes(stations: int) -> xr.Dataset:
    return in_memory.run(loads(small.text(HELD, ANGLES, "m kN", stations=stations)))


@pytest.fixture(scope="module")
def ds() -> xr.Dataset:
    return pipes(121)


def test_a_picture_has_no_branch_of_a_case_that_is_not_solved(ds) -> None:
    branch, solved = ds["branch"].copy(data=[1, -1]), ds["solved"].copy(data=[True, False])
    lost = ds.assign(branch=branch, solved=solved)
    assert "branch" not in StoredStudy(lost).observables
    assert "branch" in StoredStudy(lost.assign(solved=solved | True)).observables
    ax = Figure().add_subplot()
    trend(StoredStudy(lost).trend("branch", "inclination"), ax)
    assert np.isnan(ax.lines[0].get_ydata()).tolist() == [False, True]  # the case without a solution


def test_what_a_rod_with_weight_and_friction_is_given_is_stored() -> None:
    rubbed = HELD | {"inclination": "90deg", "friction": 0.2, "sliding": "backward", "alpha": 0.1}
    ds = in_memory.run(loads(small.text(rubbed, small.axis("FZ", [-100, -90]), "m kN", stations=3)))
    assert (ds["inclination"], ds["friction"], ds["alpha0"]) == (np.pi / 2, 0.2, 0.1)
    assert ds.attrs["sliding"] == "backward"
    assert bool((ds["alpha"][:, 0] == 0.1).all())


LYING: Mapping[str, int] = {"inclination": 1}


def test_the_curve_of_a_stored_rod_with_weight_is_that_of_more_stations(ds: xr.Dataset) -> None:
    line, fine = StoredStudy(ds).select(LYING).centreline, StoredStudy(pipes(961)).select(LYING).centreline
    place, exact = line.frame(fine.s)[0], fine.frame(fine.s)[0]
    assert np.abs(place - exact).max() < 1e-5 * line.rho
    assert line.error < 1e-5 * line.rho
    assert np.abs(line.push(fine.s) - fine.push(fine.s)).max() < 1e-3 * 0.242


def test_the_weight_points_down_in_a_scene_and_the_low_side_is_below(ds: xr.Dataset) -> None:
    for where, up in (({"inclination": 0}, [-np.sqrt(3) / 2, 0.0, 0.5]), (LYING, [-1.0, 0.0, 0.0])):
        down = views.gravity(StoredStudy(ds), where)
        assert down == pytest.approx(-np.array(up), abs=1e-12)
        seen = views.upright(views.front_camera([], 0.0, True, down))
        right, above = seen.page @ np.array(up)
        assert right == pytest.approx(0, abs=1e-12)
        assert above > 0.5
        assert (seen.page @ np.array([0.0, 0.0, 1.0]))[0] > 0.5  # s goes to the right
    assert views.gravity(StoredStudy(ds), {}) is None  # one picture, two inclinations
    rows, (seen,) = layout._cells(
        StoredStudy(ds), scene_kinds.kind_of("grid"), ["inclination"], [[LYING, LYING]], Settings()
    )
    assert [view.turned for view in rows[0]] == [0.0, 0.0]  # in a row of lying pipes each low side is below
    assert seen.page @ seen.down == pytest.approx([0.0, -np.sqrt(3) / 2], abs=1e-12)
    made = layout.compose(StoredStudy(ds), {"inclination": np.pi / 2}, settings=Settings(span=(20.0, 24.0)))
    assert made.scene.down == pytest.approx([0.0, made.scene.down[1]], abs=1e-12)
    assert canvas.caption(made.fig)[-1] == caution_words.model_leaves_out({"weight": 0.242})


def test_a_long_rod_with_weight_is_compressed_along_the_axis_no_more_than_its_bends_allow(ds: xr.Dataset) -> None:
    body = body_of.read(StoredStudy(ds), LYING, scene_kinds.kind_of("contact"))
    factor = long_rod.squeeze_of([body])
    assert 0 < factor < 1
    squeezed = replace(body, squeeze=factor)
    np.testing.assert_allclose(squeezed.dense, body.dense * [1, 1, factor], atol=1e-12)
    turn = np.diff(np.diff(squeezed.dense, axis=0), axis=0)
    step = np.diff(squeezed.dense, axis=0)[:-1]
    bend = np.linalg.norm(np.cross(step, turn), axis=-1) / np.linalg.norm(step, axis=-1) ** 3
    assert bend.max() * body.a < 1.05 * long_rod.TIGHTEST  # the tube is drawn without folds
    made = layout.compose(StoredStudy(ds), {"inclination": np.pi / 2})
    assert f"axis compressed 1 : {1 / factor:.3g}" in made.notes
    assert made.scene.along == pytest.approx(factor)  # the scale bar is of lengths along the axis
    rows, _ = layout._cells(StoredStudy(ds), scene_kinds.kind_of("grid"), ["inclination"], [[LYING, LYING]], Settings())
    assert [view.bodies[0].squeeze for view in rows[0]] == [pytest.approx(factor)] * 2
    assert all(view.bodies[0].whole for view in rows[0])


def test_of_long_pipes_one_view_shows_the_lower_part_compressed_and_lying() -> None:
    steel = {"E": 2.06e8, "nu": 0.3, "inner_radius": 0.0543, "L": 600.0, "weight": 0.241, "inclination": "120deg"}
    pipe = {name: value for name, value in HELD.items() if name not in ("EI", "GJ")} | steel | {"azimuth": 0.0}
    ds = in_memory.run(loads(small.text(pipe, small.axis("FZ", [-210.0, -150.0]), "m kN", stations=201)))
    cases = [{"FZ": 0}, {"FZ": 1}]
    rows, (camera_,) = layout._cells(StoredStudy(ds), scene_kinds.kind_of("grid"), ["FZ"], [cases], Settings())
    assert camera_.page @ [0, 0, 1] == pytest.approx([1, 0], abs=1e-12)
    for k, body in enumerate(view.bodies[0] for view in rows[0]):
        assert 0 < body.span[0] < body.span[1] == 600.0  # s = L is the lower end
        assert body.squeeze < 1
        for low in np.linspace(300.0, 400.0, 11):  # the straight one too
            drawn = replace(body, span=(low, 600.0)).rings(0.01, 1.0).s
            assert drawn[[0, -1]] == pytest.approx([low, 600.0], abs=1e-9)
        ghost = layout._thin(body, k)
        far = body.R - ghost.a - (body.line.rho + ghost.lift)
        assert far == pytest.approx(k * ghost.a, abs=1e-12)  # the first touches the wall, none floats far from it
    assert "only s = " in long_rod.notes_on(rows[0][0].bodies, "m")[1]


@pytest.mark.parametrize("sliding", ["forward", "rotating"])
def test_a_table_of_a_rod_with_friction_holds_the_solution_s_own_arrays(sliding, tmp_path) -> None:
    wall = Cylinder(R=0.3, side="inside", inclination=1.2, friction=0.3, sliding=sliding)
    sol = solve(Case(Rod(EI=1.0, GJ=0.8, a=0.05, L=6.0, weight=0.3), wall, Start(0.2, 0.3, F3=-4.0, M3=0.1)))
    stored_rod.export(StoredStudy(sol.to_dataset(length="m", force="N")), tmp_path / "rod.csv")
    with (tmp_path / "rod.csv").open(encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    names = [cell.partition(" ")[0] for cell in head]
    assert {*csv_table.COMPUTED} <= {*names}
    for name, column in zip(names, np.array(rows, dtype=float).T, strict=True):
        if name not in "xyz":
            np.testing.assert_allclose(column, getattr(sol, name), atol=1e-12, err_msg=name)


def test_pipes_and_their_states_show_what_is_stored(ds: xr.Dataset) -> None:
    (axis,) = ds["outcome"].dims
    pictures = {
        "pipes": lambda: along_rods.pipe(StoredStudy(ds)),
        "one pipe": lambda: along_rods.pipe(StoredStudy(ds), at={axis: float(ds[axis][0])}),
        "states": lambda: along_rods.states(StoredStudy(ds)),
        "rods without weight": lambda: along_rods.pipe(StoredStudy(small.six())),
    }
    stored_figures.check("pictures_pipes", pictures)


def test_the_azimuth_of_a_helix_is_drawn_within_one_turn() -> None:
    fig = along_rods.pipe(StoredStudy(small.study_dataset("pipe_lubinski")), at={"FZ": -300.0})
    lines = [drawn for drawn in fig.axes[0].collections if isinstance(drawn, LineCollection)]
    assert len(lines) > 10  # one for each turn
    heights = [points[:, 1] for line in lines for points in line.get_segments()]
    assert max(np.abs(of).max() for of in heights) <= 180
    assert max(np.ptp(of) for of in heights) < 90  # no line goes back over the hole


def marks_of(ds: xr.Dataset, at: Mapping[str, float], name: str) -> np.ndarray:
    """The points (n, 2) of a curve of the picture of a well, by its name: a number, and the depth or another one."""
    fig = well_tracks.figure(StoredStudy(ds), at=at, yield_stress=5e5)
    rows = (row for ax in fig.axes for row in drawn_numbers.rows(ax))
    return np.array([(x, y) for _, series, x, y, _ in rows if series == name])


def test_the_picture_of_a_well_shows_the_stored_numbers_with_the_depth_down() -> None:
    ds = study_kinds.well()
    one = ds.sel(wob=210.0)
    force = marks_of(ds, {"wob": 210.0}, "axial force")
    ends = force[[force[:, 1].argmin(), force[:, 1].argmax()]]
    np.testing.assert_allclose(ends, [[float(one["FZ0"]), 0], [float(one["FZ"]), 200]], rtol=1e-9, atol=1e-9)
    for name, stored in (("push of the wall", one["push_max"]), ("dogleg", one["kappa_max"] * 30 * 180 / np.pi)):
        drawn = marks_of(ds, {"wob": 210.0}, name)[:, 0].max()
        assert drawn == pytest.approx(float(stored), rel=1 / 256), name  # what a picture may be off by
    area = np.pi * (0.0635**2 - 0.0543**2)
    axial = marks_of(ds, {"wob": 210.0}, "axial, tension positive")
    assert axial[:, 0].min() == pytest.approx(-210 / area / 1e3, rel=1e-2)  # F3 is FZ cos(beta), in MPa
    slack = marks_of(ds, {"wob": 210.0}, "1")[:3]
    np.testing.assert_allclose(slack, np.stack([0.241 * 200 / 2 - ds["FZ0"], ds["wob"]], axis=1), rtol=1e-9)
    assert "over 200 m at most" in " ".join(canvas.caption(well_tracks.figure(StoredStudy(ds))))


def test_a_pipe_that_turns_in_place_without_an_answer_says_what_torque_a_straight_one_takes() -> None:
    def pipe(load: float) -> Case:
        rod, hole = Rod(EI=1224.0, GJ=941.6, a=0.0635, L=300.0, weight=0.241), {"friction": 0.25, "sliding": "rotating"}
        return Case(rod, Cylinder(0.10795, "inside", "179deg", **hole), Ends(beta0=0.0, betaL=0.0, FZ=-load))

    light, failed = solve(pipe(5.0)), solve(pipe(90.0))
    assert not failed.solved
    said = pipe_words.sentences(failed, {"length": "m", "force": "kN"})[0]
    torque = float(said.split()[-3])
    assert torque == pytest.approx(float(observe(light, ["surface_torque"])["surface_torque"]), rel=5e-3)


def test_no_buckling_load_is_searched_of_a_pipe_too_long_to_compute(monkeypatch) -> None:
    rod, hole = Rod(EI=1224.0, GJ=941.6, a=0.0635, L=1.5e6, weight=0.241), Cylinder(0.10795, "inside", "120deg")
    refused = solve(Case(rod, hole, Ends(beta0=0.0, betaL=0.0, FZ=-90.0)))
    assert "changes are computed" in str(refused.outcome)
    monkeypatch.setattr("solver.nodes.buckling.tension_of_buckling", lambda rod: pytest.fail(f"of {rod.span} radii"))
    assert not pipe_words.sentences(refused, {"length": "m", "force": "kN"})


def test_a_pipe_that_stands_on_its_foot_is_not_drawn_with_its_hook_there() -> None:
    with pytest.raises(InputError, match="climbs from its foot: give hole"):
        well_tracks.figure(StoredStudy(study_kinds.well(0.0, None)))


def test_a_well_of_a_pipe_that_turns_in_place_is_drawn_without_a_lock_up() -> None:
    fig = well_tracks.figure(StoredStudy(study_kinds.well(sliding="rotating")))
    assert fig.axes[0].get_title(loc="left") == "axial force"
    assert "arrives" not in " ".join(canvas.caption(fig))


def test_the_bands_of_a_well_lie_between_the_limits_of_a_long_pipe() -> None:
    track = well_tracks.figure(StoredStudy(study_kinds.well()), at={"wob": 210.0}).axes[0]
    bands = {str(band.get_label()): band.get_bbox() for band in track.patches}
    limits = [float(label.split("> ")[1].removesuffix(" kN")) for label in bands]
    assert [label.split(" >")[0] for label in bands] == ["sinusoid", "or helix", "sinusoid lifts off"]
    ends = np.array([(-box.x1, -box.x0) for box in bands.values()])
    np.testing.assert_allclose(ends[:, 0], limits, rtol=5e-4)  # labels have four digits
    np.testing.assert_allclose(ends[:-1, 1], ends[1:, 0])


@pytest.mark.parametrize("inclination", (120.0, 60.0))  # s runs down, and up
def test_the_hook_of_a_well_is_at_depth_0_also_where_its_hole_climbs(inclination: float) -> None:
    """Without friction the slack-off is the weight on bit; FZ at the hook is that less the weight along the hole."""
    ds = study_kinds.well(inclination, None)
    along = -0.241 * 200 * np.cos(np.deg2rad(inclination))
    force, slack = (marks_of(ds, {"wob": 150.0}, name) for name in ("axial force", "1"))
    ends = force[[force[:, 1].argmin(), force[:, 1].argmax()]]
    np.testing.assert_allclose(ends, [[along - 150, 0], [-150, 200]], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(slack[:3], np.stack([ds["wob"], ds["wob"]], axis=1), rtol=1e-9)


def test_a_quantity_of_a_well_that_is_0_all_along_is_seen_beside_the_scale_of_the_depth() -> None:
    fig = well_tracks.figure(StoredStudy(study_kinds.well()), at={"wob": 60.0})  # straight
    (track,) = [ax for ax in fig.axes if ax.get_title(loc="left") == "dogleg"]
    (curve,) = [line for line in track.lines if line.get_gid() == "dogleg"]
    assert np.abs(curve.get_xdata()).max() < 1e-6
    others = [line for line in track.lines if line is not curve]
    assert all(line.get_zorder() < curve.get_zorder() for line in others)
    fig.draw_without_rendering()
    away = track.transData.transform((0.0, 0.0))[0] - track.bbox.x0
    assert away > 2 * curve.get_linewidth()  # pixels at 100 an inch


def test_the_title_of_a_well_says_which_pipe_of_a_study_is_drawn() -> None:
    ds = study_kinds.well()
    for at, value in (({}, float(ds["wob"][ds.sizes["wob"] // 2])), ({"wob": 60.0}, 60.0)):
        title = well_tracks.figure(StoredStudy(ds), at=at).texts[0].get_text()
        assert title.endswith(f", WOB = {value:g} kN")
    one = StoredStudy(ds.isel(wob=0))
    assert well_tracks.figure(one).texts[0].get_text() == one.attrs["title"]


def test_a_yield_stress_without_its_unit_is_refused(tmp_path, capsys) -> None:
    path = writing.write(study_kinds.well(), tmp_path / "well.h5")
    assert exit_status("plot", path, "--kind", "well", "--yield-stress", "75", "--out", tmp_path / "well.png") == 2
    assert "--yield-stress needs its unit" in capsys.readouterr().err


def test_pipes_that_yield_are_red_against_slack_off() -> None:
    ds = study_kinds.well()
    stresses = [marks_of(ds, {"wob": wob}, "stress, axial and bending together")[:, 0].max() for wob in (150.0, 210.0)]
    fig = well_tracks.figure(StoredStudy(ds), at={"wob": 210.0}, yield_stress=1e3 * float(np.mean(stresses)))  # kPa
    (red,) = [points for points in fig.axes[-1].collections if points.get_label() == "above yield"]
    np.testing.assert_allclose(np.asarray(red.get_offsets())[:, 1], [210.0])
    said = " ".join(canvas.caption(fig))
    assert "The pipe yields from a weight on bit" in said
    assert "between 150 and 210 kN" in said  # of which one pipe was solved on each side
    assert "the stress is at most" not in said  # a bound beside the stress itself, which is said of the drawn pipe
    other = " ".join(canvas.caption(well_tracks.figure(StoredStudy(ds), at={"wob": 150.0})))
    assert float(other.split("the stress is at most ")[1].split()[0]) == pytest.approx(stresses[1], rel=0.02)
    assert "The drawn pipe yields" in [text.get_text() for text in fig.texts]
    assert "a wave away from the ends" in said


def test_what_is_above_the_yield_stress_alone_is_red() -> None:
    stored, shown = StoredStudy(study_kinds.well()), []
    for strength in (1e4, 5e5):  # kPa
        fig = well_tracks.figure(stored, at={"wob": 150.0}, yield_stress=strength)
        shown.append("above yield" in [text.get_text() for text in fig.legends[0].get_texts()])
    assert shown == [True, False]
    with pytest.raises(InputError, match="choose --kind ridge or curves"):
        well_tracks.figure(StoredStudy(small.six()))


def test_a_stretch_that_begins_and_ends_at_the_same_place_in_four_digits_is_said_as_one(ds, monkeypatch) -> None:
    sol, units = StoredStudy(ds).select({"inclination": 0}).solution, {"length": "m", "force": "kN"}
    monkeypatch.setattr(Solution, "lift_offs", ((0.1, 2.0), (59.996, 60.0)))
    (said,) = (row for row in pipe_words.all_sentences(sol, units) if "the push is below 0" in row)
    assert ", at s = 0.1 to 2, 60 m: " in said


@pytest.mark.parametrize("hole", (30.0, 90.0))
def test_how_far_a_pipe_can_be_pushed_is_said_also_where_its_weight_carries_it(hole: float) -> None:
    wall = Cylinder(R=0.10795, side="inside", inclination=f"{180 - hole} deg", friction=0.25, sliding="axial-forward")
    case = Case(Rod(EI=1224.0, GJ=941.6, a=0.0635, weight=0.241, L=300.0), wall, Ends(beta0=0.0, betaL=0.0, FZ=-100.0))
    said = [row for row in pipe_words.sentences(solve(case), {"length": "m", "force": "kN"}) if row.startswith("reach")]
    assert len(said) == 1
    assert ("its weight carries it" in said[0]) == (hole < 75)
    assert said[0].endswith("kN arrives")


@pytest.mark.parametrize(
    ("excess", "broken", "said"),
    [
        ([-1.0, 3.0, 4.0], [], "from a weight on bit of about 12.5 klbf on, interpolated between 10 and 20 klbf"),
        ([-1.0, 3.0, 4.0], [1], "from a weight on bit on between 10 and 20 klbf"),
        ([-1.0, np.nan, 4.0], [], "from a weight on bit on between 10 and 30 klbf"),
        ([1.0, 3.0, 4.0], [], "with each weight on bit that is solved, from 10 klbf on"),
    ],
)
def test_the_weight_on_bit_at_which_a_pipe_yields_lies_between_two_that_are_solved(excess, broken, said: str) -> None:
    assert well_tracks._yield_words(np.array([10.0, 20.0, 30.0]), np.array(excess), broken, "klbf") == said


def test_the_track_of_the_push_has_the_range_of_the_pipe_away_from_its_clamps() -> None:
    ds = study_kinds.well(sizes=(350.0, 400.0))
    fig = well_tracks.figure(StoredStudy(ds), at={"wob": 400.0})
    push = marks_of(ds, {"wob": 400.0}, "push of the wall")[:, 0]
    away = float(" ".join(canvas.caption(fig)).split("a wave away from the ends it is at most ")[1].split()[0])
    assert away < push.max() / 1.5  # the push of a clamp
    assert fig.axes[1].get_xlim()[1] == pytest.approx(away, rel=0.15)
