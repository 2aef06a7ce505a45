"""The script of the pictures of scenes, and the two pictures at the top of the README."""

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from docs import scene_pictures
from tests.workbench.pictures import draws, pixels, share_of_ink, shares_of_push
from workbench.scene import film
from workbench.stored.stored_study import StoredStudy
from workbench.words import caution_words

ROOT = Path(__file__).resolve().parents[2]
WIDE_HIGH = (860, 600)  # pixels of the animated picture
LARGEST = 2_000_000  # bytes of an animated picture in a README
SCENES = "dna", "let_go", "loops_scene"  # of docs/figures


def hero() -> StoredStudy:
    """The cases of the animated picture."""
    return scene_pictures._datasets()["hero_sweep"]()


def is_animated_as_promised(path: Path) -> None:
    assert path.stat().st_size < LARGEST
    with Image.open(path) as picture:
        assert picture.n_frames == 120
        assert picture.size == WIDE_HIGH
        assert picture.info["loop"] == 0  # without end


def test_the_readme_opens_with_both_pictures_which_exist_and_are_told_in_words() -> None:
    opening = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n## ")[0]
    shown = re.findall(r'<img src="([^"]+)" width="410" alt="([^"]{40,})">', opening)
    assert [Path(file).stem for file, _ in shown] == ["hero_page", "hero_sweep"]
    page, animated = (ROOT / file for file, _ in shown)
    is_animated_as_promised(animated)
    with Image.open(page) as picture:
        assert picture.size == (
            scene_pictures.RATIO * scene_pictures.SIZE[0],
            scene_pictures.RATIO * scene_pictures.SIZE[1],
        )
        assert picture.width / picture.height == pytest.approx(WIDE_HIGH[0] / WIDE_HIGH[1], rel=0.002)  # side by side


PAGES = [*(ROOT / "docs" / "scenes").glob("*.png"), *(ROOT / f"docs/figures/{name}.png" for name in SCENES)]


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_a_scene_of_the_documentation_is_one_that_a_journal_prints(path: Path) -> None:
    with Image.open(path) as picture:
        wide, high = (25.4 * side / dots for side, dots in zip(picture.size, picture.info["dpi"], strict=True))
    assert wide <= 183.1  # mm; a file keeps whole dots per metre
    assert high <= 185.1


def test_the_rod_of_the_readme_is_one_that_can_be_and_slows_down_where_its_loop_begins_again() -> None:
    ds = hero()
    assert ds["solved"].all()
    # pressed on everywhere, and nothing else is wrong: rubber may be strained by 30 %
    assert {*np.vectorize(lambda text: ", ".join(caution_words.keys(text)))(ds["caution"].values)} == {"strained"}
    assert ds.sizes["F3"] == 61  # there and back without the two ends twice: 120 frames
    steps = np.diff(scene_pictures.FORCES)
    np.testing.assert_allclose(steps, steps[::-1], rtol=1e-9)
    assert abs(steps[0]) < 0.1 * np.abs(steps).max()


@draws
def test_the_frames_have_one_camera_one_scale_and_a_value_that_changes() -> None:
    shown = film.Film("F3", {}, settings=scene_pictures.HERO)
    first, last = (frame.astype(float) / 255 for frame in film.frames(hero().select({"F3": [0, -1]}), shown))
    top, foot = round(160 * film.TOP), round(160 * film.FOOT)
    np.testing.assert_array_equal(first[-foot:], last[-foot:])  # the scale of colours
    assert np.abs(first[:48] - last[:48]).max() > 0.5  # the value
    views = [frame[top:-foot] for frame in (first, last)]
    walls = [(view.min(axis=-1) < 0.9).any(axis=0).nonzero()[0][[0, -1]] for view in views]
    np.testing.assert_array_equal(*walls)  # the ends of the cylinder stay
    for view in views:
        assert (view[[0, -1]] > 0.98).all()  # no rod is cut off
        assert (view[..., 2] - view[..., 0] > 0.05).mean() > 0.02  # blue, where the cylinder pushes
    assert np.abs(views[0] - views[1]).max() > 0.5


@draws
@pytest.mark.slow
def test_the_script_makes_both_pictures_of_the_readme(tmp_path) -> None:
    out = tmp_path / "shown"
    scene_pictures.main(str(out), "hero_sweep")
    is_animated_as_promised(out / "hero_sweep.webp")
    if scene_pictures.browser() is None:
        pytest.skip("there is no Chromium here: apt-get install chromium")
    scene_pictures.main(str(out), "hero_page")
    shown = pixels(out / "hero_page.png")
    wide, high = (round(scene_pictures.RATIO * side) for side in scene_pictures.SIZE)
    assert shown.shape[:2] == (high, wide)
    rod, diagrams = shown[:, : int(0.31 * wide)], shown[:, int(0.31 * wide) :]
    for half in (diagrams[: high // 2], diagrams[high // 2 :]):
        assert share_of_ink(half) > 0.02
    assert min(shares_of_push(rod)) > 0.01
    # drawn at rest: next to no pixels of the rod come in blocks of the same colour
    orange = rod[..., 0] - rod[..., 2] > 0.4
    pairs = orange[:, :-1] & orange[:, 1:]
    same = (rod[:, :-1] == rod[:, 1:]).all(axis=-1) & pairs
    assert same.sum() / pairs.sum() < 0.5
    assert {path.name for path in out.iterdir()} == {"hero_sweep.webp", "hero_page.png"}
