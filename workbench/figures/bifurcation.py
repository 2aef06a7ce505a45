"""The bifurcation diagram of a dataset of branches: all equilibria over an axis, folds, and a shape of each branch."""

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from string import ascii_lowercase
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from solver.observe import observables
from solver.problem.errors import check_known
from solver.problem.quantities import current
from studies.laws.law_words import in_words_of_today
from studies.laws.line_verdicts import DIRECTIONS, FAILS, HOLDS, QUALIFIED

from ..stored.stored_study import StoredStudy
from ..words import labels
from . import branch_lines, canvas, colours, crossing_rings, fonts, point_numbers, print_heights, unrolled
from .equilibria_figure import one_shown
from .sheet import SCREEN, Sheet, set_range

HIGH, TALL = (
    (0.46, 0.62),
    (0.62, 0.34),
)  # of the width: the diagram on a page and a column; the views, otherwise round
MOST = 16, 8  # shapes; those on one column of a page
DASHED, DOTTED = (0, (3, 1.5)), (0, (1, 1.2))  # where a law is false, and where one is not decided
ROUNDS, NEAR = 2, 0.05  # until the numbers stand on a diagram as high as what the layout gives it, nearly
BESIDE = 0.2  # inches above and below all lines, for a number
SMALLEST = 0.35  # inches of the view of an unstable rod: in a smaller one nothing is told apart
SAME = 0.01  # of its size: two rods between which no point of the line moves farther look the same
RINGED = 0.5  # of that length its rings cover at most
MOST_NAMED = 8  # groups of branches on one line
MOST_INSIDE = 4  # entries of a legend that find a free place in the diagram
MARKS = {"fold": "o", "pitchfork": "D", "branch point": "s", "helix ceases": "X"}
COVERED = 0.08, 0.07  # inches from a dot to a mark and to another dot: nearer it would cover a part of that
HIDDEN = 0.03  # of a panel: marks would cover a shorter stable piece
MORE = 0.45  # inches of the figure beside the diagram and the views
# an unstable branch of held ends, and stable ones
_HELD: dict[int, tuple[dict[str, Any], str]] = {
    0: (colours.UNSTABLE | {"zorder": 2}, "unstable"),
    1: (colours.STABLE | {"linewidth": 1.3, "zorder": 4}, "stable as held, unstable under a dead load"),
    2: (colours.STABLE | {"linewidth": 2.2, "zorder": 4}, "stable, also under a dead load"),
    3: (colours.STABLE | {"linewidth": 2.2, "zorder": 4}, "stable as held"),
}


def figure(stored: StoredStudy, sheet: Sheet = SCREEN, show: Sequence[str] = ()) -> Figure:
    """An observable against the axis, and the unrolled views of the branches.

    Stable branches are thick, unstable ones thin. A shape of each stable branch has a number, and its point has the
    same; one of an unstable branch where its number covers nothing. The other branches have their numbers on their
    lines where they cover nothing else. Folds and other special points are marked. Where laws were judged, the branches
    on which none is false have a colour, those on which one is false are dashed, and a note says the laws.

    show: the observable; default: as the dataset says. Raises `InputError` for one that is not stored along the
    branches, and for several.
    """
    known = [name.removeprefix("curve_") for name in stored.variables if stored[name].dims == ("curve_point",)]
    none = ("branch", "index", "dead_index", "turned_back", stored.attrs["axis"])
    known = [name for name in known if name not in none]
    show = [current(name) for name in show]
    for name in show:
        check_known("observable along the branches", name, known)
    (shown,) = one_shown(show) or (str(stored.attrs["shown"]),)
    inches = HIGH[sheet.narrow] * sheet.width
    fig = _page_with_numbers(stored, shown, sheet, inches)
    for _ in range(ROUNDS):
        with rc_context(fonts.RC):
            fig.draw_without_rendering()
        seen = fig.axes[0].bbox.height / fig.dpi
        if abs(seen - inches) < NEAR * inches:
            break
        inches = seen
        fig = _page_with_numbers(stored, shown, sheet, inches)
    return fig


def _page_with_numbers(stored: StoredStudy, shown: str, sheet: Sheet, inches: float) -> Figure:
    """The figure, whose numbers have room on a diagram so many inches high."""
    high, laws, alike = HIGH[sheet.narrow] * sheet.width, _laws(stored), _alike(_on_one_line(stored, shown))
    with rc_context(fonts.RC | sheet.settings()):  # which shapes have room for their numbers
        ax = Figure((sheet.width, high + MORE)).add_subplot()
        numbered, _ = panel(stored, ax, shown, inches, sheet, _in_order(stored))
    chosen = _large_enough(stored, _different(stored, numbered)[: MOST[sheet.narrow]], sheet)

    def draw(most: int) -> Figure:
        kept = sorted(chosen[: most - 1])

        def diagram(ax: Axes) -> canvas.Said:
            said = panel(stored, ax, shown, inches, sheet, kept, others=True)[1]
            canvas.add_legend(ax, MOST_INSIDE)
            return [*laws, *said]

        rows: list[canvas.Row] = [(high, [diagram])]
        if kept:
            views = _views(stored, kept, sheet)
            count = f"; {len(kept)} of {stored.sizes['shape']}" if len(kept) < stored.sizes["shape"] else ""
            said = f", of the points with their numbers{count}"
            rows.append((views.height, [lambda ax: [*views.draw(ax, said), *alike]]))
        return canvas.page(stored, sheet, rows, [] if kept else alike, MORE)

    return print_heights.with_room(draw, len(chosen) + 1)


def panel(
    stored: StoredStudy,
    ax: Axes,
    key: str,
    inches: float = 4.0,
    sheet: Sheet = SCREEN,
    chosen: Sequence[int] = (),
    others: bool = False,
) -> tuple[list[int], list[str]]:
    """One quantity of each equilibrium against the axis, a line a branch; inches: the height of the panel. others:
    whether the branches of no chosen shape have their numbers on their lines.

    Returns those of the chosen shapes whose points are on the panel with their numbers, in the order given, and the
    sentence that says how many branches have no number, if any.
    """
    name = str(stored.attrs["axis"])
    drawn: list[tuple[str, Any]] = []
    (points, sizes), count = _curves(stored, key), observables.is_count(key)
    for row in sorted(stored.data("branches"), key=_place_in_legend):
        on = np.flatnonzero(stored["curve_branch"].values == row["branch"])
        runs = [(points[on], *_look(row))] if "member" in stored.sizes else _runs(stored, ax, on, points[on])
        for run, look, label in ((part, *how) for points, *how in runs for part in branch_lines.parts(points, count)):
            share = run / sizes
            if any(label == same and branch_lines.lies_on(share, other) for same, other in drawn):
                continue
            drawn.append((label, share))
            line = branch_lines.smooth(run[:, 0], run[:, 1], share)
            if look["linewidth"] > 1 and np.ptp(share, axis=0).max() < HIDDEN:
                look = look | {"zorder": 6.5}  # above the marks at its two ends
            ax.plot(*line, label=label, marker="." if len(run if count else on) == 1 else "", **look)
    for kind, mark in MARKS.items():
        x, y, stable = _special(stored, name, key, kind)
        for of, order in ((stable, 6), (~stable, 3.6)):  # what unstable branches share covers no stable one
            if of.any():
                ax.plot(x[of], y[of], mark, color=colours.INK, markersize=4.5, markerfacecolor="white", zorder=order,
                        linestyle="none", label=kind)  # fmt: skip
    ax.set_xlabel(labels.axis_label(stored[name]))
    ax.set_ylabel(fonts.fit_label(partial(labels.label, stored[f"curve_{key}"]), inches - 0.5))
    ends = labels.in_label_unit(stored[name], stored[name].values[[0, -1]])
    if "member" in stored.sizes:
        ax.margins(x=0.06)
    else:
        ax.set_xlim(*(ends + 0.06 * np.ptp(ends) * np.array([-1, 1])))
    ax.margins(y=max(BESIDE / inches, 0.05))
    ax.set_ylim(*ax.get_ylim())
    set_range(sheet, ax, key)
    return _number_points(stored, ax, key, (fonts.inches(ax)[0], inches), chosen, others and not count)


def _curves(stored: StoredStudy, key: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The points of all branches in the units of the labels, (curve_point, 2), and the extent of both columns, (2,)."""
    points = np.stack([_values(stored, f"curve_{name}") for name in (str(stored.attrs["axis"]), key)], axis=1)
    return points, np.array([np.ptp(column[np.isfinite(column)]) or 1.0 for column in points.T])


def _on_one_line(stored: StoredStudy, key: str) -> list[list[int]]:
    """The numbers of the branches, from 0, those of one line together."""
    points, sizes = _curves(stored, key)
    groups, lines = list[list[int]](), list[Any]()
    for row in stored.data("branches"):
        line = (points / sizes)[stored["curve_branch"].values == row["branch"]]
        same = (branch_lines.lies_on(line, other) and branch_lines.lies_on(other, line) for other in lines)
        at = next((i for i, is_same in enumerate(same) if is_same), None)
        if at is None:
            groups.append([])
            lines.append(line)
        groups[-1 if at is None else at].append(row["branch"])
    return groups


def _alike(groups: Sequence[Sequence[int]]) -> list[str]:
    """The sentence that names the branches of which one line shows several; none where each has its own."""
    several = [" and ".join(f"{number + 1}" for number in group) for group in groups if len(group) > 1]
    more = f"; {len(several) - MOST_NAMED} more" if len(several) > MOST_NAMED else ""
    return [f"Branches that share a line: {', '.join(several[:MOST_NAMED])}{more}."] if several else []


def _values(stored: StoredStudy, name: str) -> Any:
    return labels.in_label_unit(stored[name], stored[name].values)


def _special(stored: StoredStudy, name: str, key: str, kind: str) -> tuple[Any, Any, Any]:
    """Axis values and shown values of the special points of one kind, and whether each is the end of a stable branch
    or held ends decide that along each branch."""
    dim = "fold" if kind == "fold" else "special"
    if dim not in stored.sizes:
        return np.empty(0), np.empty(0), np.empty(0, dtype=bool)
    chosen = np.ones(stored.sizes[dim], dtype=bool) if dim == "fold" else stored["special_kind"].values == kind
    x, y = labels.in_label_unit(stored[name], stored[dim].values), _values(stored, f"{dim}_{key}")
    chosen &= np.isfinite(y)
    steady = [row["branch"] for row in stored.data("branches") if row["index"] == 0 or "member" not in stored.sizes]
    stable = np.array([bool({*pair} & {*steady}) for pair in stored[f"{dim}_branches"].values.tolist()], dtype=bool)
    return x[chosen], y[chosen], stable[chosen]


def _kind_under_held_ends(index: Any, dead: Any) -> NDArray[np.int_]:
    """The kind of `_HELD` of each Morse index under held ends; dead: that under dead loads, NaN where it is unknown."""
    return np.select([index > 0, dead > 0, dead == 0], [0, 1, 2], 3)


def _runs(stored: StoredStudy, ax: Axes, on: Any, points: Any) -> list[tuple[Any, dict[str, Any], str]]:
    """The parts of a branch under held ends of one look: their points (n, 2), look and entry in the legend.

    Those are told apart that would be stable under dead loads too. They meet half way between two stored points, where
    a mark says that a rod would snap through under dead loads.
    """
    index, dead = stored["curve_index"].values[on], stored["curve_dead_index"].values[on]
    kind = _kind_under_held_ends(index, dead)
    if kind.size > 2:
        kind[[0, -1]] = kind[[1, -2]]
        at = 1 + np.flatnonzero(np.diff(dead > 0) & (index[1:] == 0) & (index[:-1] == 0))
        middle = (points[at - 1] + points[at]) / 2
        points, kind = np.insert(points, at, middle, axis=0), np.insert(kind, at, 2)
        if at.size:
            ax.plot(
                *middle.T,
                "^",
                color=colours.INK,
                markersize=5.5,
                markerfacecolor="white",
                zorder=6,
                linestyle="none",
                label="fold: snaps through under a dead load",
            )
    cuts = [0, *(np.flatnonzero(np.diff(kind)) + 1), kind.size]
    runs = []
    for a, b in pairwise(cuts):  # a fold has the smaller index of its two sides: the other side reaches to it
        first = a - (a > 0 and kind[a - 1] > kind[a])
        last = b + (b < kind.size and kind[b] > kind[b - 1])
        runs.append((points[first:last], *_HELD[int(kind[a])]))
    return runs


def _laws(stored: StoredStudy) -> list[str]:
    """The sentence that says the laws of the legend; none where no branch has their colour."""
    rows = stored.data("branches")
    if "member" not in stored.sizes or not any("color" in _judge(row)[0] for row in rows):
        return []
    laws = [key.split(" ") for key in rows[0] if " " in key]
    words = " and ".join(f"{labels.noun_of(name)} {DIRECTIONS[direction].does}" for name, direction in laws)
    return [f"Laws of the study: {words} with {labels.symbol(stored[str(stored.attrs['axis'])])}."]


def _judge(row: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """The look that says what was judged on a branch, and what the legend says of it; nothing where nothing was."""
    verdicts = [in_words_of_today(str(verdict)) for key, verdict in row.items() if " " in key]
    if any(verdict.startswith(FAILS) for verdict in verdicts):
        return {"linestyle": DASHED}, ": a law is false"
    if all(verdict.startswith((HOLDS, QUALIFIED)) for verdict in verdicts):
        return ({"color": colours.VERDICTS[HOLDS]}, ": no law is false") if verdicts else ({}, "")
    return {"linestyle": DOTTED}, ": a law is not decided"


def _place_in_legend(row: dict[str, Any]) -> tuple[bool, bool, str]:
    """The place of a branch in the order of the legend: stable before unstable, then by what is said of laws."""
    judged, words = _judge(row)
    return row["index"] != 0, "color" not in judged, words


def _look(row: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """The look of a branch, and its entry in the legend."""
    (judged, words), stable = _judge(row), row["index"] == 0
    look = (colours.STABLE if stable else colours.UNSTABLE) | {"zorder": 4 if stable else 3 if judged else 2} | judged
    return look, ("stable" if stable else "unstable") + words


def _look_of_shape(stored: StoredStudy, k: int) -> dict[str, Any]:
    """Colour and width of the line of its branch, at the place of the shape."""
    name, number = str(stored.attrs["axis"]), int(_shape_branches(stored)[k])
    if "member" in stored.sizes:
        return colours.of_line(_look(next(row for row in stored.data("branches") if row["branch"] == number))[0])
    on = np.flatnonzero(stored["curve_branch"].values == number)
    at = on[int(np.argmin(np.abs(stored[f"curve_{name}"].values[on] - float(stored[f"shape_{name}"].values[k]))))]
    index, dead = stored["curve_index"].values[at], stored["curve_dead_index"].values[at]
    return colours.of_line(_HELD[int(_kind_under_held_ends(index, dead))][0])


def _in_order(stored: StoredStudy) -> list[int]:
    """The shapes, those of stable equilibria first."""
    count = stored.sizes.get("shape", 0)
    return sorted(range(count), key=lambda k: not _is_stable(stored, k))


def stable_shapes(stored: StoredStudy) -> list[int]:
    """The shapes of stable equilibria that the file keeps."""
    return [k for k in range(stored.sizes.get("shape", 0)) if _is_stable(stored, k)]


def _is_stable(stored: StoredStudy, k: int) -> bool:
    return bool(_look_of_shape(stored, k)["linewidth"] > colours.UNSTABLE["linewidth"])


def _different(stored: StoredStudy, chosen: Sequence[int]) -> list[int]:
    """The shapes without the unstable ones that look like one before them, such as a straight rod on many branches."""
    kept, lines = list[int](), list[np.ndarray]()
    for k in chosen:
        rho, alpha, z = (stored[f"shape_{key}"].values[k] for key in ("rho", "alpha", "z"))
        line = np.array([rho * alpha, z])
        if _is_stable(stored, k) or all(np.abs(line - other).max() > SAME * np.ptp(line) for other in lines):
            kept.append(k)
            lines.append(line)
    return kept


def _large_enough(stored: StoredStudy, chosen: Sequence[int], sheet: Sheet) -> list[int]:
    """The shapes without the unstable ones of which too little would be seen.

    The one of which least is seen is left out first. The others are larger without it, and are judged anew.
    """
    kept = list(chosen)
    while kept:
        panel = _views(stored, kept, sheet)
        seen = [
            np.inf if _is_stable(stored, k) else _share_seen(panel, view)
            for k, view in zip(kept, panel.views, strict=True)
        ]
        least = int(np.argmin(seen))
        if seen[least] >= 1:
            break
        del kept[least]
    return kept


def _share_seen(panel: unrolled.UnrolledPanel, view: unrolled.UnrolledView) -> float:
    """How many times as large as needed the view of an unstable rod is drawn: below 1 too little of it is seen."""
    size = float(max(view.size * [1, panel.form.factor])) * panel.form.scale
    return size / max(SMALLEST, len(view.rings) * crossing_rings.SMALLEST / 72 / RINGED)


def _views(stored: StoredStudy, chosen: Sequence[int], sheet: Sheet) -> unrolled.UnrolledPanel:
    """The unrolled views at the points of these shapes, each with its number."""
    views, names = [], names_of_shapes(stored)
    for k in chosen:
        rho, alpha, z = (stored[f"shape_{key}"].values[k] for key in ("rho", "alpha", "z"))
        a, L = (float(stored[key]) if not stored[key].dims else float(stored[f"shape_{key}"][k]) for key in ("a", "L"))
        s = np.linspace(0, L, z.size)
        views.append(unrolled.view_of(s, float(rho), alpha, z, a, names[k], _look_of_shape(stored, k))[0])
    room = sheet.width - unrolled.BESIDE, TALL[not sheet.narrow] * sheet.width
    return unrolled.UnrolledPanel(views, room, sheet.small, labels.unit(str(stored["shape_z"].attrs.get("units", "1"))))


def _shape_branches(stored: StoredStudy) -> Any:
    """The branch of each shape; in a file that does not say it each branch has one."""
    return stored["shape_branch"].values if "shape_branch" in stored else np.arange(stored.sizes.get("shape", 0))


def names_of_shapes(stored: StoredStudy) -> list[str]:
    """What the shapes are called: by the number of their branch, from 1, with a letter where a branch has several."""
    of = [int(branch) for branch in _shape_branches(stored)]
    letters = [ascii_lowercase[of[:k].count(branch)] if of.count(branch) > 1 else "" for k, branch in enumerate(of)]
    return [f"{branch + 1}{letter}" for branch, letter in zip(of, letters, strict=True)]


def _number_points(
    stored: StoredStudy, ax: Axes, key: str, inches: tuple[float, float], chosen: Sequence[int], others: bool
) -> tuple[list[int], list[str]]:
    """A dot with its number at the points of these shapes, where the axis reaches them, and the number of an unstable
    one covers nothing. Where a dot would cover a mark or another dot, a line leads from the number to the point.
    others, and what it returns: as of `panel`."""
    name, names = str(stored.attrs["axis"]), names_of_shapes(stored)
    x, y = (_values(stored, f"shape_{of}") if f"shape_{of}" in stored else np.empty(0) for of in (name, key))
    (left, right), (low, high) = sorted(ax.get_xlim()), sorted(ax.get_ylim())
    inside = [k for k in chosen if y.size and left <= x[k] <= right and low <= y[k] <= high]
    dots = [dot for line in ax.lines if line.get_linestyle() == "None" for dot in np.asarray(line.get_xydata())]
    per = np.array(inches) / [right - left, high - low]
    bare = set[int]()  # others lie below what is stable, and below marks
    for i, k in enumerate(inside):
        away = [np.hypot(*(per * (dot - [x[k], y[k]]))) for dot in dots]
        beside = [np.hypot(*(per * [x[k] - x[other], y[k] - y[other]])) for other in inside[:i] if other not in bare]
        is_near = min(away, default=np.inf) < COVERED[0]
        is_near |= any(point_numbers.SAME <= gap < COVERED[1] for gap in beside)
        if is_near and _is_stable(stored, k):
            bare.add(k)
    points = [point_numbers.NumberedPoint(x[k], y[k], names[k], _is_stable(stored, k), k in bare) for k in inside]
    lines = [line.get_xydata() for line in ax.lines if np.size(line.get_xdata()) > 1 and line.get_linestyle() != "None"]
    on = [
        ([f"{number + 1}" for number in group], line)
        for group in (_on_one_line(stored, key) if others else ())
        if len(line := _longest_part(stored, key, group[0]))
    ]
    at, said = point_numbers.write(ax, points, lines, dots, inches, on)
    written = [inside[i] for i in sorted(at)]
    for k in written:
        if k in bare:
            continue
        colour = _look_of_shape(stored, k)["color"]
        order = 7 if _is_stable(stored, k) else 3.5  # the dot of an unstable shape covers nothing stable
        ax.plot(
            x[k], y[k], "o", color=colour, markersize=4.2, zorder=order, markeredgecolor="white", markeredgewidth=0.7
        )
    every, _ = _curves(stored, key)
    within = ((every >= (left, low)) & (every <= (right, high))).all(axis=1)
    seen = {f"{number + 1}" for number in stored["curve_branch"].values[within].tolist()}
    have = "has" if len(seen - said) == 1 else "have"
    sentence = f"{len(seen - said)} of the {len(seen)} branches {have} no number, for which there is no room."
    return written, [sentence] * (len(seen) > 1 and not seen <= said)


def _longest_part(stored: StoredStudy, key: str, number: int) -> NDArray[np.float64]:
    """The longest stretch of the line of a branch that has numbers, as it is drawn, (n, 2); empty without any."""
    points, sizes = _curves(stored, key)
    stretches = branch_lines.parts(points[stored["curve_branch"].values == number], False)
    longest = max(stretches, key=len, default=np.empty((0, 2)))
    return np.stack(branch_lines.smooth(longest[:, 0], longest[:, 1], longest / sizes), axis=1)
