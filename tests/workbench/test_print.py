"""Pictures for print: diagrams as vectors with their letters, scenes and diagrams at a number of dots an inch."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from PIL import Image

from studies import load
from studies.loader import loads
from tests.workbench import small
from workbench.branches.equilibria import ends_problem
from workbench.branches.equilibria_dataset import dataset_of
from workbench.commands import plot
from workbench.data import writing
from workbench.figures import canvas, study_figure
from workbench.figures import equilibria as equilibria_figure
from workbench.run import in_memory
from workbench.scene import opengl

draws = pytest.mark.skipif(not opengl.probe()[0], reason=opengl.probe()[1])


@pytest.fixture(scope="module")
def ds() -> xr.Dataset:
    axes = "[axes.E]\nvalues = [1e4, 2e4]\n"
    return in_memory.run(loads(small.HEAD.replace("[units]", 'observables = ["wraps"]\n[units]') + axes))


def equilibria(path: Path) -> None:
    study = load("fig6")
    case = ends_problem(study)
    from solver import equilibria as every

    canvas.save(equilibria_figure.figure(dataset_of(study, case, every(case)[:2])), path)


@pytest.mark.parametrize("name", ["plot", "equilibria"])
def test_a_diagram_for_print_is_vectors_with_its_letters_inside(ds, tmp_path, name: str) -> None:
    for kind in ("pdf", "svg"):
        path = tmp_path / f"one.{kind}"
        canvas.save(study_figure.figure(ds), path) if name == "plot" else equilibria(path)
        said = path.read_bytes()
        assert b"/Subtype /Image" not in said
        assert b"<image" not in said
        if kind == "pdf":
            assert b"/FontFile2" in said  # TrueType, embedded
            assert b"/Type3" not in said  # which printers and editors refuse
        else:
            assert b"<text" not in said  # outlines: no font is needed where it is opened
            assert said.count(b"<path") > 20


def test_the_dots_an_inch_of_a_plot_change_its_pixels_and_not_its_inches(ds, tmp_path) -> None:
    file = writing.write(ds, tmp_path / "one.h5")
    sizes = {}
    for dpi in (100, 300):
        plot.plot(file, tmp_path / f"{dpi}.png", dpi=dpi)
        with Image.open(tmp_path / f"{dpi}.png") as picture:
            assert picture.info["dpi"] == pytest.approx((dpi, dpi), abs=0.1)  # stored in dots a metre
            sizes[dpi] = np.array(picture.size) / dpi
    np.testing.assert_allclose(sizes[100], sizes[300], atol=0.01)  # a pixel of the coarser


@draws
def test_a_scene_has_the_same_page_at_any_dots_an_inch(ds, tmp_path) -> None:
    from workbench.scene import composition, layout

    pages = []
    for dpi in (50, 75, 110):
        path = tmp_path / f"{dpi}.png"
        layout.render(ds, path, kind="plain", settings=composition.Settings(1.0, dpi))
        with Image.open(path) as picture:
            assert picture.size == (8 * dpi, 6 * dpi)
            assert picture.info["dpi"] == pytest.approx((dpi, dpi), abs=0.1)
            pages.append(np.asarray(picture.convert("L").resize((200, 150), Image.Resampling.BOX), dtype=float))
    # the same picture, but for edges that fall elsewhere between pixels
    assert (np.abs(pages[0] - pages[2]) > 40).mean() < 0.03


@draws
def test_a_picture_too_large_to_be_rendered_twice_as_fine_is_the_same_picture(ds) -> None:
    from workbench.scene import composition, layout, rendering

    taken = []
    for most in (rendering.MOST_PIXELS, 1):
        settings = composition.Settings(1.0, 60, most_pixels=most)
        taken.append(layout.compose(ds, kind="plain", settings=settings).page.pixels.astype(float))
    assert taken[0].shape == taken[1].shape
    assert not np.array_equal(taken[0], taken[1])
    assert (np.abs(taken[0] - taken[1]).max(axis=-1) > 60).mean() < 0.06  # edges are rough where nothing is averaged


def test_the_pages_of_a_pdf_are_as_wide_as_the_pictures(ds, tmp_path) -> None:
    canvas.save(study_figure.figure(ds), tmp_path / "one.pdf")
    box = re.search(rb"/MediaBox \[ ?0 0 ([0-9.]+) ([0-9.]+) ?\]", (tmp_path / "one.pdf").read_bytes())
    assert box is not None
    assert float(box[1]) == pytest.approx(72 * study_figure.WIDTH, abs=0.5)  # points
