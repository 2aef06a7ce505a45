"""One checker of figures: nothing is wrong with their pages, and they say and draw what is stored.

What they say is in `transcripts/NAME.words`; what they draw, their marks with places, colours and weights, is in
`transcripts/NAME.marks`. Both are stored anew where STORE stands in the environment of pytest. Another Matplotlib than
that of `constraints.txt` has other limits and names of its own: with it only faults are looked for.
"""

import itertools
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from numpy.typing import NDArray

from tests import transcripts
from tests.workbench.page_faults import faults, words
from workbench.figures import canvas, colours, figure_kinds
from workbench.stored.stored_study import StoredStudy

NUMBER = re.compile(r"[−\d.·⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+")
PINNED = f"matplotlib=={matplotlib.__version__}" in (Path(__file__).parents[2] / "constraints.txt").read_text().split()
MANY = 100  # points: so many may be chosen by rounding


def kinds_of(stored: StoredStudy) -> list[str]:
    """The kind of picture that a study has by default, and that which a notebook shows."""
    return list(dict.fromkeys((figure_kinds.kind_of(stored), figure_kinds.kind_without_map(stored))))


def check(name: str, figures: Mapping[str, Callable[[], Figure]], **allowed: Any) -> None:
    """Draw each figure, see that its page has no fault, and compare its words and marks with the stored ones.

    allowed: to `faults`.
    """
    said, drawn = list[str](), list[str]()
    for title, draw in figures.items():
        fig = draw()
        texts = words(fig)
        assert faults(fig, texts=texts, **allowed) == [], title
        said += [f"{title}: {line}" for line in _lines([" ".join(text.get_text().split()) for text in texts])]
        said += [f"{title}: caption: {line}" for line in canvas.caption(fig)]
        drawn += [f"{title}: {line}" for line in marks(fig, texts)]
    if PINNED:
        off = transcripts.differences(f"{name}.words", said) + transcripts.differences(f"{name}.marks", drawn)
        assert off == [], "\n".join(off)


def _lines(texts: list[str]) -> list[str]:
    """The texts, those numbers on one line that follow each other."""
    groups = itertools.groupby(texts, lambda text: bool(NUMBER.fullmatch(text)))
    return [line for is_number, run in groups for line in ([" ".join(run)] if is_number else run)]


def marks(fig: Figure, texts: list[Text]) -> list[str]:
    """What each panel draws, a line for its scales and one for all marks that look alike; of texts those in colours.

    It says how many there are, with how many points, and what `_ranges` says of them. A mark with a name has a line of
    its own.
    """
    wide, high = fig.get_size_inches()
    found = [f"a page of {wide:#.2g} by {high:#.2g} inches"]
    for number, ax in enumerate(_panels(fig), 1):
        if ax.axison:  # else its limits are inches of the page
            limits = (f"{scale} {low:#.5g} to {high:#.5g}" for scale, (low, high) in
                      ((ax.get_xscale(), ax.get_xlim()), (ax.get_yscale(), ax.get_ylim())))  # fmt: skip
            found.append(f"{number} axes: {', '.join(limits)}")
        alike: dict[str, list[NDArray[np.float64]]] = {}
        for mark in (*ax.lines, *ax.collections, *ax.patches):
            alike.setdefault(_style(mark), []).append(_places(mark))
        found += [f"{number} {style}: {_ranges(places)}" for style, places in alike.items()]
    for text in texts:
        if (colour := to_hex(text.get_color())) not in (to_hex(colours.INK), to_hex(colours.SOFT)):
            found.append(f"{colour}: {' '.join(text.get_text().split())}")
    return found


def _panels(fig: Figure) -> Iterator[Axes]:
    for ax in fig.axes:
        yield ax
        yield from ax.child_axes


def _style(mark: Any) -> str:
    """The kind, the name and the looks of a mark."""
    name = str(mark.get_gid() or mark.get_label() or "_")
    said = [type(mark).__name__, *([] if name.startswith("_") else [" ".join(name.split())])]
    if isinstance(mark, Line2D):
        marker = mark.get_marker()
        said += [to_hex(mark.get_color()), mark.get_linestyle(), f"{mark.get_linewidth():.2g}"]
        return " ".join([*said, *([] if marker in ("None", "") else [f"{marker}{mark.get_markersize():.2g}"])])
    if getattr(mark, "get_array", lambda: None)() is not None:
        return " ".join([*said, mark.get_cmap().name, *(f"{limit:.4g}" for limit in mark.get_clim())])
    painted = [colour for of in (mark.get_facecolor(), mark.get_edgecolor()) for colour in np.atleast_2d(of)[:1]]
    return " ".join([*said, *(to_hex(colour, keep_alpha=True) for colour in painted)])


def _places(mark: Any) -> NDArray[np.float64]:
    """The points of a mark with the values of its colours, (n, 3); NaN where there is none."""
    if isinstance(mark, Line2D):
        points = np.asarray(mark.get_xydata(), dtype=float)
    elif isinstance(mark, PathCollection):
        points = np.ma.getdata(mark.get_offsets())
    elif isinstance(mark, QuadMesh):
        points = mark.get_coordinates()[:-1, :-1].reshape(-1, 2)
    elif hasattr(mark, "get_paths"):
        points = np.concatenate([np.zeros((0, 2)), *(path.vertices for path in mark.get_paths())])
    else:
        points = mark.get_patch_transform().transform(mark.get_path().vertices)
    array = getattr(mark, "get_array", lambda: None)()
    values = np.ma.filled(np.ma.asarray(np.nan if array is None else array, dtype=float), np.nan).ravel()
    rows = np.full((max(len(points), values.size), 3), np.nan)
    rows[: len(points), :2], rows[: values.size, 2] = points, values
    return rows


def _ranges(places: list[NDArray[np.float64]]) -> str:
    """Of x, y and value the least, the mean and the largest; then the means of x y, x value and y value."""
    columns, points = np.concatenate(places).T, sum(map(len, places))
    said = [f"{len(places)} of {points if points < MANY else 'many'}"]
    for column in columns:
        known = column[np.isfinite(column)]
        said += [" ".join(f"{of:#.5g}" for of in (known.min(), known.mean(), known.max()))] if known.size else []
    products = [one * other for one, other in itertools.combinations(columns, 2)]
    means = [f"{of[np.isfinite(of)].mean():#.5g}" for of in products if np.isfinite(of).any()]
    return ", ".join([*said, " ".join(means)])
