"""The figure of a stored study: its unrolled views along each axis, its samples, and a panel for each law."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from solver.problem.errors import InputError, no_such
from studies.grammar.axes import SAMPLE

from ..stored import selection
from ..stored.shown_observables import choose_observables
from ..stored.stored_study import StoredStudy
from ..words import labels
from . import along, canvas, colours, drawn_rods, print_heights, push_scale, trends, unrolled
from .law_panel import caption_of, is_trivial, panel
from .sheet import SCREEN, Sheet, set_range

LAW_HEIGHT, LEAST_LAW = 3.2, 2.4  # inches
ONE_ROD = 0.55  # the share of the least height of a narrow panel of one rod
NARROW_LAW, LEAST_STRIP = 1.9, 0.9  # inches of a law on a narrow sheet at most; of unrolled views in print at least
SAMPLES = "samples"  # the panel of the scatter diagrams
MOST_CURVES, STRIPS = 9, (0.7, 0.42)  # curves along an axis; their height over a narrow and another width
LABELS = 0.35  # inches below and above curves
LEGEND = 1.25  # inches of the legend of one rod, and around its view
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

    With axes: for each axis of several values the unrolled views, below them each law in its panel (where there is
    no law, the first observables); of a refined study those of its coarse grid, along one axis with the observables of
    all cases. With samples: each observable against each sampled field. One case alone: its angle, its push and its
    unrolled view. The caption names the observables that it leaves out.

    Parameters
    ----------
    verdicts
        The rows of `law_verdicts.verdicts` where they are known already; default: they are computed.
    sheet
        What the figure is drawn for. Its `panel` is an axis (the unrolled views along it), the claim of a law (of
        several laws of one claim also the claim with the observable), any stored observable, or ``samples``.
    show
        Observables; each has a panel, or a panel for each law on it, and nothing else is drawn.
    x
        The axis along which an observable without a law is drawn; default: the first of several values.

    Raises
    ------
    InputError
        The dataset's laws are invalid, there is nothing to draw, the figure has no such panel, or an observable is not
        stored.
    """
    rows = stored.verdicts if verdicts is None else verdicts
    whole, stored = stored, stored.line()
    axes = [axis for axis in stored.axes if stored.sizes[axis] > 1]
    if not axes:
        if show:
            raise InputError("the file holds one case: each observable is one number, which workbench summary prints")
        return one_rod(stored, sheet)
    is_sampled = SAMPLE in axes and bool(stored.observables)
    axes = [axis for axis in axes if not (is_sampled and axis == SAMPLE)]
    chosen = _choice(stored, rows, axes if unrolled.has_curve(whole) else [], is_sampled, sheet.panel, show)
    axis_of_trends = stored.axis(x) if x else next(iter(axes), "")
    most = len(chosen.sampled or chosen.panels)
    is_whole = sheet.panel is not None or bool(show) or sheet.style != "paper"
    strips = (chosen if is_whole else _first_of(chosen, most, sheet.narrow)).strips
    rods = {name: drawn_rods.choose(whole, ("alpha", "z"), name, most=MOST_CURVES) for name in strips}
    if is_whole:
        return _figure_of(stored, rods, chosen, sheet, axis_of_trends)
    return print_heights.with_room(
        lambda count: _figure_of(stored, rods, _first_of(chosen, count, sheet.narrow), sheet, axis_of_trends),
        min(most, MOST_NARROW) if sheet.narrow and not chosen.sampled else most,
    )


def _figure_of(
    stored: StoredStudy, rods_along: Mapping[str, drawn_rods.DrawnRods], chosen: "_Choice", sheet: Sheet, axis: str
) -> Figure:
    """The figure of what is chosen; rods_along: axis -> the rods of its unrolled views. axis: of trends."""
    sampled, count, width = chosen.sampled, len(chosen.panels), sheet.width
    strips_high = STRIPS[not sheet.narrow] * width
    if sheet.style == "paper" and chosen.strips:
        rows_below = -(-count // (1 if sheet.narrow else 2))
        left = print_heights.TALLEST - canvas.TITLE * sheet.titled - rows_below * canvas.ROW
        strips_high = min(strips_high, max(left / len(chosen.strips) - LABELS, LEAST_STRIP))
    has_laws = any(not isinstance(drawn, str) for drawn in chosen.panels)
    across = 1 if sheet.narrow else 3 if count == 3 and not has_laws else min(count, 2)
    law_height = min(LAW_HEIGHT, max(0.35 * width, LEAST_LAW))
    room = width - unrolled.BESIDE, strips_high
    views = {name: unrolled.panel_of(rods, room, sheet.small, coloured=False) for name, rods in rods_along.items()}
    straight = [name for name, view in views.items() if view.is_straight and sheet.panel is None and count]
    shown = {name: view for name, view in views.items() if name not in straight}
    if sheet.narrow:
        left = print_heights.TALLEST - canvas.TITLE * sheet.titled
        left -= sum(view.height + LABELS for view in shown.values())
        law_height = float(np.clip(left / max(count, 1), canvas.ROW, NARROW_LAW))

    def law_of(one: Any, ax: Axes) -> canvas.Said:
        if not isinstance(one, str):
            said = panel(stored, ax, one)
            set_range(sheet, ax, one["observable"])
            return [said]
        trends.trend(stored, ax, one, axis).set_label(labels.long_name(stored[one]))
        set_range(sheet, ax, one)
        canvas.add_legend(ax)
        return []

    def strip(name: str, ax: Axes) -> canvas.Said:
        ax.set_label(f"unrolled views along {name}")
        return [*views[name].draw(ax), *rods_along[name].said(), *rods_along[name].notes]

    lines: list[canvas.Row] = [(view.height + LABELS, [partial(strip, name)]) for name, view in shown.items()]
    laws_of = [partial(law_of, drawn) for drawn in chosen.panels]
    lines += canvas.in_rows(laws_of, across, law_height, filled=True)
    said = [f"Unrolled, the rods along {labels.axis_symbol(name)} are straight lines." for name in straight]
    if sampled:
        wide = sheet.style == SCREEN.style and not sheet.narrow
        width = max(width, trends.LEAST_WIDTH * len(stored.sampled) + 0.8) if wide else width
        diagrams, sentence = trends.samples(stored, sampled, width, sheet.narrow)
        lines, said = lines + diagrams, [sentence]
    said += [trends.ALONE] * bool(chosen.panels and stored.stand_alone)
    said += [*(caption_of(stored, law) for law in chosen.in_words), *chosen.level]
    said += canvas.say_left_out(chosen.left_out, "--show or --panel")
    if not lines:
        why = " ".join(said) or "the dataset has neither observables nor the arrays alpha and z."
        raise InputError(f"nothing to draw: {why} workbench summary prints the numbers, workbench scene draws the rods")
    return canvas.page(stored, sheet, lines, said, 0.3 * bool(sampled), width=width)


def one_rod(stored: StoredStudy, sheet: Sheet = SCREEN) -> Figure:
    """The angle, the push and the unrolled view of one rod; what is not stored is left out. Raises `InputError`."""
    needs = {"angle": "beta", "push": "contact", "curve": "alpha"}
    names = [panel for panel in sheet.choose(needs) if needs[panel] in stored]
    if not names:
        raise no_such("panel", sheet.panel, needs)
    coloured = "contact" in stored
    arrays = {"angle": ["beta"], "push": ["push"], "curve": ["alpha", "z"] + ["push"] * coloured}
    rods = drawn_rods.choose(stored, list(dict.fromkeys(name for panel in names for name in arrays[panel])))
    high, each = STRIPS[not sheet.narrow] * sheet.width, LEAST_LAW * max(min(sheet.width / SCREEN.width, 1.0), ONE_ROD)
    if sheet.style == "paper":
        each = max(each, canvas.ROW)
        high = min(high, max(print_heights.TALLEST - each * (len(names) - 1) - LEGEND, LEAST_STRIP))
    room = sheet.width - unrolled.BESIDE, high
    view = unrolled.panel_of(rods, room, sheet.small, coloured) if "curve" in names else None

    def curve(ax: Axes) -> canvas.Said:
        assert view is not None
        pulled = coloured and "push" not in names and any(push_scale.pulls(rod["push"]) for rod in rods.solved)
        return [*[Line2D([], [], color=colours.PULLED, linewidth=2.2, label=push_scale.PULLS)] * pulled, *view.draw(ax)]

    def over_s(name: str, ax: Axes) -> canvas.Said:
        said = along.alone(ax, rods, arrays[name][0])
        if sheet.narrow and name == "angle" and names[1:2] == ["push"]:  # the panel below has the same s
            ax.set_xlabel("")
            ax.tick_params(labelbottom=False)
        return said

    rows: list[canvas.Row] = [
        (view.height + LABELS, [curve]) if view and name == "curve" else (each, [partial(over_s, name)])
        for name in names
    ]
    return canvas.page(stored, sheet, rows, rods.notes)


@dataclass(frozen=True)
class _Choice:
    """What a figure shows.

    panels: rows of `law_verdicts.verdicts`, and names of observables. strips: axes with unrolled views. sampled:
    observables in scatter diagrams. in_words: rows of laws that the caption says and no panel shows. level: sentences
    about observables that are the same in all cases. left_out: stored observables that nothing of the figure shows.
    """

    panels: Sequence[Any]
    strips: Sequence[str] = ()
    sampled: Sequence[str] = ()
    in_words: Sequence[Any] = ()
    level: Sequence[str] = ()
    left_out: Sequence[str] = ()


def _choice(
    stored: StoredStudy,
    rows: Sequence[Mapping[str, Any]],
    strips: Sequence[str],
    is_sampled: bool,
    panel: str | None,
    show: Sequence[str],
) -> _Choice:
    """What is drawn: the observables that are asked for, or the panel of that name, or by default all that has room.

    Raises `InputError` for an unknown panel, and for more observables than have room.
    """
    known, laws = stored.observables, _name(rows)
    free = 0 if rows or is_sampled else MOST_PLAIN
    names, without_room = choose_observables(stored, show, free, most_level=free)
    if show and is_sampled:
        return _Choice([], sampled=names)
    if show:
        laws_on: dict[str, list[Any]] = {name: [row for row in rows if row["observable"] == name] for name in names}
        return _Choice([entry for name in names for entry in laws_on[name] or [name]])
    if panel is None:
        shown = {*names, *(row["observable"] for row in rows), *(known if is_sampled else ())}
        level = level_notes(stored, [name for name in known if name not in shown])
        left_out = [name for name in without_room if name not in shown]
        trivial = [row for row in rows if is_trivial(stored, row)]
        shown_laws = [row for row in rows if not is_trivial(stored, row)]
        if not (shown_laws or strips or is_sampled):
            trivial, shown_laws = [], trivial
        return _Choice(shown_laws if rows else names, strips, known if is_sampled else (), trivial, level, left_out)
    panels = [*strips, *(str(row["claim"]) for row in rows), *laws, *known, *([SAMPLES] if is_sampled else [])]
    if panel not in panels:
        raise no_such("panel", panel, dict.fromkeys(panels))
    if panel in strips:
        return _Choice([], [panel])
    if panel in known or panel == SAMPLES:
        return _Choice([], sampled=known if panel == SAMPLES else [panel]) if is_sampled else _Choice([panel])
    return _Choice([laws[panel]] if panel in laws else [row for row in rows if row["claim"] == panel])


def _first_of(chosen: _Choice, most: int, narrow: bool) -> _Choice:
    """The first panels of what is chosen; narrow: with unrolled views along one axis, and a panel less beside them.

    Laws without a panel are said in the caption.
    """
    if chosen.sampled:
        left = [name for name in chosen.sampled[most:]]
        return replace(chosen, sampled=chosen.sampled[:most], left_out=[*left, *chosen.left_out])
    strips, most = (chosen.strips[:1], most - bool(chosen.strips and most > 2)) if narrow else (chosen.strips, most)
    rest = chosen.panels[most:]
    laws, names = [row for row in rest if not isinstance(row, str)], [name for name in rest if isinstance(name, str)]
    views = [f"views along {labels.axis_symbol(axis)}" for axis in chosen.strips[len(strips) :]]
    return replace(
        chosen,
        panels=chosen.panels[:most],
        strips=strips,
        in_words=[*laws, *chosen.in_words],
        left_out=[*names, *views, *chosen.left_out],
    )


def level_notes(stored: StoredStudy, names: Sequence[str]) -> list[str]:
    """A sentence about each observable that is the same in all cases, or in all that have a number."""
    is_true_or_false = re.compile(r"[<>]|==|!=|\b(and|or|not)\b")  # an expression
    texts = []
    for array, ends in ((stored[name], stored.level(name)) for name in names if stored.is_level(name)):
        noun, holds, where = labels.long_name(array), bool(round(sum(ends) / 2)), selection.known_cases(array)
        if flag := re.fullmatch("1 where (.*), else 0", noun):
            none = "no case" if where.startswith("all") else f"none of {where}"
            said = f"{flag[1]} in {where if holds else none}."
        elif is_true_or_false.search(str(array.attrs.get("expression", ""))):
            said = f"{noun}: {'true' if holds else 'false'} in {where}."
        else:
            said = f"{noun}: {labels.level(array, *ends)} in {where}."
        texts.append(said[0].upper() + said[1:])
    return texts


def _name(rows: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """The laws that share their claim by names of their own: ``(4) bends``, with the axis where that is not enough."""
    claims = Counter(row["claim"] for row in rows)
    names = [f"{row['claim']} {row['observable']}" for row in rows]
    short = Counter(names)
    return {
        name if short[name] == 1 else f"{name} {row['axis']}": row
        for name, row in zip(names, rows, strict=True)
        if claims[row["claim"]] > 1
    }
