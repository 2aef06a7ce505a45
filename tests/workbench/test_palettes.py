"""The colours of figures, scenes, page and report: contrast to their background, and apart to every kind of eye.

Contrast is that of the Web Content Accessibility Guidelines: 4.5 for text, 3 for lines and marks. Colour blindness is
simulated by the matrices of Machado, Oliveira and Fernandes (2009) at full severity, in linear light; colours are
compared in CIELAB, where a distance of 2 is just seen side by side.
"""

import re
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import workbench
from workbench.figures import bars, colours, push_scale
from workbench.lab import robustness
from workbench.lab.benchmark import ladders
from workbench.paper import report_document
from workbench.scene import scene_kinds
from workbench.scene.settings import Settings

WHITE = "#ffffff"
TEXT, LINE = 4.5, 3.0
APART = 10.0  # in CIELAB: told apart at a glance, also where the two do not touch
KINDS = {
    "usual": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
LIST = list(ladders().values())


def linear(colour) -> np.ndarray:
    c = np.asarray(to_rgb(colour))
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def contrast(colour, background=WHITE) -> float:
    bright, dark = sorted((linear(one) @ [0.2126, 0.7152, 0.0722] for one in (colour, background)), reverse=True)
    return float((bright + 0.05) / (dark + 0.05))


def lab(colour, kind: str = "usual") -> np.ndarray:
    """CIELAB of a colour as an eye of that kind sees it, under D65."""
    seen = np.clip(np.asarray(KINDS[kind]) @ linear(colour), 0, 1)
    to_xyz = [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
    t = np.asarray(to_xyz) @ seen / [0.95047, 1.0, 1.08883]
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def nearest(colours, kind: str) -> tuple[float, tuple]:
    """The smallest distance of two of the colours, and the two."""
    return min((float(np.linalg.norm(lab(a, kind) - lab(b, kind))), (a, b)) for a, b in combinations(colours, 2))


def of_css(*paths: str) -> tuple[dict[str, str], dict[str, str]]:
    """The variables of style sheets, as they are in the light and in the dark scheme."""
    text = "".join((Path(workbench.__file__).parent / path).read_text(encoding="utf-8") for path in paths)
    light, _, dark = text.partition("prefers-color-scheme: dark")
    found = [dict(re.findall(r"--([a-z-]+):\s*(#[0-9a-fA-F]{3,6})", part)) for part in (light, dark)]
    return found[0], {**found[0], **found[1]}


def test_the_measures_agree_with_published_values() -> None:
    assert contrast("#000000") == pytest.approx(21)
    assert contrast("#767676") == pytest.approx(4.54, abs=0.01)  # the lightest grey that WCAG allows for text
    np.testing.assert_allclose(lab("#ff0000"), [53.24, 80.09, 67.20], atol=0.05)  # D65, as published by Lindbloom
    for kind, matrix in KINDS.items():
        np.testing.assert_allclose(np.sum(matrix, axis=1), 1, atol=2e-6, err_msg=kind)  # greys stay grey


BLUES = [np.array(rgb) / 255 for share, rgb in colours.DIVERGING if share >= 0]
PULLS = [colours.PULLED, *(np.array(rgb) / 255 for share, rgb in colours.DIVERGING if share < 0)]
MAP = [colour[:3] for colour in colours.map_colours()(np.linspace(0, 1, 64))]
SHADES = [*colours.EXTREMES.values(), *(robustness.SOLVED(k / 8)[:3] for k in range(9))]
# what stands out from what, and the least contrast
STAND_OUT = {
    "letters": ([colours.INK, colours.SOFT, *colours.VERDICTS.values()], [WHITE], TEXT),
    "push and pull": ([colours.PUSHED, colours.PULLED], [WHITE], LINE),
    # soft is also the casing around the pale blue of no push
    "marks": ([colours.CROSSED, colours.SOFT, colours.INK], [WHITE], LINE),
    "rings on a twisted rod": ([colours.CROSSED], [colours.UNPAINTED, colours.STRIPE], 2.0),
    "curves along an axis": (colours.ramp_colours(9), [WHITE], LINE),
    "indices": ([bars.FIRST, bars.TOTAL], [WHITE], LINE),
    # the white halo of a number lets a quarter of the map through
    "numbers on a map": ([colours.INK], [0.75 * np.ones(3) + 0.25 * colour for colour in MAP], TEXT),
    "borders and hatching of a map": ([colours.INK], MAP, LINE),
    "letters on the extremes": ([colours.INK], SHADES, TEXT),
    "hatching of what is not solved, on a map": ([colours.SOFT], [colours.FAINT], LINE),
    # beside the shadow that the rod throws
    "a rod on the cylinder": ([*colours.SEVERAL, colours.STRIPE, colours.PUSHED], [colours.SURFACE], 2.5),
}


@pytest.mark.parametrize("name", STAND_OUT)
def test_what_is_drawn_stands_out_from_what_is_behind_it(name: str) -> None:
    drawn, behind, least = STAND_OUT[name]
    for colour, background in product(drawn, behind):
        assert contrast(colour, background) >= least, (colour, background)


@pytest.mark.parametrize("background", ["#ffffff", "#14181e", "#102030", "#777777", "#767a3c", "#c04040", "#ffd700"])
def test_words_and_marks_stand_out_from_any_background_of_a_scene(background: str) -> None:
    """The sheet of each theme, and colours in whose middle lightness neither theme was made for."""
    for theme in (None, *colours.THEMES):
        behind, words, soft, _, *marks = Settings(theme=theme, background=background).look.values()
        assert behind == background
        assert min(contrast(colour, behind) for colour in (words, soft)) >= TEXT
        assert min(contrast(colour, behind) for colour in marks) >= LINE


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "palette",
    [
        (colours.PUSHED, colours.PULLED),
        tuple(colours.VERDICTS.values()),
        colours.SEVERAL,
        (colours.UNPAINTED, colours.STRIPE),
        (colours.PUSHED, colours.INK, colours.SOFT),
    ],
)
def test_colours_that_mean_different_things_are_apart_to_every_eye(palette, kind: str) -> None:
    distance, pair = nearest(palette, kind)
    assert distance >= APART, (kind, pair)


@pytest.mark.parametrize("kind", KINDS)
def test_a_pull_is_apart_from_every_push(kind: str) -> None:
    for pull, blue in product(PULLS, BLUES):
        assert np.linalg.norm(lab(pull, kind) - lab(blue, kind)) >= 2 * APART


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ["push", "curves", "map"])
def test_a_ramp_only_darkens_or_only_lightens_to_every_eye(name: str, kind: str) -> None:
    ramps = {
        "push": BLUES,
        "curves": colours.ramp_colours(9),
        "map": list(colours.map_colours(12)(np.linspace(0, 1, 12))),
    }
    steps = np.diff([lab(colour[:3], kind)[0] for colour in ramps[name]])
    assert (steps > 1).all() or (steps < -1).all()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("problem", ["start", "ends"])
def test_two_methods_of_one_diagram_are_apart_to_every_eye(problem: str, kind: str) -> None:
    from solver.methods import METHODS

    here = [one for one in LIST if problem in METHODS[one.method].problems]
    distance, pair = nearest([one.colour for one in here], kind)
    assert distance >= APART, pair
    for one in here:
        assert contrast(one.colour) >= LINE, one.name


PAPERS = {
    "web/turntable/scheme.css": {"ink": TEXT, "soft": TEXT, "line": TEXT, "bad": TEXT, "edge": LINE},
    "web/live/page/page.css": {
        "ink": TEXT, "soft": TEXT, "line": TEXT, "border": LINE, "level": LINE, "bad": TEXT, "mark": LINE,
    },
}  # fmt: skip


@pytest.mark.parametrize("scheme", [0, 1])
@pytest.mark.parametrize("path", PAPERS)
def test_text_and_lines_of_page_and_report_stand_out_in_both_schemes(path: str, scheme: int) -> None:
    found = of_css(path)[scheme]
    assert "paper" in found
    for name, least in PAPERS[path].items():
        for paper in ("paper", "raised", "paper-soft"):
            if paper in found:
                assert contrast(found[name], found[paper]) >= least, (name, paper)


def test_the_verdicts_of_the_report_stand_out_in_the_dark_too() -> None:
    """In the light they have the colours of the figures."""
    light, dark = of_css("web/turntable/scheme.css", "paper/report.css")
    assert contrast(light["paper"]) < 15 < contrast(dark["paper"])
    for verdict in report_document.CLASSES.values():
        assert contrast(dark[verdict], dark["paper"]) >= TEXT, verdict


def test_the_push_has_the_same_limits_in_a_diagram_as_in_a_scene() -> None:
    diagram = push_scale.scale([np.array([-3.0, 12.0]), np.array([1.0, 87.0])])
    painted = scene_kinds.by_push({"length": "cm", "force": "N"}, (-3.0, 87.0))
    assert (diagram.vmin, diagram.vmax) == (painted.low, painted.high) == (-100.0, 100.0)


def test_rings_of_crossings_have_one_colour_in_pictures_and_in_pages() -> None:
    page = (Path(workbench.__file__).parent / "web/live/page/shared.css").read_text(encoding="utf-8")
    assert re.findall(r"^\.ring, .*border: 1\.5px solid (#\w+);", page, re.M) == [colours.CROSSED]


def test_no_two_methods_of_one_kind_of_problem_look_alike() -> None:
    looks = [(one.colour, one.marker, one.line) for one in ladders().values()]
    assert len({colour for colour, _, _ in looks}) == len(looks)
    for pair in (("verlet", "verlet extrapolated"), ("difference", "difference extrapolated")):
        first, second = (ladders()[name] for name in pair)
        assert first.marker != second.marker
        assert first.line != second.line
