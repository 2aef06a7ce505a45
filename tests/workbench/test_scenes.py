"""The tube about the rod, and the pictures made of it."""

import resource
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from PIL import Image

from solver import Case, Cylinder, Rod, Start, observe, solve
from solver.orbits import frames
from solver.problem.errors import InputError
from studies import load
from studies.language.loader import loads
from tests.cases import helix_moment, in_units_of_rho
from tests.workbench import small
from tests.workbench.page_faults import faults
from tests.workbench.pictures import draws, pixels, share_of_hue, share_of_ink
from workbench.commands import draw_scene, options
from workbench.figures import canvas, colours
from workbench.geometry import solid_body, tube_tolerance
from workbench.geometry.centreline import Centreline
from workbench.geometry.lines import Lines
from workbench.run import in_memory, writing
from workbench.scene import body as rods
from workbench.scene import dna_strands, long_rod, opengl, page, scene_kinds, signs, surfaces, true_scale, views
from workbench.scene.scene_kinds import KINDS, Cell, kind_of
from workbench.scene.views import View
from workbench.stored.quantity_variables import SECTION
from workbench.stored.stored_study import StoredStudy
from workbench.words.labels import number

DNA = Path(__file__).parents[2] / "examples" / "dna.toml"
START = {"beta": 0.5, "dbeta": 0.1, "dgamma": 0.5}

if opengl.probe()[0]:  # without the libraries of OpenGL these cannot be imported
    from workbench.scene import composition, layout, rendering
    from workbench.scene.rendering import Placed, render


PIPE = {"EI": 1225.0, "GJ": 940.0, "a": 0.0635, "L": 100.0, "R": 0.12, "side": "inside", "beta0": 0.0, "betaL": 0.0,
        "FZ": -150.0, "MZ": 0.0, "M3": 0.0}  # fmt: skip


def dataset(side: str = "outside", axes: str = "", stations: int = 201, L: float = 20.0, **keys: object) -> xr.Dataset:
    base = {**small.ROD, "L": L, "side": side, **START, "F3": 10.0 if side == "outside" else -10.0}
    return in_memory.run(loads(small.text(base, axes, stations=stations, **keys), default_name="rod"))


@pytest.fixture(scope="module")
def fig6() -> xr.Dataset:
    return small.study_dataset("fig6")


def body(ds: xr.Dataset, kind: str = "contact", **where: int) -> rods.Body:
    return rods.read(StoredStudy(ds), where, kind_of(kind))


def test_the_colour_of_lift_off_covers_what_is_not_attached(fig6) -> None:
    values = body(fig6).value(np.linspace(0, 20, 20001))
    assert (values >= 0).mean() == pytest.approx(float(fig6["attached"]), abs=1e-3)


def test_the_extremes_of_a_rod_are_those_of_its_solution_and_not_of_the_places_that_are_drawn() -> None:
    ds = StoredStudy(dataset("inside"))
    solved = observe(ds.at(), ["push_min", "push_max"])
    assert body(ds).extremes() == pytest.approx([float(value) for value in solved.values()], rel=1e-5)


def test_the_stripe_turns_with_the_material() -> None:
    ds = dataset(outputs=["beta", "alpha", "z", "gamma"])
    rod = body(ds, "twist")
    rod = replace(rod, paint=scene_kinds.Paint("white", stripe="blue"))
    rings = rod.rings(1e-3, 0.0)
    mesh, stripe = surfaces.tube_parts(rod, rings)
    middle = mesh.normals[: rings.s.size * rings.sides].reshape(-1, rings.sides, 3)[:, 0]
    alpha, beta, _ = rod.line.at(rings.s)
    gamma = np.interp(rings.s, ds["s"], ds["gamma"])
    d1 = frames.material(alpha, beta, gamma)[:, 0]
    # the stripe's middle is opposite the section's first axis; gamma is interpolated linearly here
    np.testing.assert_allclose(middle, -d1, atol=5e-3)
    assert 2 * len(stripe.triangles) == len(mesh.triangles) - 2 * rings.sides


def pixels_per_length(rod: rods.Body, found: Lines, ends: tuple[float, float], room: tuple[int, int]) -> float:
    return float(min(room[0] / np.ptp(ends), room[1] / (found.count * long_rod.PITCH * 2 * rod.reach)))


def test_a_long_rod_is_set_in_lines_that_show_all_of_it() -> None:
    rod = body(dataset(stations=20_001, L=2000.0))
    room = (1400, 960)
    found, ends = long_rod.lines_for([rod], room)
    pieces, per_unit = long_rod.cut(found, rod), pixels_per_length(rod, found, ends, room)
    assert long_rod.is_long([rod])
    assert not long_rod.is_long([body(dataset())])
    assert [piece.span[0] for piece in pieces] == pytest.approx([0.0, *(piece.span[1] for piece in pieces[:-1])])
    assert pieces[-1].span[1] == pytest.approx(2000.0)
    assert all(ends[0] < piece.z.min() and piece.z.max() < ends[1] for piece in pieces)
    assert 2 * rod.reach * per_unit > 4 * long_rod.THINNEST  # in one row it would be a hair of two pixels
    assert found.heads([piece.span for piece in pieces], "cm")[0] == "s = 0 cm"


@draws
def test_all_lines_of_a_rod_share_the_triangles_of_a_picture(monkeypatch) -> None:
    tight = dataset(stations=4001, L=2000.0)
    layout.compose(StoredStudy(tight), settings=layout.Settings(2.0, 50))
    monkeypatch.setattr(rendering, "ALL_TRIANGLES", 5000)  # a line takes fewer, all take more
    with pytest.raises(
        InputError, match=r"triangles for a part of the picture, and \d+ are the limit: .*--from and --to"
    ):
        layout.compose(StoredStudy(tight), settings=layout.Settings(2.0, 50))


@draws
def test_a_long_pipe_with_wide_bends_is_compressed_into_one_line_and_one_with_tight_bends_is_set_in_lines() -> None:
    ds = in_memory.run(loads(small.text(PIPE, units="m kN", stations=401)))
    pipe = layout.compose(StoredStudy(ds), settings=layout.Settings(2.0, 50, camera="sides"))
    assert len(pipe.scene.rows) == 2, "two sides of the whole pipe, one below the other"
    assert any("axis compressed" in note for note in pipe.notes)
    tight = dataset(stations=4001, L=2000.0)
    assert long_rod.compress([body(tight)])[0].squeeze == 1
    with pytest.raises(InputError, match="set in lines, is seen from one side, and --camera sides has several"):
        layout.compose(StoredStudy(tight), settings=layout.Settings(camera="sides"))


@draws
def test_the_words_of_a_table_of_long_pipes_stand_apart() -> None:
    axes = small.axis("FZ", [-150.0, -100.0]) + small.axis("R", [0.1, 0.12, 0.15])
    ds = in_memory.run(loads(small.text(PIPE, axes, units="m kN", stations=401)))
    taken = layout.compose(StoredStudy(ds), None, "grid", ["FZ", "R"], settings=layout.Settings(2.0, 50))
    assert taken.scene.heads[0] == "", "the name of the rows is longer than they are high"
    assert "rows: radius of the cylinder" in taken.scene.case
    taken.fig.canvas.draw()
    boxes = [text.get_window_extent() for text in taken.ax.texts if text.get_text()]
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])


def test_with_far_too_few_stations_a_long_rod_is_no_taller_than_it_is_long_and_more_are_asked_for() -> None:
    rod = body(dataset(stations=21, L=2000.0))
    found, ends = long_rod.lines_for([rod], (1400, 960))
    assert np.ptp(ends) <= 2 * (2000.0 / found.count + rod.a + 0.3 * rod.R) * (1 + 1e-9)
    assert tube_tolerance.stations_for(rod.line, 0.5 / pixels_per_length(rod, found, ends, (1400, 960))) > 21


def test_of_a_rod_too_long_for_the_page_stretches_are_set_and_the_rest_is_told() -> None:
    rod = body(dataset(stations=20_001, L=2000.0))
    found, ends = long_rod.lines_for([rod], (60, 40))
    pieces, per_unit = long_rod.cut(found, rod), pixels_per_length(rod, found, ends, (60, 40))
    assert 2 * rod.reach * per_unit > 0.9 * long_rod.THINNEST  # swings at the ends of a line may take a little
    assert (pieces[0].span[0], pieces[-1].span[1]) == (0.0, pytest.approx(2000.0))
    assert sum(piece.span[1] - piece.span[0] for piece in pieces) < 2000.0
    assert found.note([piece.span for piece in pieces], "cm").startswith(f"only {found.count} pieces")


@dataclass(frozen=True, eq=False)
class Counted(StoredStudy):
    """A stored study that remembers which variables were opened."""

    opened: set[str] = field(default_factory=set)

    def only(self, names: Iterable[str]) -> StoredStudy:
        self.opened.update(names)
        return StoredStudy(self.ds).only(names)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "equilibria"])
def test_a_scene_reads_and_computes_what_its_kind_declares_and_nothing_else(kind: str, fig6, monkeypatch) -> None:
    counted: list[str] = []
    line = Centreline
    for name in ("contact", "kappa"):
        real = getattr(line, name)
        monkeypatch.setattr(line, name, lambda self, s, n=name, real=real: (counted.append(n), real(self, s))[1])
    opened: set[str] = set()
    rod = rods.read(Counted(fig6, opened=opened), {}, KINDS[kind])
    shown = {"contact": {"contact"}, "grid": {"contact"}, "curvature": {"kappa"}}.get(kind, set())
    low_high = rod.extremes() if shown else (0.0, 1.0)
    ramp = colours.ramp() if shown else None
    rod = replace(rod, paint=scene_kinds.Paint(ramp=ramp, low=low_high[0], high=low_high[1]))
    surfaces.tube_parts(rod, rod.rings(0.01, 0.0))
    assert opened <= KINDS[kind].reads | {"solved", "outcome", "caution", "dbeta", *SECTION}
    assert set(counted) == shown | {"kappa"}  # where it bends more, rings are nearer


def test_strands_of_dna_turn_right_handed_with_the_material_and_have_a_base_pair_each_0_34_nm() -> None:
    """The turns of a strand are those of the stored rotation of the material and those of DNA without strain."""
    study = load(DNA)
    ds = StoredStudy(in_memory.run(study.model_copy(update={"outputs": [*study.outputs, "gamma"]})))
    kind = KINDS["double-helix"]
    rod = replace(rods.read(ds, {}, kind), paint=kind.paint(ds.units, None))
    assert dna_strands.pairs_of(rod) == 147  # 49.98 nm, 0.34 nm apart
    s = np.linspace(*rod.span, 4001)
    place, along, out, _ = rod.line.frame(s)
    for side in (0, 1):
        away = dna_strands._strand(rod, s, side) - place
        np.testing.assert_allclose(np.linalg.norm(away, axis=1), (1 - dna_strands.STRAND) * rod.a)
        turned = np.unwrap(np.arctan2(np.sum(away * np.cross(along, out), axis=1), np.sum(away * out, axis=1)))
        material = np.ptp(ds["gamma"].values)  # rises along this rod
        assert turned[-1] - turned[0] == pytest.approx(2 * np.pi * 147 / 10.5 + material, rel=1e-6)
    assert [words for _, words in dna_strands.marks(rod)] == ["base pair 1", "dyad", "base pair 147"]
    said = "the push at 5 pN tension and −4.44 pN nm torque: 1.19 pN/nm everywhere"
    assert kind.numbers(rod.line, ds) == [said]
    with pytest.raises(InputError, match="0 base pairs"):
        dna_strands.pairs_of(replace(rod, span=(0.0, 0.1)))


def test_what_a_picture_says_of_its_case_asks_for_that_case_again() -> None:
    ds = in_memory.run(load("fig7_1_modulus").at_stations(2))
    for i in range(ds.sizes["E"]):
        said = scene_kinds.case_values(StoredStudy(ds), {"E": i}).partition(" = ")[2].partition(" ")[0]
        assert options.axis_values(StoredStudy(ds), [f"E={said}"]) == {"E": float(ds["E"].values[i])}
    assert scene_kinds.values(StoredStudy(ds), {"E": 3}) == ["E = 10910 N/cm²"]  # a heading: 10905.1


@draws
def test_a_row_in_the_table_is_all_that_a_new_kind_needs(fig6, tmp_path, monkeypatch, capsys) -> None:
    def red(units: dict[str, str], extremes: scene_kinds.Extremes) -> scene_kinds.Paint:
        return scene_kinds.Paint("#ff0000")

    toy = scene_kinds.SceneKind("toy", "one", paint=red, legend=(("#ff0000", "a toy"),))
    monkeypatch.setitem(KINDS, "toy", toy)
    file = writing.write(fig6, tmp_path / "fig6.h5")
    assert draw_scene.scene(file, kind="toy", dpi=60) == 0
    assert share_of_hue(pixels(tmp_path / "fig6_scene_toy.png"), "#ff0000") > 0.02
    with pytest.raises(InputError, match=r"no kind of scene 'none'.*toy"):
        draw_scene.scene(file, kind="none")


@draws
def test_beside_a_compressed_axis_stand_the_hole_and_a_part_at_true_scale() -> None:
    case = Case(
        Rod(EI=1.0, GJ=1.0, a=0.05, L=60.0),
        Cylinder(R=0.1, side="inside"),
        Start(beta=0.01, dbeta=0.0, F3=-1.0, M3=0.0),
    )
    stored = StoredStudy(solve(case, stations=401).to_dataset())
    body, why = rods.of_case(stored, {}, KINDS["plain"])
    assert why == ""
    view, ax, wide = View(long_rod.compress([body]), Cell()), Figure().add_subplot(), 6.0
    assert true_scale.is_needed([view])
    true_scale.draw(ax, view, views.front_camera(view.bodies, lying=True), (0.0, 0.0), wide, "m")
    x, y = next(line for line in ax.lines if line.get_gid() == "end view").get_data()
    middle = 2 * signs.EYE + true_scale.HOLE
    np.testing.assert_allclose(np.hypot(x - middle, y - true_scale.HOLE), 0.5 * true_scale.HOLE, rtol=1e-6)
    (wall,) = [one for one in ax.patches if one.get_gid() == "at true scale"]
    (band,) = (one for one in ax.collections if isinstance(one, PolyCollection))
    left = middle + true_scale.HOLE + true_scale.APART
    assert wall.get_width() == pytest.approx(wide - left)
    ends = band.get_paths()[0].vertices[:, 0]
    assert ends.min() <= left  # the wall cuts it off, so that no end of the rod is seen where there is none
    assert ends.max() >= wide - 1e-9
    assert band.clipbox is not None
    shown = (wide - left) * 0.2 / true_scale.STRIP  # length of the part; the strip is as high as the hole is wide
    words = f"a part of it at true scale: z = {number(30 - shown / 2)} to {number(30 + shown / 2)} m"
    assert [text.get_text()[:22] for text in ax.texts[:2]] == ["its end and its middle", words[:22]]
    length, _ = ax.texts[2].get_text().split()
    (bar,) = (np.ptp(one.get_segments()[0][:, 0]) for one in ax.collections if isinstance(one, LineCollection))
    assert bar == pytest.approx(float(length) * true_scale.STRIP / 0.2)


def test_the_eye_beside_the_cylinder_from_above_stands_on_the_page_whole() -> None:
    for angle in np.radians(np.arange(0, 360, 15)):
        ax = Figure().add_subplot()
        signs.draw_glyph(ax, 0.0, 0.0, np.array([np.cos(angle), np.sin(angle), 0.0]))
        lids = np.concatenate([line.get_xydata() for line in ax.lines[1:]])
        assert np.abs(lids[:, 1]).max() + 0.9 / 72 / 2 < page.BARS  # as far down as there is room
        assert np.hypot(*(lids - ax.patches[0].center).T).min() > signs.DIAL  # beside the cylinder


@draws
def test_a_rod_in_lines_says_on_its_picture_that_it_passes_through_itself_as_it_has_no_rings() -> None:
    long = StoredStudy(in_memory.run(loads((DNA.parents[1] / "docs/scene_rods/long.toml").read_text(encoding="utf-8"))))
    taken = layout.compose(long, settings=composition.Settings(dpi=60, pixel_error=4.0))
    assert composition.ITSELF in taken.line
    assert not taken.rings
    assert "Table 1: twist from F₁₀, F₃₀ as tension, stiffness of eq. 20." in canvas.caption(taken.fig)


def test_fig_6_is_large_and_shows_rod_cylinder_and_lift_off(fig6, tmp_path) -> None:
    taken = layout.render(StoredStudy(fig6), tmp_path / "fig6.png")
    assert taken.error <= 0.5 * (1 + 1e-9)
    picture = pixels(tmp_path / "fig6.png")
    assert 1439 <= picture.shape[1] <= 1440  # Matplotlib may round down
    assert 450 < picture.shape[0] <= 1200  # no emptier than its words need
    assert share_of_ink(picture) > 0.25
    assert share_of_hue(picture, to_hex(scene_kinds.PUSH_RAMP(0.9))) > 0.01
    assert share_of_hue(picture, to_hex(scene_kinds.PUSH_RAMP(0.2))) > 0.02
    edge = np.concatenate([picture[:8].ravel(), picture[-8:].ravel(), picture[:, :8].ravel(), picture[:, -8:].ravel()])
    assert (edge > 0.98).all()  # nothing is cut off


@pytest.mark.parametrize("channels", [3, 4])
def test_rendered_pixels_stand_on_the_page_as_they_are(channels) -> None:
    rendered = np.random.default_rng(1).integers(0, 256, (40, 60, channels), dtype=np.uint8)
    rendered[..., 3:] = 255
    fig = canvas.figure((1.0, 0.5), lambda fig: fig.figimage(rendered, 12, 7), dpi=200, layout=None)
    if channels == 4:
        fig.patch.set_alpha(0.0)
    stored = page.pixels_of(fig)
    assert stored.shape == (100, 200, channels)  # no channel that says nothing
    np.testing.assert_array_equal(stored[100 - 7 - 40 : 100 - 7, 12 : 12 + 60], rendered)
    beside = stored[:50, :12, channels - 1]
    assert (beside == (255 if channels == 3 else 0)).all()


def before_it(bodies: list[rods.Body], width: int, height: int, lying: bool = False) -> views.Camera:
    """A camera that sees all of a rod in a picture of a size."""
    camera = views.front_camera(bodies, lying=lying)
    low, high = View(bodies, Cell("")).box(camera)
    return replace(camera, per_unit=float(np.min(np.array([width, height]) / (high - low))))


@draws
def test_a_row_has_one_scale_and_one_camera() -> None:
    ds = dataset(axes="[axes.E]\nvalues = [1e4, 2e4]\n")
    found = [body(ds, E=i) for i in (0, 1, 0, 1)]
    camera = before_it(found, 160, 300)
    placed = [Placed(View([rod], Cell(""), ends=(-1.0, 19.0)), (80.0 + 160 * k, 150.0)) for k, rod in enumerate(found)]
    picture = render(placed, camera, (640, 300), 0.5)[0].astype(int)
    first, second, third, fourth = np.split(picture, 4, axis=1)
    for one, again in ((first, third), (second, fourth)):  # the same rod in another cell
        assert np.abs(one - again).max() <= 255 / 8 + 0.5  # one of the samples of a pixel on an edge
        assert np.abs(one - again).mean() < 0.2
    assert (np.abs(first - second).max(axis=-1) > 24).mean() > 0.02  # and another rod looks different


@draws
def test_each_pixel_is_the_mean_of_its_parts() -> None:
    rod = body(dataset())
    camera = before_it([rod], 400, 160, lying=True)

    def drawn(finer: int, samples: int) -> np.ndarray:
        placed = [rendering.Placed(View([rod], Cell("")), (200.0 * finer, 80.0 * finer))]
        at = replace(camera, per_unit=camera.per_unit * finer)
        size, line = (400 * finer, 160 * finer), float(finer)
        return rendering.render(placed, at, size, 0.5, line=line, samples=samples)[0].astype(float)

    sampled = drawn(1, 4)
    assert sampled.shape == (160, 400, 3)
    mean = drawn(4, 1).reshape(160, 4, 400, 4, 3).mean(axis=(1, 3))
    # of 255; moved by a pixel it would be above 2, by a quarter above 0.5
    assert np.abs(sampled - mean).mean() < 0.5


@draws
def test_the_cylinder_is_as_wide_as_the_scale_bar_says() -> None:
    rod = body(dataset())
    camera = before_it([rod], 300, 600)
    camera = replace(camera, per_unit=0.9 * camera.per_unit)
    low, high = View([rod], Cell("")).cylinder
    view = View([rod], Cell(""), ends=(low - 1.0, high + 1.0))
    picture, *_ = render([Placed(view, (150.0, 300.0))], camera, (300, 600), 0.5)
    first = np.argmax(picture.min(axis=(1, 2)) < 250) + 3
    top = picture[first : first + 15].min(axis=-1) < 250  # only the cylinder reaches up there
    assert top.sum(axis=1).max() == pytest.approx(2 * 0.75 * camera.per_unit, abs=2)  # a pixel on either side


@pytest.fixture(scope="module")
def helix() -> xr.Dataset:
    """A helix at 0.8 rad on a cylinder of rho = 1, whose pitch is 2 pi / tan(0.8)."""
    case = in_units_of_rho(helix_moment(0.8, 0.9, -0.4), 0.9, -0.4, 20.0, 0.8, 0.0)
    given = {**asdict(case)["rod"], **asdict(case)["cylinder"], **asdict(case)["given"]}
    text = small.text({k: v if isinstance(v, str | None) else float(v) for k, v in given.items()}, stations=201)
    return in_memory.run(loads(text, default_name="helix"))


@draws
def test_a_hidden_stretch_is_an_outline_and_has_no_colour_of_the_bar(helix) -> None:
    rod = body(helix, "plain")
    rod = replace(rod, paint=scene_kinds.Paint("#ff0000"))
    camera = before_it([rod], 600, 120, lying=True)
    view = View([rod], Cell(""))
    picture = render([Placed(view, (300.0, 60.0))], camera, (600, 120), 0.5)[0] / 255.0
    red = picture[..., 0] - picture[..., 2] > 0.25  # what is in front, and what is seen beside the cylinder
    place = view.places(rod)
    across, towards = (np.column_stack([camera.page[1], camera.toward]).T @ place.T)[:, :]
    hidden_ones = (towards < 0) & (np.abs(across) < 0.3)
    at = np.round((place[hidden_ones] - np.array([0, 0, sum(view.cylinder) / 2])) @ camera.page.T * camera.per_unit)
    column, row = (300 + at[:, 0]).astype(int), (60 - at[:, 1]).astype(int)
    assert not red[row, column].any()
    cool = picture[..., 0] - picture[..., 2] < 0.025  # unlike the cylinder
    lines = [cool[r - 16 : r + 17, c].any() for r, c in zip(row, column, strict=True)]
    assert np.mean(lines) > 0.9


@draws
def test_only_what_is_wide_enough_is_an_outline() -> None:
    rods, everything = np.ones((2, 40, 60), dtype=np.float32)
    everything[:30] = 0.3  # a wall
    rods[10:20, 5:50] = 0.6  # a stretch behind it
    rods[26:28, 5:50] = 0.6  # a sliver behind it
    rods[33:38, 5:50] = 0.6  # beyond the wall
    everything[33:38, 5:50] = 0.6
    seen, line, behind = rendering.outlines(rods, everything, rendering.Drawn(0.1, 4.0, 1.0))
    assert seen[33:38, 5:50].any(axis=0).all()
    assert not seen[:33].any()
    assert behind[10:20, 5:50].all()
    assert behind.sum() == 450
    assert line[10, 5:50].all()
    assert line[19, 5:50].all()
    assert not line[12:18, 8:47].any()


@draws
def test_the_outline_of_a_slanted_hidden_stretch_has_no_gaps() -> None:
    i, j = np.indices((120, 160))
    stretch = np.abs(i - 60 - 0.35 * (j - 80)) < 14
    rods = np.where(stretch, 0.6, 1.0).astype(np.float32)
    everything = np.full((120, 160), 0.3, dtype=np.float32)
    _, line, _ = rendering.outlines(rods, everything, rendering.Drawn(0.1, 16.0, 1.0))
    assert (line[:, 5:-5].sum(axis=0) >= 2).all()  # the upper and the lower edge


@draws
def test_the_outline_between_two_hidden_turns_that_touch_has_no_gaps() -> None:
    a, slant = 44.0, 0.02  # samples
    i, j = np.indices((260, 400))

    def turn(middle: float, deep: float) -> np.ndarray:
        return (
            deep
            - np.sqrt(np.maximum(a**2 - (i - middle - slant * j) ** 2, 0))
            + 1e3 * (abs(i - middle - slant * j) >= a)
        )

    first, depth = 60.0, 1000.0
    for angle in np.radians([24, 32, 40]):
        rods = (
            np.minimum(turn(first, 100.0), turn(first + 2 * a * np.cos(angle), 100.0 + 2 * a * np.sin(angle))) / depth
        )
        drawn = rendering.Drawn(rendering.edge_between(a, 1.0) / depth, 0.42 * a, 1.0)
        _, line, _ = rendering.outlines(np.minimum(rods, 1).astype(np.float32), np.zeros((260, 400), np.float32), drawn)
        between = np.abs(i - first - a - slant * j) < 4
        assert (line & between)[:, 5:-5].any(axis=0).all()


def test_the_hole_of_a_long_pipe_is_a_tenth_as_high_as_long() -> None:
    ds = in_memory.run(loads(small.text(PIPE | {"FZ": -1.0}, units="m kN", stations=201)))
    (rod,) = long_rod.compress([body(ds, "plain")])
    assert 2 * rod.reach / np.ptp(rod.z) == pytest.approx(1 / 10, rel=0.01)  # straight: no bend limits it


def test_the_shadow_of_contact_is_that_of_a_bar_on_a_plane() -> None:
    s = np.linspace(-50, 50, 4001)
    bar = np.stack([0 * s, 0 * s + 0.5, s], axis=-1)  # of radius 0.5 above the plane y = 0
    away = np.array([0.0, 0.1, 0.5, 1.0, 2.0])
    light = surfaces.light_on_wall(np.stack([away, 0 * away, 0 * away], axis=-1), bar, 0.5)
    # half of the plane's light is that of the directions up to a height, (1 + cos)/2 of Lambert's law in two dimensions
    height = 2 * np.arctan2(0.5, away)
    lost = 1 - (1 + np.cos(height)) / 2
    scale = surfaces.REACH**2 / (surfaces.REACH**2 - 1)  # nothing is lost at the reach
    np.testing.assert_allclose(1 - light, surfaces.DEPTH * (1 - (1 - lost) * scale), atol=1e-4)


@draws
def test_the_texture_of_a_wall_goes_once_around_it(fig6) -> None:
    wall = surfaces.wall([body(fig6)], (0.0, 20.0), 40.0)
    columns, corners = wall.texture.shape[1], surfaces.FACETS + 1
    np.testing.assert_allclose(wall.at[:corners, 0] * columns, np.linspace(0.5, columns - 0.5, corners))


@draws
def test_a_case_without_a_shape_leaves_a_labelled_empty_cell(tmp_path) -> None:
    ds = dataset(axes="[axes.E]\nvalues = [1e4, 2e4, 3e4]\n")
    ds = small.with_outcomes(ds, ["solved", "no solution", "solved"])
    ds["alpha"][1] = np.nan
    taken = layout.compose(StoredStudy(ds), None, "grid", ["E"], settings=layout.Settings(2.0, 60))
    assert [view.cell.why_empty for view in taken.scene.views] == ["", "no solution", ""]
    with pytest.raises(InputError, match="nothing to draw at E = 20000 N/cm²: no solution"):
        layout.render(StoredStudy(ds), tmp_path / "one.png", {"E": 2e4})
    ds = small.with_outcomes(ds, ["no solution"] * 3)
    assert share_of_ink(pixels(layout.draw(StoredStudy(ds), tmp_path / "none.png")["scene E"])) > 0.001


@draws
def test_inside_the_rod_is_seen_through_the_near_wall(tmp_path) -> None:
    layout.render(StoredStudy(dataset("inside")), tmp_path / "inside.png", kind="curvature")
    assert share_of_hue(pixels(tmp_path / "inside.png"), "#21918c", 0.2) > 0.01


@draws
def test_the_words_of_a_rod_inside_a_tube_say_inside_once() -> None:
    rods = StoredStudy(dataset("inside").assign_attrs(title="A rod inside a tube"))
    texts = [text.get_text() for text in layout.compose(rods, settings=composition.Settings(2.0, 50)).fig.texts]
    assert " ".join(texts).count("inside") == 1
    cut = "the near half of the wall is cut away"
    assert cut in texts
    untitled = layout.compose(rods, settings=composition.Settings(2.0, 50, titled=False)).fig
    assert not untitled.texts
    assert canvas.caption(untitled)[0] == f"{cut}."


def test_no_push_is_white_and_the_least_push_and_pull_are_not() -> None:
    paint = scene_kinds.by_push({"length": "cm", "force": "N", "angle": "rad"}, (-1.0, 1.0))
    row = surfaces.texture_of(paint)[1]
    place = surfaces.place_on(paint, np.array([0.0])) * surfaces.COLUMNS
    assert place == surfaces.COLUMNS // 2 + 0.5  # in the middle of a texel: no other is mixed with it
    pull, none, push = row[int(place[0]) - 1 : int(place[0]) + 2]
    assert tuple(none) == colours.rgb(scene_kinds.OFF_WALL)
    assert min(none) > 250 > max(pull[2], push[0])


@draws
@pytest.mark.slow
def test_a_wound_rod_does_not_blow_the_memory(tmp_path) -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    layout.render(StoredStudy(dataset(stations=20_001, L=2000.0)), tmp_path / "long.png")
    long = dataset(axes="[axes.E]\nvalues = [1e4, 2e4]\n", stations=2001, L=2000.0)
    with pytest.raises(InputError, match="pixels wide in the picture: draw a shorter part"):
        layout.compose(StoredStudy(long), kind="ghosts", settings=composition.Settings(span=(0.0, 2000.0)))
    # kilobytes; a process of its own takes 0.9e6 for it, of which 0.8e6 for any picture
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 1.2e6


@draws
def test_a_look_chooses_side_colours_size_and_what_is_left_out(fig6, tmp_path) -> None:
    file = writing.write(fig6, tmp_path / "fig6.h5")
    look = {"camera": "front", "color_range": "0,50", "bare": True, "transparent": True, "size": "640x300"}
    assert draw_scene.scene(file, out=tmp_path / "out.png", dpi=80, **look) == 0
    with Image.open(tmp_path / "out.png") as picture:
        assert (picture.size, picture.mode) == ((640, 300), "RGBA")
        seen = np.asarray(picture) / 255.0
    assert seen[:5, :, 3].max() == 0  # no title, nothing at the edge
    # most of the pushed part is above 50 N/cm, so it has the darkest blue
    assert share_of_hue(seen[..., :3], to_hex(scene_kinds.PUSH_RAMP(1.0))) > 0.02


@draws
def test_a_dark_scene_has_light_words_and_a_rod_in_one_colour_has_the_one_that_is_asked_for(fig6, tmp_path) -> None:
    file, back = writing.write(fig6, tmp_path / "fig6.h5"), colours.THEMES["dark"][0]
    assert draw_scene.scene(file, out=tmp_path / "dark.png", dpi=80, theme="dark", kind="plain", color="gold") == 0
    seen = pixels(tmp_path / "dark.png")
    np.testing.assert_allclose(seen[[0, 0, -1, -1], [0, -1, 0, -1]], [to_rgb(back)] * 4, atol=1 / 255)
    title = seen[: seen.shape[0] // 8]
    assert title.max() > 0.85
    assert np.mean(np.abs(title - to_rgb(back)).max(axis=-1) < 0.02) > 0.5
    assert share_of_hue(seen, "#ffd700", 0.2) > 0.05
    assert draw_scene.scene(file, out=tmp_path / "dark.html", background="#102030") == 0
    said = (tmp_path / "dark.html").read_text()
    assert "@media all" in said
    assert "--paper: #102030" in said
    for words, look in (
        ("--color is for the kind plain", {"color": "gold"}),
        ("--background takes an opaque colour", {"background": "no colour"}),
        ("--background takes an opaque colour.*'none'", {"background": "none"}),
        ("--color takes an opaque colour.*'#ff000080'", {"color": "#ff000080", "kind": "plain"}),
        ("no theme 'grey'", {"theme": "grey"}),
        ("exclude each other", {"background": "navy", "transparent": True}),
    ):
        with pytest.raises(InputError, match=words):
            draw_scene.scene(file, out=tmp_path / "refused.png", dpi=50, **look)


def test_the_places_of_self_intersection_are_where_two_stretches_are_less_than_two_radii_apart(fig6) -> None:
    rod = body(fig6)
    places = solid_body.middles(rod.line, rod.span)
    s = np.linspace(0, 20, 8001)
    curve = rod.line.frame(s)[0]
    for place in places:
        near = s[np.linalg.norm(curve - place, axis=1) < rod.a]  # of two stretches at least
        assert np.ptp(near) > np.pi * rod.a
    assert len(places) >= 5
    assert not solid_body.middles(rod.line, (0.0, 2.0))


def test_a_rod_that_overlaps_in_a_tight_bend_alone_is_ringed_where_it_is_bent_most() -> None:
    ds = StoredStudy(small.study_dataset("fig7_2_radius"))
    stored = ds.select({"R": 0})
    line = stored.centreline
    assert 1 < float(stored["kappa_max"]) * line.a < 1.05
    pairs = np.array(solid_body.places(line.s, line.frame(line.s)[0], line.a))
    assert len(pairs)
    assert (np.ptp(pairs, axis=1) == 0).all()
    assert line.kappa(pairs[:, 0]) == pytest.approx(float(stored["kappa_max"]), rel=0.02)
    for k, passes in enumerate(ds["overlaps"].values):  # a ring for each rod that is counted
        line = ds.select({"R": k}).centreline
        assert bool(solid_body.middles(line, (0.0, line.L))) == bool(passes)


def test_a_tight_bend_beside_an_overlap_is_a_part_of_it() -> None:
    """Three loops of two overlaps, with a tight bend beside each; of the fourth one, which is cut, both are places."""
    line = StoredStudy(small.study_dataset("fig7_1_modulus")).select({"E": 0}).centreline
    s = np.linspace(0, line.L, 2001)
    pairs = np.array(solid_body.places(s, line.frame(s)[0], line.a))
    assert (np.ptp(pairs, axis=1) == 0).tolist() == [False] * 7 + [True]
    assert np.diff(pairs[:6, 0])[[0, 2, 4]] == pytest.approx(np.diff(pairs[:2, 0])[0], abs=0.5 * line.a)


@draws
def test_a_place_behind_a_stretch_of_the_rod_has_no_ring(fig6) -> None:
    side = layout.compose(StoredStudy(fig6), None, "twist", settings=composition.Settings(2.0, 50, camera="sides"))
    middle = np.mean([top + high / 2 for _, top, _, high in side.arrangement.places])
    assert len(side.rings) == 5
    assert all(y < middle for _, y, _ in side.rings)


def test_each_place_where_a_centreline_crosses_itself_is_one_also_where_one_overlap_joins_several() -> None:
    rod = body(small.study_dataset("fig7_4_end_angle"), betaL=8)
    s = np.linspace(0, rod.line.L, 2001)
    places = rod.line.frame(s)[0]
    plane = np.column_stack([places[:, 2], rod.line.rho * np.unwrap(np.arctan2(places[:, 1], places[:, 0]))])
    step = np.diff(plane, axis=0)[:, None]
    way = plane[None, :-1] - plane[:-1, None]

    def area(one: np.ndarray, other: np.ndarray) -> np.ndarray:
        return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]

    turn = area(step, step.swapaxes(0, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        share, other = area(way, step.swapaxes(0, 1)) / turn, area(way, step) / turn
    meet = np.argwhere((share >= 0) & (share < 1) & (other >= 0) & (other < 1))
    crossings = s[meet[meet[:, 1] > meet[:, 0] + 1]]
    found = np.array(solid_body.places(s, places, rod.a))
    assert len(crossings) == 10
    assert np.abs(crossings[:, None] - found).max(axis=-1).min(axis=1).max() < 0.5 * rod.a  # points a/4 apart


@draws
def test_each_rod_of_a_row_that_passes_through_itself_is_ringed_in_its_cell(fig6) -> None:
    ds = dataset(axes="[axes.F3]\nvalues = [1.0, 10.0, 40.0]\n")
    taken = layout.compose(StoredStudy(ds), None, "grid", ["F3"], settings=composition.Settings(2.0, 50))
    inside = [[x for x, y, _ in taken.rings if left <= x <= left + wide and 0 <= y - top <= high]
              for left, top, wide, high in taken.arrangement.places]  # fmt: skip
    assert sum(map(len, inside)) == len(taken.rings)
    through = ["overlaps" in str(caution) for caution in ds["caution"].values]
    assert sorted(set(through)) == [False, True]
    assert [bool(found) for found in inside] == through
    assert signs.RING in [colour for colour, _ in taken.legend]
    assert sum(through) == 1
    assert "1 of 3 passes through itself" in taken.notes
    bare = layout.compose(StoredStudy(ds), None, "grid", ["F3"], settings=composition.Settings(2.0, 50, bare=True))
    assert not bare.rings


@draws
@pytest.mark.parametrize("camera, outlined", [("front", False), ("180,0", True)])
def test_the_legend_says_what_outlines_are_where_there_are_some(fig6, camera, outlined) -> None:
    taken = layout.compose(StoredStudy(fig6), settings=composition.Settings(2.0, 50, camera=camera))
    assert ((signs.OUTLINE, "a stretch behind the cylinder") in taken.legend) == outlined


@draws
def test_the_cylinder_of_all_equilibria_has_one_size() -> None:
    from solver import equilibria
    from workbench.branches.ends_study import ends_problem
    from workbench.branches.equilibria_dataset import as_dataset

    study = load("fig7_4_end_angle")
    case = ends_problem(study)
    whole = as_dataset(study, case, equilibria(case))
    few = whole.isel(equilibrium=[1, 8, 12])
    few["energy"].values[:] = -699.8, -616.0, -9.5
    taken = layout.compose(StoredStudy(few), kind="equilibria", settings=composition.Settings(2.0, dpi=100))
    assert [view.cell.number for view in taken.scene.views][:3] == [2, 9, 13], "their ranks among all"
    words = [view.cell.caption for view in taken.scene.views][:3]  # lying rods have room for one line
    assert words == ["stable, −699.8 N cm", "unstable in 4 ways, −616.0 N cm", "unstable in 6 ways, −9.500 N cm"]
    assert faults(taken.fig, least=6.0) == []
    wide = []
    for left, top, across, high in 100 * taken.arrangement.places[:3]:
        view = taken.pixels[int(top) : int(top + high), int(left) : int(left + across)]
        end = np.flatnonzero((view.min(axis=-1) < 250).any(axis=0))[0] + 6  # only the cylinder reaches there
        wide.append(int((view[:, end].min(axis=-1) < 250).sum()))
    assert max(wide) - min(wide) <= 2
    many = StoredStudy(whole.isel(equilibrium=np.resize(np.arange(whole.sizes["equilibrium"]), 40)))
    shown = layout.compose(many, kind="equilibria", settings=layout.Settings(2.0, 50))
    assert "18 of 40 equilibria." in canvas.caption(shown.fig)


@draws
@pytest.mark.parametrize("camera", ["front", "70,0", None, "-35,20"])
def test_the_picture_has_the_scale_of_its_bar_along_the_axis(camera, helix) -> None:
    """The ends of the cylinder, which stand still whatever the side, are as far apart as the scale says."""
    taken = layout.compose(StoredStudy(helix), kind="plain", settings=composition.Settings(dpi=100, camera=camera))
    rod = body(helix, "plain")
    low, high = View([rod], Cell()).cylinder
    R, per_unit, along = rod.R, taken.arrangement.scale * 100, taken.scene.along
    seen = np.flatnonzero((taken.pixels.min(axis=-1) < 250).any(axis=0))
    wide = (high - low) * along + 2 * R * np.sqrt(1 - along**2)  # the axis lies along the page
    # a rim stands half a pixel beyond the wall, and is 1.5 pixels wide; one pixel is cut in two
    assert np.ptp(seen) + 1 == pytest.approx(wide * per_unit, abs=3.6)
    assert (taken.scene.along < 1) == (camera in (None, "-35,20"))


@draws
def test_a_push_has_the_same_colours_in_neighbouring_pictures_pale_at_0_and_no_black(helix) -> None:
    units = {"length": "cm", "force": "N"}
    paint = scene_kinds.by_push(units, (-30.0, 90.0))
    assert (paint.low, paint.high, paint.foot) == (-100.0, 100.0, -100.0)
    assert min(to_rgb(to_hex(paint.ramp(0.5)))) > 0.8
    one = scene_kinds.by_push(units, (7.9, 8.0))
    share = (8.0 - one.low) / (one.high - one.low)
    assert min(to_rgb(to_hex(one.ramp(share)))) > 0.2 or share < 0.9
    assert (one.foot, one.high) == (0.0, 12.0)


@draws
def test_in_place_of_an_unsolved_case_the_nearest_solved_one_is_drawn_and_this_is_said() -> None:
    ds = dataset(axes="[axes.E]\nfrom = 1e4\nto = 3e4\ncount = 11\n")
    words = ["solved"] * 11
    words[5] = "no solution"
    ds = small.with_outcomes(ds, words)
    taken = layout.compose(StoredStudy(ds), settings=layout.Settings(2.0, 50))
    assert "E = 20000 N/cm² is not solved; this is the nearest solved case" in taken.notes
    row = layout.compose(StoredStudy(ds), None, "grid", ["E"], settings=layout.Settings(2.0, 50))
    assert "in place of 1 unsolved case the nearest solved" in row.notes
    assert not any(view.cell.why_empty for view in row.scene.views)


@draws
def test_each_rod_of_a_row_faces_the_viewer() -> None:
    ds = dataset(axes="[axes.E]\nvalues = [1e4, 2e4, 4e4]\n")
    rows, both = layout._cells(
        StoredStudy(ds), kind_of("grid"), ["E"], [[{"E": i} for i in range(3)]], layout.Settings()
    )
    for view, camera in product(rows[0], both):
        place = view.places(view.bodies[0])
        front = np.degrees(np.angle(np.exp(1j * np.arctan2(place[:, 1], place[:, 0])).mean()))
        assert front == pytest.approx(np.degrees(np.arctan2(camera.toward[1], camera.toward[0])), abs=6)


@draws
def test_many_rods_stand_and_few_lie_where_they_fill_the_page_better_and_each_is_seen_from_one_side() -> None:
    ds = dataset(axes="[axes.E]\nfrom = 1e4\nto = 4e4\ncount = 9\n")
    settings, few = layout.Settings(2.0, 50), [StoredStudy(ds.isel(E=slice(n))) for n in (2, 6)]
    rows = [layout.compose(stored, None, "grid", ["E"], settings=settings).scene.rows for stored in few]
    assert [(len(cells), len(cells[0])) for cells in rows] == [(2, 1), (1, 6)]
    assert [view.cell.caption for view in rows[1][0]][:2] == ["10000", "13750"]  # the unit stands once, above all
    with pytest.raises(InputError, match="each rod of the kind grid is seen from one side, and --camera sides has sev"):
        layout.compose(StoredStudy(ds), None, "grid", ["E"], settings=layout.Settings(camera="sides"))


@draws
def test_a_page_is_no_larger_than_a_journal_prints_and_has_its_legend_beside_its_bars_where_there_is_room() -> None:
    axes = "[axes.E]\nfrom = 1e4\nto = 4e4\ncount = 9\n[axes.F3]\nfrom = 5\nto = 20\ncount = 9\n"
    stored, short = (StoredStudy(dataset(axes=axes, L=L)) for L in (20.0, 1.0))
    table, high_table = (
        layout.compose(rods, None, "grid", ["E", "F3"], settings=layout.Settings(2.0, 50)) for rods in (stored, short)
    )
    one, ghosts = (
        layout.compose(stored, None, kind, settings=layout.Settings(2.0, 50)) for kind in ("plain", "ghosts")
    )
    for made in (table, high_table, one, ghosts):
        wide, high = 25.4 * made.fig.get_size_inches()
        assert wide <= 183
        assert high <= 185
    for made in (table, ghosts):
        assert made.columns_beside
        assert not made.fig.legends
        middle = made.ax.get_legend().get_window_extent()
        assert middle.x1 <= made.fig.bbox.x1 + 1  # pixel
    rows = table.scene.rows
    assert sorted((len(rows), len(rows[0]))) == [5, 9]
    counts = {f"5 of 9 values of {name}." for name in ("E", "F₃")}
    assert len(counts & {*canvas.caption(table.fig)}) == 1
    assert "3 of 9 values of E." in canvas.caption(ghosts.fig)


@draws
def test_pictures_along_an_axis_have_one_size_though_their_words_differ() -> None:
    stored = StoredStudy(dataset(axes="[axes.E]\nvalues = [5e3, 123456.0]\n", L=2.0))
    settings = layout.Settings(2.0, 50)
    pages = [layout.compose(stored, {"E": E}, along="E", settings=settings) for E in (5e3, 123456.0)]
    first, last = (page.fig.get_size_inches().tolist() for page in pages)
    assert first == last
    alone = layout.compose(stored, {"E": 5e3}, settings=settings).fig.get_size_inches()
    assert alone[0] < first[0]  # no emptier than its words need


@draws
def test_a_picture_of_a_row_knows_the_places_of_its_rods(tmp_path) -> None:
    import json

    ds = dataset(axes="[axes.E]\nvalues = [1e4, 2e4, 4e4]\n")
    layout.draw(StoredStudy(ds), tmp_path / "row.png")
    with Image.open(tmp_path / "row.png") as picture:
        places = np.array(json.loads(picture.text["rods"]))
        drawn = np.asarray(picture)[..., :3].min(axis=-1) < 250
    assert places.shape == (3, 4)
    assert (places[:, :2] < places[:, 2:]).all()
    assert (places[:-1, 3] < places[1:, 1]).all()  # three rods lie one below the other
    for left, top, right, bottom in places:
        high, wide = drawn.shape
        inside = drawn[round(top * high) : round(bottom * high), round(left * wide) : round(right * wide)]
        assert inside.mean() > 0.3
        assert inside[:6].any()  # no larger than what it shows, and a narrow edge


@draws
def test_self_intersections_are_ringed_and_said_once(fig6) -> None:
    taken = layout.compose(StoredStudy(fig6), kind="plain", settings=composition.Settings(2.0, 50))
    ((left, top, wide, high),) = taken.arrangement.places
    assert len(taken.rings) >= 4
    assert all(left < x < left + wide and top < y < top + high for x, y, _ in taken.rings)
    at_rings = [taken.pixels[int(50 * y) - 1 : int(50 * y) + 2, int(50 * x)].mean() for x, y, _ in taken.rings]
    assert max(at_rings) < 130, "of 255: a rod, which is darker than the cylinder"
    assert [text for _, text in taken.legend] == ["the rod passes through itself"]
    assert "the rod passes through itself" not in taken.notes


@pytest.mark.parametrize(
    "inclination, words", [("60deg", {"s = 0, bottom", "top"}), ("120deg", {"s = 0, top", "bottom"})]
)
def test_a_pipe_that_lies_on_the_page_has_its_beginning_and_its_top_marked(inclination: str, words: set[str]) -> None:
    study = Path(__file__).parents[2] / "docs/scenes/pipe.toml"
    text = study.read_text(encoding="utf-8").replace("60deg", inclination)
    page = layout.compose(StoredStudy(in_memory.run(loads(text).at_stations(601))), settings=layout.Settings(4.0, 50))
    assert {text.get_text() for text in page.ax.texts} >= words
