"""The figure of a study along its axes: the unrolled views along each, and a panel for each law."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from solver.problem.errors import InputError
from studies.grammar.axes import SAMPLE

from ..stored.stored_study import StoredStudy
from ..stored.trend_lines import LawLine, TrendLine
from ..words import labels
from . import canvas, drawn_rods, fonts, law_panel, print_heights, trends, unrolled
from .sheet import SCREEN, Sheet, set_range

BEND_LESS = "bend by less than the width of a line at one scale"  # of rods whose views are not drawn
LAW_HEIGHT = 3.2  # inches of a law at most
NARROW_LAW = 1.9  # inches of a law on a narrow sheet at most
MOST_CURVES = 9  # curves along an axis
MOST_IN_COLUMN = 5, 3  # on one column of a page, along one axis and along each of several
MOST_PLAIN = 4  # observables shown where there is no law
MOST_NARROW = 3  # panels of laws on one column of a page, one less with curves


def figure(
    stored: StoredStudy,
    verdicts: Sequence[Mapping[str, Any]] | None = None,
    sheet: Sheet = SCREEN,
    show: Sequence[str] = (),
    x: str | None = None,
) -> Figure:
    """Draw all of a study, or the observables that are asked for.

    For each axis of several values the unrolled views, below them each law in its panel (where there is no law, the
    first observables); of a refined study those of its coarse grid, along one axis with the observables of all cases.
    Samples with observables are no axis. The caption names the observables that it leaves out.

    Parameters
    ----------
    verdicts
        The rows of `stored_verdicts.verdicts` where they are known already; default: they are computed.
    sheet
        What the figure is drawn for. Its `panel` is an axis (the unrolled views along it), the claim of a law (of
        several laws of one claim also the claim with the observable), or any stored observable.
    show
        Observables; each has a panel, or a panel for each law on it, and nothing else is drawn.
    x
        The axis along which an observable without a law is drawn; default: the first of several values.

    Raises
    ------
    InputError
        The dataset's laws are invalid, there is nothing to draw, as no axis has several values, the figure has no such
        panel, or an observable is not stored.
    """
    rows = stored.verdicts if verdicts is None else verdicts
    whole, stored = stored, stored.line()
    if not stored.varied:
        raise InputError(
            "the file holds one case: each observable is one number, which workbench summary prints; "
            "the rod is drawn by the kind rod"
        )
    axes = [axis for axis in stored.varied if axis != SAMPLE or not stored.observables]
    if not axes:
        raise InputError("samples are drawn by the kind samples")
    along = stored.axis(x) if x else axes[0]
    laws = [stored.law_line(row) for row in rows]
    chosen = _choice(stored, laws, along, axes if unrolled.has_curve(whole) else [], show, sheet)
    most = len(chosen.panels)
    is_whole = sheet.panel is not None or bool(show) or sheet.style != "paper"
    most_curves = MOST_IN_COLUMN[len(chosen.strips) > 1] if sheet.narrow else MOST_CURVES
    rods = {name: drawn_rods.choose(whole, ("alpha", "z"), name, most=most_curves) for name in chosen.strips}
    if is_whole:
        return _figure_of(stored, rods, chosen, sheet)
    return print_heights.with_room(
        lambda count: _figure_of(stored, rods, _first_of(chosen, count, sheet.narrow), sheet),
        min(most, MOST_NARROW) if sheet.narrow else most,
    )


def _figure_of(
    stored: StoredStudy, rods_along: Mapping[str, drawn_rods.DrawnRods], chosen: "_Choice", sheet: Sheet
) -> Figure:
    """The figure of what is chosen; rods_along: axis -> the rods of its unrolled views."""
    count, width, title = len(chosen.panels), sheet.width, canvas.title_height(stored, sheet)
    strips_high = unrolled.STRIPS[not sheet.narrow] * width
    if sheet.style == "paper" and chosen.strips:
        rows_below = -(-count // (1 if sheet.narrow else 2))
        left = print_heights.TALLEST - title - rows_below * canvas.ROW - unrolled.LEGEND
        strips_high = min(strips_high, max(left / len(chosen.strips) - unrolled.LABELS, unrolled.LEAST_STRIP))
    laws = [line for line in chosen.panels if isinstance(line, LawLine)]
    across = 1 if sheet.narrow or not count else 3 if count == 3 and not laws else min(count, 2)
    law_height = min(LAW_HEIGHT, max(0.35 * width, canvas.PANEL))
    room = width - unrolled.BESIDE - sheet.normal * fonts.LINE, strips_high  # a label may have two lines
    views = {name: unrolled.panel_of(rods, room, sheet.small, coloured=False) for name, rods in rods_along.items()}
    straight = [name for name, view in views.items() if view.is_straight and sheet.panel is None and count]
    shown = {name: view for name, view in views.items() if name not in straight}
    if sheet.narrow:
        left = print_heights.TALLEST - title
        left -= sum(view.height + unrolled.LABELS for view in shown.values())
        left -= max((view.below for view in shown.values()), default=0.0)
        law_height = float(np.clip(left / max(count, 1), canvas.ROW, NARROW_LAW))
    titles = dict(zip(laws, law_panel.titles(laws, width / across - fonts.BESIDE, sheet.normal), strict=True))
    alike: dict[str, list[Axes]] = {}  # the panels of an observable, which have the same limits

    def draw(line: TrendLine, ax: Axes) -> canvas.Said:
        if isinstance(line, LawLine):
            said = [law_panel.panel(line, ax, titles[line])]
        else:
            said = []
            trends.trend(line, ax).set_label(labels.long_name(line.observable))
            canvas.add_legend(ax)
        said += trends.say_errors(line)
        set_range(sheet, ax, name := str(line.observable.name))
        alike.setdefault(name, []).append(ax)
        ends = np.array([other.get_ylim() for other in alike[name]])
        for other in alike[name]:
            other.set_ylim(ends.min(), ends.max())
        return said

    def strip(name: str, ax: Axes) -> canvas.Said:
        return [*views[name].draw(ax), *rods_along[name].said(), *rods_along[name].notes]

    lines: list[canvas.Row] = [(view.height + unrolled.LABELS, [partial(strip, name)]) for name, view in shown.items()]
    lines += canvas.in_rows([partial(draw, line) for line in chosen.panels], across, law_height, filled=True)
    said = [f"Unrolled, the rods along {labels.axis_symbol(name)} {BEND_LESS}." for name in straight]
    said += [trends.ALONE] * any(line.alone for line in chosen.panels)
    said += [trends.UNBENT] * any(bool(stored.unbent(str(line.observable.name)).any()) for line in chosen.panels)
    said += trends.say_gaps(chosen.panels)
    said += [*map(law_panel.caption_of, chosen.in_words), *chosen.level]
    said += labels.definitions(stored.expressions, _formulas(chosen))
    drawn = [str(line.observable.name) for line in chosen.panels]
    said += canvas.say_left_out([name for name in chosen.shown if name not in drawn], "--show or --panel")
    if not lines:
        why = " ".join(said) or "the dataset has neither observables nor the arrays alpha and z."
        raise InputError(f"nothing to draw: {why} workbench summary prints the numbers, workbench scene draws the rods")
    return canvas.page(stored, sheet, lines, said, 0.0)


@dataclass(frozen=True)
class _Choice:
    """What a figure shows.

    panels: laws, and observables without one. strips: axes with unrolled views. in_words: laws that the caption says
    and no panel shows. level: sentences about observables that are the same in all cases. shown: the other observables,
    of which the caption names those that no panel shows; none where panels were asked for.
    """

    panels: Sequence[TrendLine]
    strips: Sequence[str] = ()
    in_words: Sequence[LawLine] = ()
    level: Sequence[str] = ()
    shown: Sequence[str] = ()


def _choice(
    stored: StoredStudy,
    laws: Sequence[LawLine],
    along: str,
    strips: Sequence[str],
    show: Sequence[str],
    sheet: Sheet,
) -> _Choice:
    """What is drawn: the observables that are asked for, or the panel of the sheet, or by default all that has room.

    along: the axis of observables without a law. Raises `InputError` for an unknown panel, and for more observables
    than have room.
    """
    known = stored.observables
    names = stored.names_of_figure(show) if show else [] if laws else (stored.names_that_vary or known)[:MOST_PLAIN]
    on: dict[str, list[TrendLine]] = {name: [] for name in names}
    for law in laws:
        on.setdefault(str(law.observable.name), []).append(law)
    if show:
        return _Choice([line for name in names for line in on[name] or [stored.trend(name, along)]])
    if sheet.panel is None:
        level = stored.level_notes(name for name in known if name not in on)
        trivial = [law for law in laws if law.is_trivial or any(law.repeats(other) for other in laws)]
        panels: Sequence[TrendLine] = [law for law in laws if law not in trivial]
        if not panels:
            panels = [law for law in trivial if not (strips and law.is_level)]
            trivial = [law for law in trivial if law not in panels]
        if not laws:
            panels = [stored.trend(name, along) for name in names]
        return _Choice(panels, strips, trivial, level, stored.names_that_vary)
    named = _name(laws)
    every = [*strips, *(law.row["claim"] for law in laws), *named, *known]
    (panel,) = sheet.choose(dict.fromkeys(every))
    if panel in strips:
        return _Choice([], [panel])
    if panel in known:
        return _Choice([stored.trend(panel, along)])
    return _Choice([named[panel]] if panel in named else [law for law in laws if law.row["claim"] == panel])


def _formulas(chosen: _Choice) -> list[str]:
    """The names and formulas that panels and the laws of the caption show."""
    lines = [*chosen.panels, *chosen.in_words]
    formulas = [
        line.formulas.get(formula, formula)
        for line in lines
        if isinstance(line, LawLine) and isinstance(formula := line.row["rule"].get("formula"), str)
    ]
    return [*(name for line in lines for name in (str(line.observable.name), *line.states)), *formulas]


def _first_of(chosen: _Choice, most: int, narrow: bool) -> _Choice:
    """The first panels of what is chosen; narrow: a panel less beside unrolled views.

    Laws without a panel are said in the caption.
    """
    most -= narrow and bool(chosen.strips) and most > 2
    laws = [law for law in chosen.panels[most:] if isinstance(law, LawLine)]
    return replace(chosen, panels=chosen.panels[:most], in_words=[*laws, *chosen.in_words])


def _name(laws: Sequence[LawLine]) -> dict[str, LawLine]:
    """The laws that share their claim by names of their own: ``(4) bends``, with the axis where that is not enough."""
    claims = Counter(law.row["claim"] for law in laws)
    names = [f"{law.row['claim']} {law.row['observable']}" for law in laws]
    short = Counter(names)
    return {
        name if short[name] == 1 else f"{name} {law.row['axis']}": law
        for name, law in zip(names, laws, strict=True)
        if claims[law.row["claim"]] > 1
    }
