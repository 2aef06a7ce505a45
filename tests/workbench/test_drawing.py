"""The dimensioned drawing of a cable: true to scale, with the stored numbers, and dashed where the drum hides it."""

import re

import numpy as np
import pytest
import xarray as xr
from matplotlib.text import Text

from solver import InputError
from studies.language.loader import loads
from tests.workbench import small, study_kinds
from tests.workbench.page_faults import faults
from workbench.figures import canvas, drawing, section
from workbench.figures.sheet import MILLIMETRES, sheet
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
    scale = 1 / float(line.split("scale 1:")[1])
    (x, y), (x1, y1) = ax.transData.transform([(0, -60), (float(one["height"]), 60)]) * MILLIMETRES / fig.dpi
    np.testing.assert_allclose([x1 - x, y1 - y], [float(one["height"]) * scale, 120 * scale], rtol=1e-9)


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


def test_a_pipe_lies_on_the_low_side_of_the_hole_that_is_drawn() -> None:
    ds = study_kinds.well()
    fig = drawing.figure(StoredStudy(ds), at={"wob": 60.0})  # straight, on the low side
    y = np.concatenate([line.get_ydata() for line in fig.axes[0].lines if "rod" in str(line.get_gid())])
    np.testing.assert_allclose(y, float(ds["a"] - ds["R"]), rtol=1e-9)
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


@pytest.mark.parametrize("picture", [drawing.figure, section.figure], ids=["drawing", "section"])
def test_every_number_below_0_of_a_picture_and_its_caption_has_a_minus_sign(picture, cables) -> None:
    fig = picture(StoredStudy(cables), at={"lay": np.radians(-75)})
    words = " ".join([*canvas.caption(fig), *(text.get_text() for text in fig.findobj(Text))])
    assert "−75" in words or picture is section.figure
    assert re.findall(r"(?<![\w.])-[\d.]+", words) == []


def test_a_pipe_that_is_thinner_than_a_line_at_true_scale_is_refused_or_drawn_in_part() -> None:
    fig = drawing.figure(StoredStudy(study_kinds.well()))
    assert "A part of the rod is drawn, from s = 0." in canvas.caption(fig)
    thin = in_memory.run(loads(small.text(WIRE | {"a": 0.02, "tension": 1.0, "lay": "80deg"}, "", "mm N", **SEEN)))
    with pytest.raises(InputError, match=r"at 1:2, at which 120\.1 mm across the axis .* choose --kind curves"):
        drawing.figure(StoredStudy(thin))
