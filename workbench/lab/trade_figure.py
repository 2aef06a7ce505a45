"""Work-precision diagrams of a stored trade: error against seconds or evaluations, a panel for each of six cases."""

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from solver.problem.errors import check_known

from ..figures import canvas, colours, fonts
from ..figures.sheet import SCREEN, Sheet
from ..stored.stored_study import StoredStudy
from ..words import labels

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from solver.methods.method import Ladder

COSTS = {"seconds": "seconds of the whole call", "evaluations": "evaluations of the equation"}
LOST = 1.0  # an error of this size and more has no correct digit
FLOOR, TOP = 1e-16, 1e4  # the range of errors that is shown; an error of 0 is drawn at its lower end
# what stands beside the crosses, and where
FAILED, NO_DIGIT = (LOST * TOP) ** 0.5, "failed, or no\ncorrect digit\n(rows as in key)"
PANEL, LEGEND = 2.1, 1.6  # inches that a panel and the legend are high
MOST = 6  # panels
SLOW: dict[str, Any] = {"marker": ">", "markersize": 7, "markerfacecolor": "none", "linestyle": ""}
ERRORS = "Errors: of the angle in radians, or of the position over max(ρ, L), whichever is larger."
# shown where more cases are measured, in words
SHOWN = {
    "force-first/tension": "start: Table 1, pulled by 8.7\N{NO-BREAK SPACE}N",
    "gap 1e-02": "start: 10⁻²\N{NO-BREAK SPACE}rad from a saddle",
    "gap 1e-08": "start: 10⁻⁸\N{NO-BREAK SPACE}rad from a saddle",
    "long": "start: Table 1, 400\N{NO-BREAK SPACE}cm long",
    "ends table 1": "ends: Table 1, pressed",
    "ends stable 1": "ends: stable, near a saddle",
}


def cases_to_show(stored: StoredStudy) -> list[str]:
    """The cases of a trade that its diagrams show: all where they are few, else those of `SHOWN`, else the first."""
    cases = [str(case) for case in stored["case"].values]
    return cases if len(cases) <= MOST else [case for case in SHOWN if case in cases] or cases[:MOST]


def figure(stored: StoredStudy, cost: str = "seconds", sheet: Sheet = SCREEN) -> Figure:
    """The shown cases of a trade against one cost of `COSTS`. Raises `InputError` for one that was not measured."""
    check_known("cost", cost, [name for name in COSTS if name in stored])
    cases = cases_to_show(stored)
    columns = min(2 if sheet.narrow else 3, len(cases))
    which = f", {len(cases)} of {stored.sizes['case']} cases" if len(cases) < stored.sizes["case"] else ""
    title = str(stored.attrs["title"])
    titled = stored.with_title(title and f"{title}: {COSTS[cost]}{which}")

    spent = stored[cost].sel(case=cases).values
    ends = np.nanmin(spent) / 2, 2 * np.nanmax(spent)

    def draw(i: int, ax: Axes) -> None:
        panel(stored, ax, cases[i], cost).set_xlim(*ends)
        ax.tick_params(labelleft=i % columns == 0)
        ax.set_xlabel(fonts.wrap(COSTS[cost], ax) if i + columns >= len(cases) else "")
        if i == 0:
            fig = ax.get_figure(root=True)
            assert fig is not None
            fig.supylabel("error of angle or position", size=fonts.normal())

    rows = canvas.in_rows([partial(draw, i) for i in range(len(cases))], columns, PANEL)
    return canvas.page(titled, sheet, rows, [*_entries(stored, cases), ERRORS], LEGEND)


def panel(stored: StoredStudy, ax: Axes, case: str, cost: str = "seconds") -> Axes:
    """One case: a line a method over its ladder, crosses at the top for failed rungs. Raises `InputError`.

    The crosses of each method have a height of their own, in the order of the legend. Rungs that it handed over to
    another are a line of their own.
    """
    check_known("case", case, [str(name) for name in stored["case"].values])
    rows = stored.part(case=case)
    failed: list[tuple[NDArray[np.float64], str]] = []
    for method in stored["ladder"].values:
        climb = rows.part(ladder=str(method))
        outcome = climb["outcome"].values.astype(str)
        error, spent = climb["error"].values, climb[cost].values
        tried, good = np.isfinite(spent), _is_correct(climb) & np.isfinite(spent)
        look = look_of(str(method))
        colour = look.colour
        for stretch, handed in _stretches(climb, good, look.method):
            fill: dict[str, Any] = {"markerfacecolor": "white", "markeredgewidth": 0.8} if handed else {}
            ax.plot(
                spent[stretch],
                np.maximum(error[stretch], FLOOR),
                color=colour,
                marker=look.marker,
                markersize=_size(look),
                linestyle=look.line,
                linewidth=1.8 if look.bold else 1.1,
                zorder=4 if look.bold else 3,
                **{"markeredgewidth": 0, **fill},
            )
        bad = tried & ~good
        failed += [(spent[bad], colour)] * bool(bad.any())
        if np.char.startswith(outcome, "not run").any() and good.any():
            last = np.flatnonzero(good)[-1]
            ax.plot(spent[last], max(error[last], FLOOR), color=colour, markeredgewidth=0.9, zorder=5, **SLOW)
    heights = np.geomspace(TOP, LOST, len(failed) + 2)[1:-1]
    for (spent, colour), height in zip(failed, heights, strict=True):
        ax.plot(spent, np.full(spent.size, height), "x", color=colour, markersize=4, markeredgewidth=1.1, zorder=3)
    ax.axhline(LOST, color=colours.FAINT, linewidth=1, zorder=1)
    ax.set(xscale="log", yscale="log", ylim=(FLOOR / 2, TOP))
    ax.set_yticks([*(10.0**k for k in range(-15, 1 - bool(failed), 3)), *[FAILED] * bool(failed)])
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(lambda value, _: NO_DIGIT if value == FAILED else labels.power_of_ten(value))
        axis.set_minor_formatter(NullFormatter())
    words = SHOWN.get(case) or (f"{case}: {rows['about'].item()}" if "about" in rows else case)  # none in older files
    ax.set_title(fonts.wrap(labels.powers_of_ten(words), ax, fonts.small()), loc="left", size=fonts.small(), pad=3)
    return ax


def _is_correct(rungs: StoredStudy) -> "NDArray[np.bool_]":
    """Whether a rung of a ladder is solved with at least one correct digit, of the shape of the rungs."""
    solved = np.char.startswith(rungs["outcome"].values.astype(str), "solved")
    return np.asarray(solved & (rungs["error"].values < LOST))


def _stretches(one: StoredStudy, good: "NDArray[np.bool_]", name: str) -> "list[tuple[NDArray[np.intp], bool]]":
    """The good rungs of one ladder, those of each method that answered by themselves: no line joins two methods.

    name: of the method; beside each stretch whether the method handed it over to another.
    """
    rungs = np.flatnonzero(good)
    if "answered" not in one:
        return [(rungs, False)]
    answered = one["answered"].values.astype(str)[rungs]
    return [(rungs[answered == method], method != name) for method in dict.fromkeys(answered.tolist())]


def _entries(stored: StoredStudy, cases: Sequence[str]) -> list[Artist]:
    """The legend: the methods that were tried on these cases, and what the marks are."""
    climbs = {str(m): [stored.part(case=case, ladder=str(m)) for case in cases] for m in stored["ladder"].values}
    tried = [name for name, rows in climbs.items() if any(np.isfinite(row["seconds"].values).any() for row in rows)]
    looks: list[dict[str, Any]] = [
        {
            "color": look.colour,
            "linewidth": 1.4,
            "label": look.name,
            **(
                {"marker": look.marker, "markersize": _size(look) + 0.4, "linestyle": look.line}
                if any(_is_correct(row).any() for row in climbs[look.name])
                else {"marker": "x", "markersize": 4, "linestyle": ""}
            ),
        }
        for look in map(look_of, tried)
    ]
    looks.append({**SLOW, "label": "its next finer setting takes too long"})
    if "answered" in stored and any(_is_handed_over(stored, str(name)) for name in stored["ladder"].values):
        over = {"marker": "h", "markersize": 4, "markerfacecolor": "white"}
        looks.append({**over, "label": "handed over to another method"})
    return [Line2D([], [], **{"color": colours.SOFT, **look}) for look in looks]


def _is_handed_over(stored: StoredStudy, ladder: str) -> bool:
    """Whether another method answered on some rung of a ladder."""
    answered = np.unique(stored["answered"].sel(ladder=ladder).values.astype(str))
    return bool(set(answered.tolist()) - {"", look_of(ladder).method})


def _size(look: "Ladder") -> float:
    """Points of a marker: those with thin arms are larger."""
    return {"*": 5.5, "d": 4.6}.get(look.marker, 3.6)


def look_of(ladder: str) -> "Ladder":
    """The ladder of that name, which has a colour and a marker. Raises `InputError` for an unknown one."""
    from .benchmark import ladders  # loads the methods: only where their diagram is drawn

    known = ladders()
    check_known("ladder", ladder, known)
    return known[ladder]
