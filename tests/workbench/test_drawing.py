"""The dimensioned drawing of a cable: true to scale, with the stored numbers, and dashed where the drum hides it."""

import re

import numpy as np
import pytest
import xarray as xr
from matplotlib.patches import Circle
from matplotlib.text import Text

from studies.language.loader import loads
from tests.workbench import small, study_kinds
from tests.workbench.page_faults import faults
from workbench.figures import canvas, drawing, section
from workbench.figures.drawn_numbers import CASING
from workbench.figures.sheet import MILLIMETRES, sheet
from workbench.figures.views_on_paper import HAIR
from workbench.run import in_memory
from workbench.stored.stored_study import StoredStudy

WIRE = {"E": 2e5, "nu": 0.3, "a": 1.0, "L": 1500.0, "R": 60.0, "tension": 500.0}
SEEN = {"observables": ["pitch", "height", "turns_around", "kappa_max"]}


@pytest.fixture(scope="module")
def cables() -> xr.Dataset:
    return in_memory.run(loads(small.text(WIRE, small.axis("lay", ["-75deg", "80deg"]), "mm N", **SEEN)))


@pytest.mark.parametrize("lay", [-75.0, 80.0])
def test_a_drawing_of_a_cable_is_true_to_scale_and_has_the_stored_numbers(cables, lay: float) -> None:
    one = cables.isel(lay=int(lay > 0))
    fig = drawing.figure(StoredStudy(cables), at={"lay": np.radians(lay)}, sheet=sheet("paper"))
    (ax,) = fig.axes
    texts = [text.get_text() for text in ax.texts]
    for text in ("Ø 120 mm", "Ø 2 mm", f"{float(one['pitch']):.4g} mm", f"{lay:g}°".replace("-", "−")):
        assert text in texts
    (line,) = [text for text in texts if "scale" in text]
    height = f"{float(one['height']):.4g} mm"
    assert height in texts or f"along the axis {height}" in line
    assert f"wrap {float(one['turns_around']):.4g} turns".replace("-", "−") in line
    assert f"bend radius, of the centreline: {1 / float(one['kappa_max']):.4g} mm" in " ".join(canvas.caption(fig))
    scale = 1 / float(line.split("scale\N{NO-BREAK SPACE}1:")[1])
    (x, y), (x1, y1) = ax.transData.transform([(0, -60), (float(one["height"]), 60)]) * MILLIMETRES / fig.dpi
    np.testing.assert_allclose([x1 - x, y1 - y], [float(one["height"]) * scale, 120 * scale], rtol=1e-9)


def test_a_drawing_of_one_rod_of_a_study_says_which_beside_it_and_in_its_caption(cables) -> None:
    stored = StoredStudy(cables)
    for at in ({}, {"lay": np.radians(-75)}):
        case = stored.equations(stored.place(at))
        fig = drawing.figure(stored, at=at)
        (line,) = [text.get_text() for text in fig.axes[0].texts if "scale" in text.get_text()]
        assert line.startswith(f"{case}, length")
        assert f"The rod: {case}, length" in canvas.caption(fig)[0]


def test_a_drawing_says_that_no_real_rod_could_keep_its_shape() -> None:
    said = canvas.caption(drawing.figure(StoredStudy(small.study_dataset("fig7_1_modulus"))))
    assert "No real rod could keep this shape." in said


def test_a_drawing_dashes_what_the_drum_hides_and_nothing_else(cables) -> None:
    stored = StoredStudy(cables)
    place = np.moveaxis(stored.along("position").isel(lay=1).values, -1, 0)  # x up, y towards the eye, z to the right
    (ax,) = drawing.figure(stored, at={"lay": np.radians(80)}).axes
    names = "rod, before the plane of the axis", "rod, behind the plane of the axis", "hidden edge"
    curves = [np.concatenate([line.get_xydata() for line in ax.lines if line.get_gid() == name]) for name in names]
    before, behind, hidden = (points[np.isfinite(points).all(axis=1)] for points in curves)
    for points, side in ((before, 1), (behind, -1)):
        here = side * place[1] > 1.0
        up = np.interp(place[2][here], *points[points[:, 0].argsort()].T)
        np.testing.assert_allclose(up, place[0][here], atol=0.02)  # chords of 240 points a turn
    assert (np.abs(hidden[:, 1]) < 60).all()
    assert len(hidden) > 100


@pytest.mark.parametrize("lay", [-75.0, 80.0])
def test_the_outline_of_the_rod_is_closed_at_its_start(cables, lay: float) -> None:
    fig = drawing.figure(StoredStudy(cables), at={"lay": np.radians(lay)}, sheet=sheet("paper"))
    fig.set_dpi(400)
    fig.canvas.draw()
    (ax,), across = fig.axes, np.sin(np.radians(abs(lay)))
    before = np.linspace(-1.0, 0.0, 50) * across  # radii of the section: its ellipse reaches so far
    x, y = ax.transData.transform(np.stack([before, np.full(50, 61.0)], axis=1)).round().astype(int).T
    pixels = np.asarray(fig.canvas.buffer_rgba())[::-1][y, x, :3].max(axis=1)
    assert pixels[:15].min() < 100  # the outline
    assert pixels[-15:].min() > 200  # nothing inside


def test_a_rod_that_passes_before_itself_has_its_outline_where_it_does(monkeypatch) -> None:
    def ink_between_the_ends() -> float:
        """The dark share of the box of the first part of the rod before the plane of the axis."""
        fig = drawing.figure(StoredStudy(small.study_dataset("fig6")))
        fig.canvas.draw()
        (ax,) = fig.axes
        ink = np.asarray(fig.canvas.buffer_rgba())[::-1, :, :3].sum(axis=-1) < 300
        start = next(line for line in ax.lines if line.get_gid() == "rod, before the plane of the axis")
        places = ax.transData.transform(start.get_xydata()).astype(int)
        (left, low), (right, high) = places.min(axis=0), places.max(axis=0)
        return float(ink[low:high, left:right].mean())

    own = ink_between_the_ends()
    monkeypatch.setattr(drawing, "_pieces", lambda *_: ([], []))
    assert own > 1.3 * ink_between_the_ends()


@pytest.mark.parametrize("thick", [1.0, 20.0])
def test_a_winding_that_nowhere_passes_before_itself_has_one_outline(thick: float) -> None:
    """The end of each turn is short towards the eye, and no second rod. Its hidden edge ends at the drum's outline."""
    base = {"EI": 1.0, "GJ": 1.0, "a": thick, "L": 1500.0, "R": 60.0, "tension": 1.0, "lay": "82deg"}
    stored = StoredStudy(in_memory.run(loads(small.text(base, "", "mm N", **SEEN))))
    (ax,) = drawing.figure(stored, sheet=sheet("paper", 89)).axes
    parts = [line for line in ax.lines if str(line.get_gid()).startswith("rod, ")]
    assert len([line for line in ax.lines if line.get_label() == CASING]) == len(parts)


def test_a_pipe_lies_on_the_low_side_of_the_hole_that_is_drawn() -> None:
    ds = study_kinds.well()
    fig = drawing.figure(StoredStudy(ds), at={"wob": 60.0})  # straight, on the low side
    y = np.concatenate([line.get_ydata() for line in fig.axes[0].lines if "rod" in str(line.get_gid())])
    np.testing.assert_allclose([y.min(), y.max()], [-float(ds["R"]), float(2 * ds["a"] - ds["R"])], rtol=1e-9)
    assert "A side view, seen from α = −90°, with the low side down." in canvas.caption(fig)


@pytest.mark.parametrize("lay", [-75.0, 88.0, 89.5])
def test_no_word_of_a_drawing_stands_on_a_word_or_on_an_extension_line(lay: float) -> None:
    ds = in_memory.run(loads(small.text(WIRE | {"lay": f"{lay}deg"}, "", "mm N", **SEEN)))
    fig = drawing.figure(StoredStudy(ds))
    assert faults(fig) == []
    (ax,) = fig.axes
    boxes = {text.get_text(): text.get_window_extent() for text in ax.texts if text.get_text()}
    for line in (line for line in ax.lines if line.get_label() == "_samples"):
        path = line.get_transform().transform_path(line.get_path())
        assert [
            text for text, box in boxes.items() if path.intersects_bbox(box, filled=False) and "°" not in text
        ] == []


@pytest.mark.parametrize("degrees", [89.5, 89, 85, 60])
def test_the_words_of_the_lay_cover_no_line_of_rope_and_drum(degrees: float) -> None:
    ds = in_memory.run(loads(small.text(WIRE | {"lay": f"{degrees}deg"}, "", "mm N", **SEEN)))
    (ax,) = drawing.figure(StoredStudy(ds), sheet=sheet("paper", 183.0)).axes
    (lay,) = [text for text in ax.texts if text.get_text() == f"{degrees}°"]
    box = Text.get_window_extent(lay)  # without its leader
    lines = [line for line in ax.lines if line.get_gid()]
    assert {"end of the drawn cylinder", "cylinder", "axis", "hidden edge"} < {line.get_gid() for line in lines}
    for line in lines:
        path = line.get_transform().transform_path(line.get_path())
        assert not path.intersects_bbox(box, filled=False), line.get_gid()


def test_the_line_below_a_drawing_stays_on_the_page_where_letters_have_few_pixels(cables) -> None:
    text = "length 5110 mm, wrap 3.005 turns = 1082°, azimuth of the end 1171°, on the wall at s = 0 to 3890 mm, up to "
    text += "1000 mm off it, scale 1:10"
    fig = drawing.figure(StoredStudy(cables), at={"lay": np.radians(80)})
    fig.set_dpi(80)
    (line,) = [words for words in fig.axes[0].texts if words.get_text().startswith(("lay", "length"))]
    for end in range(60, len(text)):
        line.set_text(drawing.below(text[:end], fig.get_figwidth()))
        assert line.get_window_extent().x1 < fig.bbox.x1 - 1, text[:end]


@pytest.mark.parametrize("picture", [drawing.figure, section.figure], ids=["drawing", "section"])
def test_every_number_below_0_of_a_picture_and_its_caption_has_a_minus_sign(picture, cables) -> None:
    fig = picture(StoredStudy(cables), at={"lay": np.radians(-75)})
    words = " ".join([*canvas.caption(fig), *(text.get_text() for text in fig.findobj(Text))])
    assert "−75" in words or picture is section.figure
    assert re.findall(r"(?<![\w.])-[\d.]+", words) == []


def test_a_long_pipe_is_drawn_whole_and_compressed_along_its_axis() -> None:
    stored = StoredStudy(study_kinds.well())
    fig = drawing.figure(stored)
    (ax,) = fig.axes
    (line,) = [text.get_text() for text in ax.texts if "scale" in text.get_text()]
    found = re.fullmatch(r".*1:(\d+) across, 1:(\d+) along the axis", line)
    across, along = (1 / float(each) for each in found.groups())
    assert all(float(f"{float(each):.1e}") == float(each) for each in found.groups())  # round numbers
    edges = [one.get_xydata() for one in ax.lines if str(one.get_gid()).startswith("rod")]
    assert len([fill for fill in ax.collections if fill.get_gid() == "rod"]) == 1  # no seam shows in it
    case = stored.select(stored.place({}))
    a, R, L = (float(case[name]) for name in ("a", "R", "L"))
    points = np.concatenate(edges)
    assert np.ptp(points[:, 0]) == pytest.approx(L * along / across, rel=1e-2)
    assert 2 * a * (1 - 1e-6) < np.ptp(points[:, 1]) <= 2 * R * (1 + 1e-6)


def test_a_rod_that_is_thinner_than_a_line_at_true_scale_is_drawn_in_part_or_as_a_line() -> None:
    long = in_memory.run(loads(small.text(WIRE | {"L": 150_000.0, "lay": "80deg"}, "", "mm N", **SEEN)))
    assert "A part of the rod is drawn, from s = 0." in canvas.caption(drawing.figure(StoredStudy(long)))
    thin = in_memory.run(loads(small.text(WIRE | {"a": 0.02, "tension": 1.0, "lay": "80deg"}, "", "mm N", **SEEN)))
    fig = drawing.figure(StoredStudy(thin))
    assert "The rod is thinner than its line." in canvas.caption(fig)
    widths = {line.get_linewidth() for line in fig.axes[0].lines if "rod" in str(line.get_gid())}
    assert [*widths] == pytest.approx([HAIR / MILLIMETRES * 72])


FREE = {"contact": "unilateral", "beta0": "90deg", "betaL": "90deg", "height": 0.0, "azimuth": "200deg", "M2L": 0.0}
HELD = FREE | {"EI": 2e6, "GJ": 1.6e6, "a": 6.0, "L": 1616.0, "R": 200.0, "radiusL": 1200.0}
CENTRED = {"EI": 1228.0, "GJ": 945.0, "a": 0.0635, "L": 100.0, "weight": 0.242, "R": 0.10795, "side": "inside",
           "inclination": "90deg", "contact": "unilateral", "radius0": 0.0, "radiusL": 0.0, "beta0": 0.0, "betaL": 0.0,
           "FZ": -200.0}  # fmt: skip


def off_the_wall(base: dict[str, object], units: str) -> StoredStudy:
    pytest.importorskip("unopy", reason="the extra contact is not installed")
    return StoredStudy(in_memory.run(loads(small.text(base, "", units, observables=["gap_max"]))))


def test_a_cable_whose_end_is_held_off_its_drum_has_a_side_view_and_an_end_view_at_one_standard_scale() -> None:
    stored = off_the_wall(HELD, "mm N")
    fig = drawing.figure(stored)
    (ax,) = fig.axes
    texts, free = [text.get_text() for text in ax.texts], stored.at()
    ((at, _),) = free.point_forces
    for text in ("Ø 400 mm", "Ø 12 mm", "1200 mm", "79 N\ns = 317 mm"):
        assert text in texts
    (line,) = [text for text in texts if "scale" in text]
    assert "on the wall at s = 0 to 317 mm, up to 994 mm off it" in line
    hoop = float(stored["rho"])  # this rod lies on its drum across the axis: a circle
    turned = float(line.split("wrap ")[1].split("°")[0])  # in the digits that its error allows
    assert turned == pytest.approx(np.degrees(at / hoop), abs=0.5)
    assert "azimuth of the end 200°" in line
    scale = 1 / float(line.split()[-1].removeprefix("1:"))
    assert np.log10(scale) % 1 == pytest.approx(0, abs=1e-9) or f"{scale:e}"[0] in "25"
    (drum,) = [patch for patch in ax.patches if isinstance(patch, Circle)]
    rods = [line for line in ax.lines if line.get_gid() == "rod, along the axis"]
    seen = rods[0].get_xydata() - drum.center
    np.testing.assert_allclose(seen[[0, -1]], free.position[[0, -1]][:, [1, 0]], atol=1e-6)  # x up, y to the right
    pixels = ax.transData.transform([drum.center, drum.center + np.array([200.0, 0.0])])
    assert np.ptp(pixels[:, 0]) * MILLIMETRES / fig.dpi == pytest.approx(200 * scale, rel=1e-9)


@pytest.mark.parametrize("base, units", [(HELD, "mm N"), (HELD | {"height": 200.0, "L": 1700.0}, "mm N"),
                                         (CENTRED, "m kN"), (HELD | {"a": 0.05}, "mm N")])  # fmt: skip
@pytest.mark.parametrize("width", [None, 183.0, 89.0])
def test_a_rod_of_any_extent_off_the_wall_is_drawn_without_a_word_on_another(base, units: str, width) -> None:
    fig = drawing.figure(off_the_wall(base, units), sheet=sheet("paper" if width else "screen", width))
    assert faults(fig) == []
    (ax,) = fig.axes
    low, high = ax.get_xlim()
    for line in ax.lines:
        x = np.asarray(line.get_xdata(), dtype=float)
        assert (x[np.isfinite(x)] > low).all()
        assert (x[np.isfinite(x)] < high).all()


@pytest.mark.parametrize("width", [70.0, 89.0])
def test_a_drawing_names_what_has_no_room_and_the_width_at_which_it_is_drawn(width: float, monkeypatch) -> None:
    monkeypatch.setattr(drawing, "MOST_BELOW", 0)  # as of more point forces than have room below
    stored = off_the_wall(HELD, "mm N")
    wanted = {"1200 mm", "79 N\ns = 317 mm"}

    def drawn(mm: float) -> tuple[set[str], list[str]]:
        fig = drawing.figure(stored, sheet=sheet("paper", mm))
        left_out = [text for text in canvas.caption(fig) if text.startswith(canvas.NOT_DRAWN)]
        return wanted & {text.get_text() for text in fig.axes[0].texts}, left_out

    texts, (left_out,) = drawn(width)
    assert ("the distance 1200 mm" in left_out) == ("1200 mm" not in texts)
    assert "point forces" in left_out
    enough = float(left_out.split("--width ")[1].split(" has room")[0])
    assert drawn(enough) == (wanted, [])
    assert drawn(enough - 5.0)[1]


@pytest.mark.parametrize("width, is_below", [(89.0, True), (183.0, False)])
def test_the_number_of_a_point_force_stands_at_its_arrow_or_below_the_views(width: float, is_below: bool) -> None:
    fig = drawing.figure(off_the_wall(HELD, "mm N"), sheet=sheet("paper", width))
    texts = [" ".join(text.get_text().split()) for text in fig.axes[0].texts]
    assert ("79 N s = 317 mm" in texts) == (not is_below)
    assert any("point forces of the wall: 79 N at 317 mm" in text for text in texts) == is_below
    assert sum("point forces of the wall" in sentence.lower() for sentence in canvas.caption(fig)) == 1


@pytest.mark.parametrize("width", [89.0, 183.0])
def test_the_arrow_of_a_point_force_begins_outside_the_drum_and_no_tick_prolongs_it(width: float) -> None:
    (ax,) = drawing.figure(off_the_wall(HELD, "mm N"), sheet=sheet("paper", width)).axes
    (drum,) = [patch for patch in ax.patches if isinstance(patch, Circle)]
    arrows = [text for text in ax.texts if getattr(text, "arrow_patch", None) and not text.get_text()]
    forces = [arrow for arrow in arrows if arrow.arrow_patch.get_linewidth() >= 1]
    assert len(forces) == 1
    assert np.linalg.norm(np.subtract(forces[0].xyann, drum.center)) > drum.radius
    assert not [line for line in ax.lines if line.get_gid() == "contact"]
