"""Lists of equilibria and of closed rods: their unrolled views in rows, and the energies."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from solver.orbits.forces import push_from
from solver.problem.errors import InputError, choices

from ..stored.stored_study import StoredStudy
from ..words import caution_words, labels
from . import canvas, colours, fonts, point_numbers, push_scale, unrolled
from .axis_scales import RoomLocator
from .sheet import SCREEN, Sheet
from .unrolled import UnrolledView

MOST = 8, 40  # shapes shown on one column of a page and elsewhere
HIGH = 1.6, 1.8  # inches of the diagram of energies there
DOT = 0.08  # inches from dot to dot that do not cover each other
MOST_LOOPS = 24  # closed rods shown
TALL = 1.0, 0.6  # the height of all views over the width of a column and of other pages
REACTIONS = ("FZ", "MZ", "M3", "beta0", "betaL")  # of held ends


def figure(stored: StoredStudy, sheet: Sheet = SCREEN, show: Sequence[str] = ()) -> Figure:
    """The unrolled views of all equilibria of one case in the order of energy, and below them an observable against
    the index.

    show: the observable; default: the energy. Raises `InputError` for one that is not stored, for several, and for an
    empty list.
    """
    (name,) = one_shown(stored.names_of(show)) or ("energy",)
    if not stored.sizes["equilibrium"]:
        raise InputError("there is no equilibrium to draw")
    count, high = min(stored.sizes["equilibrium"], MOST[not sheet.narrow]), HIGH[not sheet.narrow]
    reaction = next((name for name in REACTIONS if name in stored and stored[name].dims == ("equilibrium",)), None)
    texts = [f"{k + 1}" for k in range(count)]
    if reaction is not None:
        values = labels.values_alike(stored[reaction], stored[reaction].values[:count])
        heads = [f"{labels.symbol(stored[reaction])} = ", *[""] * (count - 1)]
        texts = [f"{text}: {head}{value}" for text, head, value in zip(texts, heads, values, strict=True)]
    shapes = [_shape(stored, k, texts[k], look(int(stored["index"][k]))) for k in range(count)]
    panel = unrolled.UnrolledPanel(
        shapes, _room(sheet), sheet.small, labels.unit(str(stored["z"].attrs.get("units", "1")))
    )
    shown = f"; {count} of {stored.sizes['equilibrium']} are shown" if count < stored.sizes["equilibrium"] else ""
    rows: list[canvas.Row] = [
        (panel.height, [lambda ax: [*_entries(stored["index"].values), *panel.draw(ax, shown)]]),
        (high, [lambda ax: against_index(stored, ax, name, high)]),
    ]
    counted = bool(stored.restable) and bool((stored["index"].values > 0).any())
    return canvas.page(stored, sheet, rows, ["A real rod keeps no unstable shape."] * counted, more=0.45)


def one_shown(names: Sequence[str]) -> Sequence[str]:
    """The names. Raises `InputError` for more than one, of a figure whose diagram shows one observable."""
    if len(names) > 1:
        raise InputError(f"this diagram shows one observable, got {len(names)}: {choices(names)}")
    return names


def against_index(stored: StoredStudy, ax: Axes, name: str, high: float) -> list[str]:
    """An observable against the index on axes so many inches high: a dot an equilibrium, filled where it is stable.

    Dots that would cover one another stand side by side.

    Returns what is to be said of them.
    """
    values = labels.in_label_unit(stored[name], stored[name].values)
    index = stored["index"].values
    ax.set_xlabel(fonts.wrap("Morse index: unstable directions", ax))
    ax.set_ylabel(fonts.fit_label(partial(labels.label, stored[name]), high - 0.3))
    ax.yaxis.set_major_locator(RoomLocator("counts" if name in stored.counts else "numbers"))
    ax.xaxis.set_major_locator(RoomLocator("counts"))
    ax.margins(0.04, 0.08)
    ax.update_datalim(np.stack([index, values], axis=1)[np.isfinite(values)])
    ax.autoscale_view()
    ax.set_xlim(*ax.get_xlim()), ax.set_ylim(*ax.get_ylim())
    if index.size and index.min() == index.max():
        ax.set_xlim(index.min() - 0.5, index.max() + 0.5)
    inches = fonts.inches(ax)[0], high - 0.5
    per = np.array(inches) / [np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())]
    aside = _side_by_side(index, values * per[1], per[0])
    for offset in np.unique(aside):  # the dots themselves keep their numbers
        at = aside == offset
        place = ax.transData + ScaledTranslation(offset, 0, ax.figure.dpi_scale_trans)
        look: dict[str, Any] = {"edgecolors": colours.INK, "linewidths": 0.9, "zorder": 3, "transform": place}
        ax.scatter(index[at], values[at], s=20, c=[("white" if k else colours.INK) for k in index[at]], **look)
    points = [
        point_numbers.NumberedPoint(float(x), float(y), f"{k + 1}")
        for k, (x, y) in enumerate(zip(index + aside / per[0], values, strict=True))
    ]
    point_numbers.write(ax, points, [], [], inches)
    noun, stability = (
        "equilibrium" if index.size == 1 else "equilibria",
        str(stored.attrs["stability"]).replace("M3", "M₃"),
    )
    said = [f"{index.size} {noun}, {int((index == 0).sum())} stable (filled): {stability}."]
    if "searched" in stored.attrs:
        said.append(f"Not proved complete: searched over {labels.minus_signs(stored.attrs['searched'])}.")
    return said


def _side_by_side(index: Any, up: Any, room: float) -> NDArray[np.float64]:
    """How far each dot stands beside its index, (n,) [inches], those of one index within `DOT` of the next one up side
    by side.

    up: the heights of the dots, (n,); room: from one index to the next [both inches].
    """
    aside, order = np.zeros(len(up)), np.lexsort([up.round(6), index])  # equal ones as they are listed
    ends = np.flatnonzero((np.diff(index[order]) > 0) | ~(np.diff(up[order]) < DOT)) + 1
    for row in np.split(order, ends):
        aside[row] = (np.arange(row.size) - (row.size - 1) / 2) * min(DOT, 0.8 * room / max(row.size, 1))
    return aside


def loops(stored: StoredStudy, sheet: Sheet = SCREEN) -> Figure:
    """The unrolled view of each closed rod at one scale, in the colours of the push, with its index and energy."""
    count = min(stored.sizes["equilibrium"], MOST_LOOPS)
    pushes = [push_from(stored["contact"].values[k], str(stored.attrs["side"])) for k in range(count)]
    norm, shapes = push_scale.scale(pushes), []
    energies = labels.values_alike(stored["energy"], stored["energy"].values[:count])
    for k in range(count):
        loop = stored.select({"equilibrium": k})
        index, waves = int(loop["index"]), int(loop["folds"])
        stable = f"unstable in {index} way{'s' * (index > 1)}" if index else "stable"
        text = f"{k + 1}: {waves} wave{'s' * (waves > 1)}\n{stable}\nenergy {energies[k]}"
        shapes.append(_shape(stored, k, text, {"push": pushes[k], "norm": norm}))
    unit = labels.unit(stored.units["length"])
    panel = unrolled.UnrolledPanel(shapes, _room(sheet), sheet.small, unit, bar=stored.units)
    said = [
        f"The rod lies {stored.attrs['side']}.",
        "The ways are those of a closed rod whose section is free to turn.",
    ]
    return canvas.page(stored, sheet, [(panel.height, [panel.draw])], said, panel.below)


def _room(sheet: Sheet) -> tuple[float, float]:
    """The inches of all views."""
    return sheet.width - unrolled.BESIDE, TALL[not sheet.narrow] * sheet.width


def _shape(stored: StoredStudy, k: int, text: str, how: dict[str, Any]) -> UnrolledView:
    """The unrolled view of an equilibrium, with rings where its caution says that it passes through itself."""
    case = stored.select({"equilibrium": k})
    crossed = "overlaps" in caution_words.keys(str(case["caution"].values)) if "caution" in case else False
    return unrolled.view_of(
        case["s"].values,
        float(case["rho"]),
        case["alpha"].values,
        case["z"].values,
        float(case["a"]),
        text,
        how,
        ringed=crossed,
    )[0]


def _entries(indices: Any) -> list[Any]:
    """The legend of the shapes and of the dots of their energies."""
    return [
        Line2D([], [], marker="o", markersize=4.5, label=word, markerfacecolor=colour, **look(index))
        for index, (word, colour) in enumerate((("stable", colours.INK), ("unstable", "white")))
        if ((indices == 0) == (index == 0)).any()
    ]


def look(index: int) -> dict[str, Any]:
    """The look of a shape: thick where it is stable."""
    return colours.of_line(colours.UNSTABLE if index else colours.STABLE)
