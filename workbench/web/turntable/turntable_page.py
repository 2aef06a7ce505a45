"""Turntables: the rods of a dataset on their cylinder, turned by hand, with a slider for each axis.

As one offline HTML file, or as figures of the report: the stations, numbers, sliders and words of the cases as plain
data.
"""

import base64
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from solver.problem.errors import InputError
from studies.grammar.axes import SAMPLE

from ...figures import colours
from ...geometry import tube_tolerance
from ...geometry.centreline import APART, Array, Centreline
from ...stored.stored_study import StoredStudy
from ...words import caution_words, labels
from .. import pages
from ..live import live_document

MOST_BYTES = 1_900_000  # of the stored arrays; as text a third more, so that a file stays below 3 MB
ROWS, BYTES = 4, 4  # beta, beta', alpha and z; of a number
STRIDES = (16, 8, 4, 2)  # stations that one of them may stand for
NEAR, ANGLE = 0.005, 1e-3  # radii of the rod, and rad, by which stations may be off where others stand for them
LEAST = 51  # stations
SHARE = 1e-3  # of the height of a rod, by which its curve between stations may be off: a pixel of a large screen
INSTEAD = "make a picture, .png, or a film, .mp4; workbench explore turns one of them"
FIRST = "turntables"  # the module of the page with which the program begins

PREFERS_DARK = "@media screen and (prefers-color-scheme: dark)"  # in `scheme.css`


def html(stored: StoredStudy, at: Mapping[str, Any] | None = None, colours_of: Mapping[str, str] | None = None) -> str:
    """The file as text. It loads nothing from any address.

    Parameters
    ----------
    stored
        A stored study, or stored equilibria.
    at
        Values of axes, by name: these axes have no slider.
    colours_of
        As `look` of the settings of a scene; default: light or dark as the browser prefers.

    Raises
    ------
    InputError
        As of `stored`.
    """
    rods = turntable_of_dataset(stored, at)
    style = _in_colours(look(), colours_of) + read("page.css")
    sliders = len(rods.data["axes"])
    return pages.page(
        read("page.html.j2"),
        style,
        {"program": program()},
        data({"rod": rods.data}),
        title=str(stored.attrs["title"]),
        lead=". ".join(part for part in (stored.reading, _axis_values(stored, at or {})) if part),
        figure=figure("rod", "The rod on its cylinder", reset=bool(sliders)),
        sliders=sliders,
        left_out=rods.left_out,
    )


def _in_colours(style: str, colours_of: Mapping[str, str] | None) -> str:
    """The style with the background and the scheme that are asked for, in place of those that the browser prefers."""
    if colours_of is None:
        return style
    background, ink, soft, *_ = colours_of.values()
    which = "all" if colours.theme_on(background) == "dark" else "not all"
    chosen = f":root {{ --paper: {background}; --ink: {ink}; --soft: {soft}; }}\n"
    return style.replace(PREFERS_DARK, f"@media {which}", 1) + chosen


def figure(name: str, label: str, still: str = "", caption: str = "", reset: bool = True, row: bool = False) -> str:
    """The markup of a turntable; still: what is shown where it cannot turn, and on paper.

    row: whether `still` shows all rods of the turntable, so that it stays above the one that turns.
    """
    return pages.fill(read("figure.html.j2"), id=name, label=label, still=still, caption=caption, reset=reset, row=row)


def data(figures: Mapping[str, Any]) -> dict[str, Any]:
    """The data of all turntables of a page, and the core."""
    return {"colours": colours.for_pages(), "figures": dict(figures), "core": live_document.core_text()}


@cache
def program() -> str:
    """The script of a page with turntables, and that of the core."""
    return f"{live_document.core_script()}\n{live_document.bundle(FIRST)}"


def look() -> str:
    """The style of turntables: the colours of both schemes, light and dark, and their layout."""
    return read("scheme.css") + live_document.read("shared.css") + read("turntable.css")


def read(name: str) -> str:
    """The text of a file of this folder."""
    return pages.read(__package__, name)


def _axis_values(stored: StoredStudy, at: Mapping[str, Any]) -> str:
    """The values at which axes are fixed, as text."""
    where = stored.place(at)
    names = [stored.axis(name) for name in at]
    return stored.equations({name: where[name] for name in names})


Facts = Callable[[StoredStudy], Sequence[tuple[str, str]]]


@dataclass(frozen=True, eq=False)
class StoredTurntable:
    """The cases of a turntable.

    Attributes
    ----------
    data
        Plain data for `turntable.mjs`.
    left_out
        Sentences on values of axes that the file does not contain.
    """

    data: dict[str, Any]
    left_out: list[str]


def turntable_of_dataset(
    stored: StoredStudy, at: Mapping[str, Any] | None = None, most_bytes: int = MOST_BYTES, facts: Facts | None = None
) -> StoredTurntable:
    """The cases of a dataset, with a slider for each axis that `at` does not fix.

    Parameters
    ----------
    stored
        A stored study, or stored equilibria.
    at
        Values of axes, by name.
    most_bytes
        The size of the stored arrays. Where all cases take more, each axis has fewer values, evenly chosen.
    facts
        Rows of words and value of the dataset of one case, which are shown beside its rod; default: none.

    Raises
    ------
    InputError
        Where no case has a shape, and where one alone takes more than `most_bytes`.
    """
    at = at or {}
    base = stored.place(at)
    fixed = {stored.axis(name) for name in at}
    free = [name for name in stored.axes if name not in fixed]
    if stored.leaves:
        raise InputError(f"a page of turning rods needs rods that lie on the cylinder: {INSTEAD}")
    if stored.loads_vary:
        raise InputError(f"a page of turning rods needs rods without weight and friction: {INSTEAD}")
    n = stored.sizes["u"]
    chosen = _choose({name: stored.sizes[name] for name in free}, base, most_bytes // (ROWS * BYTES * n))
    wheres = [base | dict(zip(free, place, strict=True)) for place in product(*chosen.values())]
    shown = [stored.select(where) for where in wheres]
    lines = [case.centreline if case["solved"] else None for case in shown]
    solved = [line for line in lines if line is not None]
    if not solved:
        raise InputError(f"no case has a shape: {stored['outcome'].isel(wheres[0]).values}")
    if any(map(_is_blind, solved)):
        more = max(map(stations_for, solved))
        raise InputError(f"{n} stations are too few, as a rod swings between them unseen: store about {more}")
    step = _stride(solved)
    along = [(float(push.min()), float(push.max())) for push in (line.push(line.s) for line in solved)]
    data = {
        "axes": [_axis(stored, name, rows, base[name]) for name, rows in chosen.items()],
        "stations": stored["u"].values[::step].tolist(),
        "shared": {"sign": -1 if str(stored.attrs["side"]) == "inside" else 1},
        "cases": [
            _case(stored, where, line) | ({"facts": facts(case)} if facts is not None and line is not None else {})
            for where, case, line in zip(wheres, shown, lines, strict=True)
        ],
        "arrays": _pack(lines, step, n),
        "extremes": [min(pushes[0] for pushes in along), max(pushes[1] for pushes in along)],
        "units": stored.units,
    }
    fewer = {name: rows for name, rows in chosen.items() if len(rows) < stored.sizes[name]}
    return StoredTurntable(data, [_omissions(stored, name, rows) for name, rows in fewer.items()])


def stations_for(line: Centreline) -> int:
    """About how many stations a rod needs for a curve without corners; its own number where that is enough."""
    if _is_blind(line):
        return line.stations_for(NEAR * line.a)
    return tube_tolerance.stations_for(line, SHARE * max(float(np.ptp(line.z)), 2 * line.rho))


def _is_blind(line: Centreline) -> bool:
    """Whether a rod may swing between its stations where a picture would show it."""
    return line.phase_step > APART and line.error > NEAR * line.a


def _choose(sizes: dict[str, int], base: Mapping[str, int], most: int) -> dict[str, list[int]]:
    """The indices of each axis that are stored, at most so many cases; both ends and the base are among them."""
    counts = dict(sizes)
    if most < 1:
        raise InputError("one rod alone has too many stations for a file below 3 MB: store the study with fewer")
    while np.prod(list(counts.values())) > most:
        widest = max(counts, key=lambda name: counts[name])
        if counts[widest] <= 2:
            raise InputError(
                f"two values of each axis are more than a file below 3 MB can hold: fix one of {', '.join(sizes)} "
                "with --at, or store the study with fewer stations"
            )
        counts[widest] -= 1
    indices = {}
    for name, count in counts.items():
        rows = np.unique(np.linspace(0, sizes[name] - 1, count).round().astype(int))
        if base[name] not in rows and count > 2:
            inner = 1 + int(np.abs(rows[1:-1] - base[name]).argmin())
            rows[inner] = base[name]
        indices[name] = sorted(int(row) for row in rows)
    return indices


def _stride(lines: Sequence[Centreline]) -> int:
    """How many stations one stands for: the others lie on the curve through these as precisely as a picture shows."""
    n = lines[0].s.size
    for step in STRIDES:
        if (n - 1) % step == 0 and (n - 1) // step + 1 >= LEAST and all(_is_near(line, step) for line in lines):
            return step
    return 1


def _is_near(line: Centreline, step: int) -> bool:
    """Whether cubics through every `step`-th station, as the page draws them, meet the other stations."""
    sin, cos = np.sin(line.beta), np.cos(line.beta)
    rows: list[tuple[Array, Array, float]] = [
        (line.beta, line.dbeta, ANGLE),
        (line.rho * line.alpha, sin, NEAR * line.a),
        (line.z, cos, NEAR * line.a),
    ]
    return all(
        float(np.abs(CubicHermiteSpline(line.s[::step], y[::step], dy[::step])(line.s) - y).max()) <= limit
        for y, dy, limit in rows
    )


def _axis(stored: StoredStudy, name: str, rows: Sequence[int], base: int) -> dict[str, Any]:
    texts = labels.distinct(stored[name], stored[name].values[list(rows)])
    start = int(np.abs(np.array(rows) - base).argmin())
    words, symbol = labels.long_name(stored[name]), labels.symbol(stored[name])
    return {"name": name, "words": words, "symbol": "" if symbol == words else symbol, "texts": texts, "start": start}


def _case(stored: StoredStudy, where: Mapping[str, int], line: Centreline | None) -> dict[str, Any]:
    """The numbers of a case, and its caution; or why it has no shape."""
    if line is None:
        return {"numbers": None, "note": labels.typeset(f"Not solved: {stored['outcome'].isel(dict(where)).values}.")}
    numbers = {"R": line.R, "a": line.a, "rho": line.rho, "L": line.L, "A": line.A}
    loads = {"FZ": line.p * line.A, "MZ": line.l * line.A, "M3": line.m * line.A}
    caution = caution_words.said(stored["caution"].isel(dict(where)).values) if "caution" in stored else ""
    notes = (_sample(stored, where), caution, stored.left_out)
    return {"numbers": numbers | loads, "note": labels.typeset(" ".join(note for note in notes if note))}


def _sample(stored: StoredStudy, where: Mapping[str, int]) -> str:
    """The values of the sampled fields of a case, as a sentence."""
    names = [name for name in stored.sampled if name in stored] if SAMPLE in stored.sizes else []
    arrays = [stored[name].isel(dict(where), missing_dims="ignore") for name in names]
    texts = [labels.equation(array, float(array)) for array in arrays]
    return f"{', '.join(texts)}." if texts else ""


def _pack(lines: Sequence[Centreline | None], step: int, n: int) -> str:
    """beta, beta', alpha and z of every case at the stored stations, in base64."""
    nothing = np.zeros((ROWS, (n - 1) // step + 1), dtype="<f4")
    rows = [
        nothing if line is None else np.stack([line.beta, line.dbeta, line.alpha, line.z])[:, ::step] for line in lines
    ]
    return base64.b64encode(np.stack(rows).astype("<f4").tobytes()).decode("ascii")


def _omissions(stored: StoredStudy, name: str, rows: Sequence[int]) -> str:
    values = f"{stored.sizes[name]} values of {labels.symbol(stored[name])}"
    return f"{len(rows)} of the {values}, evenly chosen, are in this file."
