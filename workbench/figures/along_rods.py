"""Quantities along the rods of an axis: a panel a quantity, in it a curve a rod, one above the other over s.

One rod alone has an axis of numbers in each panel. The states of a rod with weight (straight, sinusoidal, helical) are
colours of its angle beta; in the picture of a pipe they are shades behind its azimuth, which is drawn within one turn
and has the colours of the push.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Affine2D

from solver.problem.errors import InputError, check_known
from studies.laws.line_verdicts import NOISE

from ..stored import quantity_variables
from ..stored.stored_study import StoredStudy
from ..words import labels, unit_habits
from . import canvas, colours, drawn_rods, fonts, pipe_map, push_scale, regions, waves
from .axis_scales import RoomLocator, round_below
from .drawn_rods import DrawnRods
from .sheet import SCREEN, Sheet

PANELS = ("beta", "kappa", "push")
STATES, PIPE = "states", "pipe"  # panels that are no array
ARRAYS = {STATES: ("beta", "alpha", "push"), PIPE: ("alpha", "beta", "push")}  # what they need; the first is drawn
TITLES = {"beta": "angle β to the axis", "kappa": "curvature κ"}
NO_STATES = "a state (straight, sinusoidal, helical) is that of a rod with weight"
# behind a curve where the cylinder would have to pull
PULLS: dict[str, Any] = {
    "color": colours.PULLED,
    "linewidth": 3.6,
    "solid_capstyle": "round",
    "label": "would lift off",
}
MOST, MOST_PANELS = 60, 6  # rods of a map; panels
CLEAR = 1.25  # the step from one curve to the next over the least at which no curve reaches the next
# inches: of one curve, alone or beside other panels; of a panel, least and most; of all panels on a narrow sheet
EACH, TALL, NARROW = (0.55, 0.45), (1.9, 7.2), (1.0, 6.0)
SHADE, PIPE_STEP = 0.25, 1.15  # opacity of the states of a pipe; from one pipe to the next over the height of each
TEXT = 1.45  # heights of a letter from one line of text to the next


def figure(
    stored: StoredStudy,
    x: str | None = None,
    at: Mapping[str, float] | None = None,
    show: Sequence[str] = (),
    sheet: Sheet = SCREEN,
) -> Figure:
    """Draw quantities along s for the rods along an axis, a panel for each.

    The curves of a panel share one scale, which the bar at its right shows, and are offset; the value of the axis
    stands at the left of its line, where the quantity is 0; where 0 is far from all curves, the title names another.

    Parameters
    ----------
    stored : StoredStudy
    x, at
        As `axis` and `at` of `drawn_rods.choose`.
    show : sequence of str
        Arrays along the rod, ``states`` or ``pipe``; default: beta, kappa and push.
    sheet : Sheet
        What the figure is drawn for. Its panel is one of them.

    Raises
    ------
    InputError
        As of `drawn_rods.choose`, for an unknown panel, and for states of rods without weight.
    """
    names = list(dict.fromkeys([sheet.panel] if sheet.panel else show or PANELS))
    known = dict.fromkeys(
        [
            *PANELS,
            *ARRAYS,
            *(name for name in quantity_variables.CURVES.values() if name not in quantity_variables.INNER),
        ]
    )
    for name in names:
        check_known("panel", name, known)
    names = names[:MOST_PANELS]
    if STATES in names and not stored.loads_vary:
        raise InputError(f"{NO_STATES}, and the rods of this file have none; choose --kind ridge or pipe")
    arrays = dict.fromkeys(a for n in names for a in ARRAYS.get(n, (n,)))
    rods = drawn_rods.choose(stored, [*arrays], x, at, MOST if names == [PIPE] else None)
    no_states = [f"No states: {NO_STATES}."] * (PIPE in names and not stored.loads_vary)
    notes = [*rods.said(), *rods.notes, *no_states]
    notes += [pipe_map.SLIGHT_BENDS] * (not {STATES, PIPE}.isdisjoint(names) and bool(pipe_map.words(rods)))
    if names == [PIPE] and len(rods.rods) >= pipe_map.LEAST:
        return pipe_map.figure(rods, sheet, notes)
    if not (show or sheet.panel):
        names, level = without_level(rods, names)
        notes += level
    longest = max(float(rod["s"][-1]) for rod in rods.solved)
    inches = max(sheet.width / (1 if sheet.narrow else len(names)) - fonts.BESIDE, 0.5) / longest
    curves = [_curves(rods, name, inches) for name in names]
    ends = min(curve.ends[0] for curve in curves), max(curve.ends[1] for curve in curves)
    tall = float(np.clip(EACH[len(names) > 1] * (ends[1] - ends[0]), *TALL))
    if sheet.narrow:
        tall = float(np.clip(tall, NARROW[0], NARROW[1] / len(names)))

    def panel(i: int, ax: Axes) -> canvas.Said:
        said = _panel(ax, rods, curves[i], ends, tall, labelled=sheet.narrow or i == 0)
        if sheet.narrow and i < len(names) - 1:
            ax.xaxis.label.set_visible(False)
            ax.tick_params(labelbottom=False)
        return said

    panels = [partial(panel, i) for i in range(len(names))]
    rows: list[canvas.Row] = [(tall + 0.3, [single]) for single in panels] if sheet.narrow else [(tall + 0.75, panels)]
    faint = names != [PIPE] and any(not curve.foot for curve in curves)
    said = ["Faint line: where the quantity of a rod is 0."] * faint + notes
    return canvas.page(rods.source, sheet, rows, said, 0.75)


states, pipe = partial(figure, show=(STATES,)), partial(figure, show=(PIPE,))


def without_level(rods: DrawnRods, names: Sequence[str], alone: bool = True) -> tuple[list[str], list[str]]:
    """The quantities that are not the same all along all rods, and a sentence on each other one. alone: whether nothing
    else is drawn: then all are, where each is the same."""
    level = {name: text for name in names if name not in ARRAYS and (text := _level(rods, name))}
    if alone and len(level) == len(names):
        return [*names], []
    return [name for name in names if name not in level], [*level.values()]


def _level(rods: DrawnRods, name: str) -> str:
    """The sentence on a quantity that is the same all along all rods but for rounding; else nothing."""
    values = np.concatenate([rod[name] for rod in rods.solved])
    low, high = float(values.min()), float(values.max())
    if high - low > NOISE * max(abs(low), abs(high)):
        return ""
    symbol, unit, change = _words(rods.source, name)
    value = labels.powers_of_ten(labels.number(float(change((low + high) / 2)) + 0.0))  # no −0
    whose = "the rod" if len(rods.rods) == 1 else "all rods"
    return labels.sentence(f"{TITLES.get(name, symbol)}: {value}{unit} along {whose}")


@dataclass(frozen=True, eq=False)
class Curves:
    """The curves of one panel.

    values: of each rod in the unit of the panel, None where it is not solved. unit: with a blank before it where one
    stands. foot: the value at the line of a curve. step: from one curve to the next. size: the largest range. ends: the
    lowest and the highest point of all curves in steps from the line of the first. inches: of a unit of s.
    """

    name: str
    title: str
    unit: str
    values: list[Any]
    foot: float
    step: float
    size: float
    ends: tuple[float, float]
    inches: float


def _curves(rods: DrawnRods, name: str, inches: float) -> Curves:
    """The curves of one quantity, so far from each other that none reaches the next."""
    shown = ARRAYS.get(name, (name,))[0]
    _, unit, change = _words(rods.source, shown)
    title = TITLES.get(shown, labels.symbol_of(shown))
    if name == PIPE:
        title = "azimuth α" + "; shade: the state" * rods.source.loads_vary
    values = [change(rod[shown]) if rod.arrays is not None else None for rod in rods.rods]
    if name == PIPE:
        values = [value if value is None else (value + 180) % 360 - 180 for value in values]
    drawn = [(k, float(value.min()), float(value.max())) for k, value in enumerate(values) if value is not None]
    low, high = min(least for _, least, _ in drawn), max(most for _, _, most in drawn)
    far = low > 2 * (high - low) or high < -2 * (high - low)  # 0 lies far from all curves
    foot = low if far and name != "push" and high - low > NOISE * max(abs(low), abs(high)) else 0.0
    size = max(max(most, foot) - min(least, foot) for _, least, most in drawn) or 1.0
    if name == PIPE:
        size = max(2 * max(high, -low), 1.0)  # less than a degree is that of a straight pipe
        step, drawn = PIPE_STEP * size, [(k, -size / 2, size / 2) for k in range(len(values))]
    else:
        apart = name == "push" or (not foot and low >= 0)  # no curve crosses the line of another
        reach = max(max(most - foot, foot - least) for _, least, most in drawn)  # no curve passes the next line
        step = max(_clear_step(rods, values, foot, apart, inches), reach) or 1.0
    ends = (
        min(0.0, *(k + (least - foot) / step for k, least, _ in drawn)),
        max(len(values) - 1.0, *(k + (most - foot) / step for k, _, most in drawn)),
    )
    return Curves(name, title, unit, values, foot, step, size, ends, inches)


def _clear_step(rods: DrawnRods, values: Sequence[Any], foot: float, filled: bool, inches: float) -> float:
    """From the line of one curve to the next, so that no curve reaches the next one; filled: nor its line.

    A rod that is not solved has its line, on which that is written. inches: of a unit of s.
    """
    bare = np.array([0.0, max(float(rod["s"][-1]) for rod in rods.solved)]), np.zeros(2), np.zeros(2)
    rows = [
        bare if heights is None else waves.outline(rod["s"], heights - foot, inches)
        for rod, heights in zip(rods.rods, values, strict=True)
    ]
    most = 0.0
    for (s, _, low), (s_next, high, _) in pairwise(rows):
        above = np.interp(s, s_next, high, right=np.inf)
        most = max(most, float((np.maximum(low, 0) - np.minimum(above, 0) if filled else low - above).max()))
    return CLEAR * most


def _words(stored: StoredStudy, name: str) -> tuple[str, str, Callable[[Any], Any]]:
    """The name of an array along the rod, its unit, and what brings its numbers into it."""
    known = "push_max" if name == "push" else name
    unit, size = labels.unit(unit_habits.unit_shown(known, stored.units)), unit_habits.size_shown(known, stored.units)
    if unit == "rad":
        return labels.symbol_of(name), "°", np.degrees
    return labels.symbol_of(name), f" {unit}" if unit else "", partial(np.multiply, size)


def _panel(
    ax: Axes, rods: DrawnRods, curves: Curves, ends: tuple[float, float], tall: float, labelled: bool
) -> list[str]:
    """One quantity of all rods, on axes of that height in inches; returns what is to be said of it.

    ends: of all panels, in steps.
    """
    if len(rods.rods) == 1 and curves.name not in ARRAYS:
        return alone(ax, rods, curves.name)
    said = _draw_curves(ax, rods, curves)
    margin = 0.02 * (ends[1] - ends[0]) or 1.0  # about rods that are straight
    ax.set_ylim(curves.foot + (ends[0] - margin) * curves.step, curves.foot + (ends[1] + margin) * curves.step)
    _over_s(ax, rods)
    if curves.name == PIPE:
        push_scale.bar(ax, rods.source.units, fonts.inches(ax)[0])
    if len(rods.rods) == 1 and curves.name == PIPE:
        ax.set_ylabel("azimuth α [°]")
        ax.set_title(fonts.wrap(curves.title, ax), loc="left")
        ax.yaxis.set_major_locator(RoomLocator("angles"))
        return said
    _name_curves(ax, rods, curves, tall, labelled)
    _bar(ax, curves)
    return said


def _over_s(ax: Axes, rods: DrawnRods) -> None:
    ax.set_xlim(0, max(float(rod["s"][-1]) for rod in rods.solved))
    ax.set_xlabel(f"arc length  s [{labels.unit(rods.source.units['length'])}]")


def alone(ax: Axes, rods: DrawnRods, name: str) -> list[str]:
    """A quantity of one rod over s, on an axis of its numbers; shaded where the cylinder would have to pull.

    Returns what is to be said of it.
    """
    rod, (title, unit, change) = rods.solved[0], _words(rods.source, name)
    s, values = rod["s"], change(rod[name])
    inches = fonts.inches(ax)[0] / float(s[-1])
    if name == "push":
        said = push_scale.line(ax, s, values, values, push_scale.scale([values]), 1.6, order=3, inches=inches)
        _shade_pulls(ax, s, values)
    else:
        look = {"color": colours.DATA, "linewidth": 1.8, "gid": rod.name}
        said = waves.draw(ax, s, values, inches, look)
    ax.axhline(0, color=colours.SOFT, linewidth=0.8)
    ax.set_ylabel(f"{title} [{unit.strip()}]" if unit.strip() else title)
    words = TITLES | {"beta": "angle from the axis to the tangent", "push": "push of the cylinder per length"}
    ax.set_title(fonts.wrap(words.get(name, title), ax), loc="left")
    if unit == "°":
        ax.yaxis.set_major_locator(RoomLocator("angles"))
    _over_s(ax, rods)
    return said


def _shade_pulls(ax: Axes, s: Any, push: Any) -> None:
    """Shade the stretches where the cylinder would have to pull."""
    pulled = push_scale.pulls(push)
    if not pulled.any():
        return
    ax.fill_between(s, 0, 1, where=pulled, transform=ax.get_xaxis_transform(), color=colours.PULLED, alpha=0.14,
                    linewidth=0, label=push_scale.PULLS)  # fmt: skip
    ax.fill_between(s, 0, push, where=~pulled, color=colours.PUSHED, alpha=0.25, linewidth=0, label=push_scale.PUSHES)


def _draw_curves(ax: Axes, rods: DrawnRods, curves: Curves) -> list[str]:
    """Draw the curves of all rods, each at its offset; returns what is to be said of them."""
    count, step, foot = len(curves.values), curves.step, curves.foot
    states = pipe_map.words(rods) if curves.name in ARRAYS else {}
    shades = colours.ramp_colours(count)
    shown = [values for values in curves.values if values is not None] if curves.name == "push" else []
    shown = [push_scale.away_from_ends(rod["push"]) for rod in rods.solved] if curves.name == PIPE else shown
    norm = push_scale.scale(shown)
    width, inches, said = float(np.clip(16 / count, 0.7, 1.4)), curves.inches, list[str]()
    for k, (rod, values) in enumerate(zip(rods.rods, curves.values, strict=True)):
        ax.axhline(k * step + foot, color=colours.FAINT, linewidth=0.6, zorder=1)
        order = 3 + 0.9 * (count - k) / count  # the lower curve stands before the upper one
        where = Affine2D().translate(0, k * step) + ax.transData
        if values is None:
            ax.text(
                0.5,
                k * step + foot,
                rod.why,
                transform=ax.get_yaxis_transform(),
                ha="center",
                va="bottom",
                color=colours.SOFT,
                size=fonts.small(),
                zorder=4,  # before the curves, whose neighbour may pass here
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0},
            )
            continue
        s, push = rod["s"], rod["push"] if curves.name in ARRAYS else values
        if curves.name == "push":
            for side, colour, words, occurs in (
                (np.maximum(values, 0), colours.PUSHED, push_scale.PUSHES, push_scale.pulls(-push).any()),
                (np.minimum(values, 0), colours.PULLED, push_scale.PULLS, push_scale.pulls(push).any()),
            ):
                if occurs:
                    ax.fill_between(
                        s, 0, side, color=colour, alpha=0.25, linewidth=0, transform=where, zorder=order, label=words
                    )
        if curves.name in ("push", PIPE):
            for of in _unbroken(s, values, inches) if curves.name == PIPE else [slice(0, s.size)]:
                said += push_scale.line(ax, s[of], values[of], push[of], norm, width, rod.name, where, order, inches)
            if curves.name == PIPE and rods.source.leaves:
                off = np.where(push > 0, np.nan, values)
                off[1:][np.abs(np.diff(values)) > 180] = np.nan
                ax.plot(s, off, **push_scale.OFF_WALL, linewidth=width, transform=where, zorder=order + 0.01)
        elif curves.name != STATES:
            look = {"color": shades[k], "linewidth": 1.1, "gid": rod.name}
            said += waves.draw(ax, s, values, inches, look, where, order)
        if curves.name not in ARRAYS:
            continue
        for state in pipe_map.states_of(rods, rod):
            look = {
                "color": colours.STATES[state.word],
                "label": states.get(state.word, state.word),
                "gid": f"{rod.name}, {state.word}",
            }
            if curves.name == STATES:
                part = (s >= state.begin) & (s <= state.end)
                said += waves.draw(ax, s[part], values[part], inches, look, where, order, label=look["label"])
                continue
            ends, half = [state.begin, state.end], curves.size / 2
            ax.fill_between(ends, -half, half, alpha=SHADE, linewidth=0, transform=where, zorder=0.5, **look)
        if curves.name == PIPE:
            continue
        _, first, after = regions.runs(push_scale.pulls(push)[None])
        for of in map(slice, first, after):
            ax.plot(s[of], values[of], **PULLS, transform=where, zorder=order - 0.01, gid=f"{rod.name}, would lift off")
    return said


def _unbroken(s: Any, values: Any, inches: float) -> list[slice]:
    """The parts of an azimuth within one turn between which it goes on at the other edge, but in bands of waves."""
    breaks = np.flatnonzero(np.abs(np.diff(values)) > 180) + 1
    bands = [stretch.of for stretch in waves.stretches(s, values, inches) if stretch.band]
    cuts = [k for k in breaks.tolist() if not any(of.start < k < of.stop for of in bands)]
    return [slice(*ends) for ends in pairwise([0, *cuts, s.size])]


def _name_curves(ax: Axes, rods: DrawnRods, curves: Curves, tall: float, labelled: bool) -> None:
    """The values of the axis at the left of their curves, as many as have room."""
    lines = tall * curves.step / float(np.ptp(ax.get_ylim())) / (fonts.small() * TEXT / 72)  # of text between two
    shown = range(0, len(rods.rods), max(int(np.ceil(1 / lines)), 1))
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    ax.set_yticks([curves.foot + k * curves.step for k in shown], [rods.rods[k].value * labelled for k in shown])
    if rods.axis is not None:
        ax.set_ylabel(fonts.fit_label(partial(labels.axis_label, rods.source[rods.axis]), 0.9 * tall))
    ax.yaxis.label.set_visible(labelled)


def _bar(ax: Axes, curves: Curves) -> None:
    """The title of a panel, and at its right edge a bar of a round length with its value."""
    turns = [degrees for degrees in (1, 2, 5, 10, 30, 45, 90, 180, 360) if degrees <= curves.size * (1 + 1e-9)]
    length = turns[-1] if curves.unit == "°" and turns else round_below(curves.size)
    top = ax.get_ylim()[1]
    where = ax.get_yaxis_transform("grid")
    ax.plot(
        [1.01, 1.01],
        [top - length, top],
        color=colours.INK,
        linewidth=1.6,
        solid_capstyle="butt",
        clip_on=False,
        transform=where,
    )
    words = labels.powers_of_ten(labels.number(length)) + curves.unit.replace(" 1/", "/")
    ax.annotate(words, (1.01, top - length / 2), (3, 0), where,
                "offset points", va="center", rotation=90, size=fonts.small(), annotation_clip=False)  # fmt: skip
    foot = f"; line: {labels.powers_of_ten(labels.number(curves.foot))}{curves.unit}" if curves.foot else ""
    ax.set_title(fonts.wrap(f"{curves.title}{foot}", ax), loc="left")
