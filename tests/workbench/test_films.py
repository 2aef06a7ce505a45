"""Films along an axis: what each frame shows, and what is refused before anything is drawn."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from solver.problem.errors import InputError
from studies.language.loader import dumps, loads
from tests.workbench import small
from tests.workbench.command import exit_status
from tests.workbench.pictures import draws
from workbench.commands import console, scene_film, study_scene
from workbench.commands.draw_scene import scene
from workbench.commands.present import result_of_files
from workbench.commands.scene_options import SceneOptions
from workbench.figures import canvas, colours
from workbench.geometry.centreline import TooFewStations
from workbench.run import in_memory, writing
from workbench.scene import film, opengl, page, scene_kinds, signs
from workbench.scene.settings import Settings
from workbench.stored.stored_study import StoredStudy

DPI, SIZE = 50, (320, 212)  # of a scene in a frame
AXIS = "[axes.E]\nvalues = [1e4, 2e4, 3e4]\n"


@pytest.fixture(scope="module")
def ds() -> xr.Dataset:
    return in_memory.run(small.study(AXIS, 'observables = ["turns_around", "height"]'))


def plain_film() -> film.Film:
    return film.Film("E", {}, "height", "plain", Settings(1.0, DPI))


@pytest.fixture(scope="module")
def made(ds) -> list[np.ndarray]:
    return list(film.frames(StoredStudy(ds), plain_film()))


@draws
def test_the_cylinder_stands_still_the_rod_moves_and_the_curve_grows_to_the_right(ds, made) -> None:
    assert len({frame.shape for frame in made}) == 1
    top, foot = round((film.SIZE[1] - film.TOP - 0.3) * DPI), round((film.FOOT + film.DIAGRAM[1] + 0.2) * DPI)
    rods = [frame[-top:-foot] for frame in made]
    walls = [np.flatnonzero((rod.min(axis=-1) < 230).any(axis=0))[[0, -1]] for rod in rods]
    assert np.ptp(walls, axis=0).max() <= 1
    assert (np.abs(rods[0].astype(int) - rods[2]).max(axis=-1) > 24).mean() > 0.02
    head = made[0][: round((canvas.MARGIN + 0.3) * DPI), made[0].shape[1] // 2 :]
    assert (head.min(axis=-1) < 200).any()  # the name of the axis
    curves = [frame[-foot:] for frame in made]
    grown = [np.abs(curve.astype(int) - curves[0]).max(axis=(0, -1)) > 60 for curve in curves[1:]]
    ends = [np.flatnonzero(columns).max() for columns in grown]
    assert ends[0] + 20 < ends[1]


@draws
def test_a_case_without_a_shape_is_a_frame_that_says_so(ds, made) -> None:
    lost = small.with_outcomes(ds, ["solved", "no solution", "solved"]).assign(height=("E", [1.0, np.nan, 2.0]))
    frames = list(film.frames(StoredStudy(lost), plain_film()))
    assert {frame.shape for frame in frames} == {made[0].shape}
    top, foot = round((film.SIZE[1] - film.TOP - 0.3) * DPI), round((film.FOOT + film.DIAGRAM[1] + 0.2) * DPI)
    assert (frames[1][-top:-foot].max(axis=-1) < 250).mean() < 0.02  # a few letters


@pytest.mark.parametrize("observable, words", [("amplitude", "[°]"), ("bend", "bend")])
def test_the_curve_of_an_angle_is_in_degrees_and_that_of_an_expression_has_its_name(observable, words) -> None:
    ds = in_memory.run(small.study(f'{AXIS}[expressions]\nbend = "kappa_max * a"\n', 'observables = ["amplitude"]'))
    axes = Figure().subplots()
    film._draw_diagram(axes, StoredStudy(ds), film.Film("E", {}, observable))
    values = np.degrees(ds["amplitude"]) if observable == "amplitude" else ds["bend"]
    np.testing.assert_allclose(axes.lines[0].get_ydata(), values)
    assert words in axes.get_title(loc="left").lower()
    for k, at in enumerate(ds["E"].values):
        (dot,) = film._grow(axes, float(at))
        assert dot.get_xydata().tolist() == [[at, values[k]]]
        clip = axes.lines[0].get_clip_box() or axes.lines[0].get_clip_path()
        assert clip is not None
        dot.remove()


def diagram_beside_the_rod() -> tuple[Figure, StoredStudy, film.Film]:
    """The diagram of a film, whose axis and observable have long names."""
    ds = in_memory.run(small.study(AXIS, 'observables = ["F3_size_max"]'))
    ds["E"] = ds["E"].assign_attrs(long_name="distance of the far end from the axis of the cylinder")
    stored, shown = StoredStudy(ds), film.Film("E", {}, "F3_size_max")
    fig = Figure(figsize=film.SIZE)
    film._draw_diagram(fig.add_axes((5.45 / 8, 0.2, 2.35 / 8, 0.6)), stored, shown)
    return fig, stored, shown


def test_no_word_of_a_diagram_beside_the_rod_passes_the_edge_of_its_frame() -> None:
    fig = diagram_beside_the_rod()[0]
    fig.canvas.draw()
    texts = [text for text in fig.findobj(Text) if text.get_text() and text.get_visible()]
    assert max(text.get_window_extent().x1 for text in texts) <= fig.bbox.x1


def test_the_curve_of_a_film_stands_out_from_a_dark_background() -> None:
    fig = diagram_beside_the_rod()[0]
    page.recolour(fig, Settings(background="#102030").look)
    weights = [0.2126, 0.7152, 0.0722]
    behind, curve = (
        float(colours.linear(to_hex(shade)) @ weights) for shade in ("#102030", fig.axes[0].lines[0].get_color())
    )
    assert (curve + 0.05) / (behind + 0.05) > 4.5


def test_the_head_of_a_frame_says_the_value_of_its_case_in_four_digits() -> None:
    fig, stored, shown = diagram_beside_the_rod()
    stored = StoredStudy(stored.ds.assign_coords(E=("E", [1183.0, 1190.0, 1200.0], stored["E"].attrs)))
    fig = Figure(figsize=film.SIZE)
    fig.add_axes((0, 0, 1, 1))
    words = [artist.get_text() for artist in film._draw_case(fig, shown, stored, 0) if isinstance(artist, Text)]
    assert any("1183" in text for text in words)


def test_both_kinds_of_film_are_read_by_others_with_a_frame_a_case(tmp_path) -> None:
    iio = pytest.importorskip("imageio.v2")
    pytest.importorskip("imageio_ffmpeg")
    shades = [np.full((120, 160, 3), shade, dtype=np.uint8) for shade in (40, 120, 200)]
    paths = [tmp_path / "film.mp4", tmp_path / "film.gif"]
    film.write(paths, iter(shades), fps=2.0, each=2)
    with iio.get_reader(paths[0]) as mp4:
        seen = [frame.mean() for frame in mp4]
    # colours are rounded in MP4; the first and the last are held for half a second more
    np.testing.assert_allclose(seen, [40, 40, 40, 120, 120, 200, 200, 200], atol=4)
    with Image.open(paths[1]) as gif:
        assert (gif.size, gif.info["duration"], gif.info["loop"]) == ((160, 120), 1500, 0)  # three equal ones
    assert sorted(path.name for path in tmp_path.iterdir()) == ["film.gif", "film.mp4"]


def test_a_film_that_cannot_be_drawn_leaves_nothing(tmp_path) -> None:
    pytest.importorskip("imageio_ffmpeg")

    def broken():
        yield np.zeros((120, 160, 3), dtype=np.uint8)
        raise InputError("the second frame fails")

    with pytest.raises(InputError, match="the second frame"):
        film.write([tmp_path / "film.mp4", tmp_path / "film.gif"], broken(), fps=2.0)
    assert list(tmp_path.iterdir()) == []


def test_scene_makes_a_film(monkeypatch) -> None:
    asked = []
    monkeypatch.setattr(scene_film, "film_of", lambda *given: asked.append(given) or result_of_files([]))
    film_options = ["--show", "bends", "--fps", "12", "--stored", "--frames", "9"]
    look = ["--theme", "dark", "--background", "navy", "--color", "gold"]
    for way in ("--along", "--axis"):
        assert exit_status("scene", "a.h5", way, "E", "--out", "E.mp4", "--dpi", "90", *film_options, *look) == 0
        axes = {way[2:]: "E" if way == "--along" else ["E"]}
        film_of = {"show": "bends", "fps": 12.0, "stored": True, "frames": 9, "dpi": 90}
        film_of |= {"theme": "dark", "background": "navy", "color": "gold"}
        assert asked.pop() == (Path("a.h5"), out := Path("E.mp4"), SceneOptions(**axes, **film_of, out=out))
        assert exit_status("scene", "a.h5", way, "E", "--out", "E.png", *film_options) == 2, "it would be ignored"
    assert exit_status("scene", "a.h5", "--out", "E.mp4", "--axis", "E", "--along", "R") == 2, "it would be ignored"


@draws
def test_a_film_of_a_study_needs_no_file(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(scene_film, "MOST", 6)  # frames
    base = small.SHORT | {"beta": 0.5, "dbeta": 0.5, "M3": 0.0}
    Path("two.toml").write_text(small.text(base, small.axis("F3", [1.0, 2.0]), observables=["bends"]))
    assert exit_status("scene", "two.toml", "-o", "two.gif", "--dpi", "50", "--pixel-error", "5") == 0
    assert Path("two.gif").stat().st_size > 0


@draws
def test_a_film_runs_along_the_one_axis_that_has_no_value(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    writing.write(small.six(), "grid.h5")
    asked = []
    monkeypatch.setattr(film, "write", lambda *given, **how: None)
    monkeypatch.setattr(film, "frames", lambda stored, shown, *how: asked.append(shown))
    at = f"R={float(small.six()['R'][0])}"
    assert exit_status("scene", "grid.h5", "-o", "E.gif", "--at", at, "--stored") == 0
    assert asked[0].axis == "E"
    assert exit_status("scene", "grid.h5", "-o", "E.gif", "--stored") == 2, "two axes"
    both = ["--at", f"E={float(small.six()['E'][0])}"]
    assert exit_status("scene", "grid.h5", "-o", "E.gif", "--at", at, *both, "--stored") == 2, "none"


def test_the_curve_is_that_of_the_axiss_law_where_none_is_asked_for(ds) -> None:
    grid = small.six()
    assert film.observable_of(StoredStudy(grid), "R", None) == "kappa_max"  # of its law
    assert film.observable_of(StoredStudy(grid), "E", None) in ("bends", "turns_around", "kappa_max")
    assert film.observable_of(StoredStudy(ds), "E", "height") == "height"


def test_what_is_missing_is_said_before_anything_is_drawn(ds, tmp_path, monkeypatch) -> None:
    writing.write(ds, tmp_path / "one.h5")

    def made(name: str) -> int:
        return scene(tmp_path / "one.h5", out=tmp_path / name, fps=3.0, dpi=DPI)

    monkeypatch.setattr(film, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"imageio-ffmpeg, which is not installed.*\.gif and \.webp do not"):
        made("film.mp4")
    said = []
    monkeypatch.setattr(opengl, "probe", lambda: (False, "no OpenGL here"))
    monkeypatch.setattr(console.err(), "print", lambda text, **_: said.append(text))
    assert made("film.gif") == 1
    assert said == ["workbench: no OpenGL here"]
    assert [path.name for path in tmp_path.iterdir()] == ["one.h5"]


def test_a_gif_has_no_bands_where_a_colour_changes_smoothly(tmp_path) -> None:
    iio = pytest.importorskip("imageio.v2")
    across, down = np.meshgrid(np.linspace(0, 1, 320), np.linspace(0, 1, 200))
    frame = np.stack([255 * across, 120 + 60 * down, 255 * (1 - across) * down], axis=-1).astype(np.uint8)
    film.write([tmp_path / "film.gif"], iter([frame]), fps=1.0)
    with iio.get_reader(tmp_path / "film.gif") as gif:
        seen = next(iter(gif))[..., :3].astype(float)
    # means over areas of 10 x 10 pixels; without dots one is off by 8
    blocks = (seen - frame).reshape(20, 10, 32, 10, 3).mean(axis=(1, 3))
    assert np.abs(blocks).max() < 5


@draws
def test_the_scale_of_all_frames_is_one_whatever_their_legends_say() -> None:
    from workbench.scene import composition, layout

    ds = in_memory.run(loads(small.HEAD + "[axes.E]\nvalues = [5e3, 2e4]\n", default_name="soft"))
    settings = composition.Settings(2.0, DPI, size=(300, SIZE[1]))  # of two legends one has two lines

    def page(E: float, along: str | None) -> Any:
        return layout.compose(StoredStudy(ds), {"E": E}, "plain", (), along, settings)

    alone = [page(E, None) for E in (5e3, 2e4)]
    assert alone[0].legend != alone[1].legend  # only the soft rod passes through itself in sight
    made = [page(E, "E") for E in (5e3, 2e4)]
    assert made[0].arrangement.scale == made[1].arrangement.scale
    assert made[0].arrangement.size == made[1].arrangement.size
    assert made[0].place == made[1].place  # so the views stand at one place of the page
    assert made[0].legend == made[1].legend == [*alone[0].legend, *alone[1].legend]


@draws
def test_a_film_has_as_many_frames_as_its_change_needs(tmp_path, capsys) -> None:
    study = loads(small.HEAD + "[axes.E]\nvalues = [1e4, 2e4]\n", default_name="soft")
    ds = in_memory.run(study)
    more = study_scene.film_cases(StoredStudy(ds), "E", {}, scene_kinds.kind_of("plain"), "height", 200)
    assert more is not None
    assert 72 <= more.sizes["E"] <= 200
    assert more["E"].attrs["spacing"] == "linear"  # as the axis, wherever its rods move
    moves = more.moves("E")
    assert moves.max() < 4 * np.median(moves)  # at an even pace
    near = ds.assign_coords(E=[1e4, 1.001e4])
    few = study_scene.film_cases(StoredStudy(near), "E", {}, scene_kinds.kind_of("plain"), "height", 200)
    assert few is not None
    assert few.sizes["E"] == 72  # three seconds
    assert (
        study_scene.film_cases(
            StoredStudy(ds.assign_attrs(study="")), "E", {}, scene_kinds.kind_of("plain"), "height", 200
        )
        is None
    )


@draws
def test_the_frames_of_a_film_may_be_pictures_and_its_curve_an_observable_that_the_file_does_not_store(
    ds, tmp_path, capsys
) -> None:
    writing.write(ds, tmp_path / "one.h5")
    asked = ["scene", tmp_path / "one.h5", "--dpi", "50", "--kind", "plain", "--show", "bends"]
    assert exit_status(*asked, "--frames", "4", "-o", tmp_path / "g_{:03d}.png") == 0
    names = [f"g_{i:03d}.png" for i in range(4)]
    assert sorted(path.name for path in tmp_path.iterdir()) == [*names, "one.h5"]
    first, *_, last = (np.asarray(Image.open(tmp_path / name), dtype=float) for name in names)
    assert first.shape == last.shape == (226, 400, 3)
    assert np.abs(first - last).max() > 100
    capsys.readouterr()
    for refused, words in (
        (["--frames", "4", "-o", tmp_path / "g_{:03d}.png"], "g_000.png exists"),
        (["--frames", "4", "-o", tmp_path / "h_{:03d}.png", "--fps", "9"], "leave out --transparent and --fps"),
        (["-o", tmp_path / "h_{:03d}.png"], "--frames with a picture for each"),
        (["--stored", "-o", tmp_path / "no.gif"], "bends is not stored"),
    ):
        assert exit_status(*asked, *refused) == 2
        assert words in " ".join(capsys.readouterr().err.split())


def test_the_curve_is_one_that_changes_along_the_axis(ds) -> None:
    stored = StoredStudy(ds.assign(turns_around=("E", [1.0, 1.0, 1.0])))
    assert film.observable_of(stored, "E") == "height"
    assert film.observable_of(stored, "E", "turns_around") == "turns_around"  # which was asked for


def test_a_frame_of_samples_names_the_fields_that_change() -> None:
    sample = "[sample]\nsize = 4\nseed = 1\n[sample.E]\nfrom = 1e4\nto = 2e4\n"
    stored = StoredStudy(in_memory.run(small.study(sample, 'observables = ["height"]')))
    fig = Figure()
    fig.add_axes((0.0, 0.0, 1.0, 1.0))
    list(film._draw_case(fig, film.Film("sample", {}), stored, 1))
    words = [text.get_text() for text in fig.axes[0].texts]
    assert words == ["sample = 1", stored.equations({"E": 1})]
    assert words[1].startswith("E = ")


@draws
@pytest.mark.parametrize("stored", [[], ["--stored"]])
def test_a_film_has_exactly_as_many_frames_as_asked_for(ds, tmp_path, stored, capsys) -> None:
    path, count = tmp_path / "film.gif", 2 if stored else 5
    writing.write(ds, tmp_path / "one.h5")
    asked = ["scene", tmp_path / "one.h5", "-o", path, "--dpi", "50", "--kind", "plain", *stored, "--frames"]
    assert exit_status(*asked, count) == 0
    with Image.open(path) as gif:
        lasts = [gif.seek(k) or gif.info["duration"] for k in range(gif.n_frames)]
    assert lasts == [40] * count  # none stays longer
    assert exit_status(*asked, 1, "--force") == 2
    assert "--frames must be between 2 and 2000, got 1" in capsys.readouterr().err
    if stored:
        assert exit_status(*asked, 60, "--force") == 2
        assert "E has 3 stored values, and no cases are solved between them" in capsys.readouterr().err


@draws
def test_a_film_takes_the_options_of_a_still_but_two_views_and_a_transparent_background(ds, tmp_path, capsys) -> None:
    writing.write(ds, tmp_path / "one.h5")

    def last(*options: str) -> np.ndarray:
        path = tmp_path / "film.webp"
        asked = ["scene", tmp_path / "one.h5", "-o", path, "--stored", "--kind", "plain", "--pixel-error", "5"]
        assert exit_status(*asked, "--force", "--size", "500x400", "--dpi", "60", *options) == 0
        with Image.open(path) as film:
            film.seek(film.n_frames - 1)
            return np.asarray(film.convert("RGB"), dtype=float)

    usual, end, part, bare = (
        last(*each) for each in ([], ["--camera", "end"], ["--from", "1", "--to", "2"], ["--bare"])
    )
    assert usual.shape == end.shape == (400, 500, 3)
    for other in (end, part, bare):
        assert np.abs(usual - other).max() > 100
    assert (bare[:20] > 250).all()  # no title
    for refused, words in (
        (["--camera", "sides"], "a film is seen from one side"),
        (["--transparent"], "only a .png can have a transparent background"),
        (["--size", "200x200"], "--size 200x200 leaves no room for the views"),
    ):
        asked = ["scene", tmp_path / "one.h5", "-o", tmp_path / "no.webp", "--stored", *refused]
        assert exit_status(*asked) == 2
        assert words in capsys.readouterr().err


@draws
def test_a_frame_of_a_rod_that_passes_through_itself_has_the_rings_and_the_words_of_a_still(monkeypatch) -> None:
    ds = in_memory.run(loads(small.HEAD + "[axes.E]\nvalues = [5e3, 2e4]\n", default_name="soft"))
    frames = []

    def recorded(fig: Figure) -> page.Pixels:
        rings = [artist for artist in fig.axes[0].collections if artist.get_gid() == "rings"]
        legend = fig.axes[0].get_legend()
        words = [] if legend is None else [text.get_text() for text in legend.get_texts()]
        frames.append((sum(len(artist.get_offsets()) for artist in rings), words))
        return np.zeros((2, 2, 3), dtype=np.uint8)

    monkeypatch.setattr(page, "pixels_of", recorded)
    list(film.frames(StoredStudy(ds), film.Film("E", {}, None, "plain", Settings(2.0, DPI))))
    from workbench.scene import composition, layout

    for (count, words), E in zip(frames, ds["E"].values, strict=True):
        still = layout.compose(StoredStudy(ds), {"E": E}, "plain", settings=composition.Settings(2.0, DPI))
        ringed = [text for sign, text in still.legend if sign == signs.RING]
        assert words == [*ringed, *(note for note in still.notes if "than its own radius" in note)]
        assert bool(count) == bool(ringed)
    assert frames[0][0] > 0
    assert frames[0][1][0].startswith("the rod passes through itself")


@draws
def test_a_film_takes_the_stations_that_its_rods_need_and_a_dataset_with_too_few_makes_no_frame(tmp_path) -> None:
    study = small.study(AXIS, 'observables = ["height"]').at_stations(6)
    (tmp_path / "few.toml").write_text(dumps(study))
    asked = ["scene", tmp_path / "few.toml", "-o", tmp_path / "film.gif", "--dpi", "50", "--frames", "3"]
    assert exit_status(*asked) == 0
    alone = in_memory.run(study).assign_attrs(study="")
    with pytest.raises(TooFewStations, match="6 stations are too few"):
        film.frames(StoredStudy(alone), film.Film("E", {}, "height", settings=Settings(dpi=DPI)))
