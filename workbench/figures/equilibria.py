"""Lists of equilibria and of closed rods: their unrolled views in frames, and the energies."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, log10
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from solver.mechanics.statics import push_from

from ..data import labels
from . import canvas, legend, point_numbers, push_scale, style
from .sheet import SCREEN, Sheet

FILL, FOOT = 0.88, 0.12  # of a frame: what a curve fills, and the strip of the bar at its foot
BAR = 0.5  # of the width of a frame: the longest bar
MOST = 8, 40  # frames shown on one column of a page and elsewhere
BESIDE, AROUND = 0.22, 0.56  # inches between frames: to the right, and with their texts from row to row
NEARLY = 0.85  # of the largest scale is enough for frames in fewer rows
TALL = 0.25, 0.65  # the height of all frames over the width of a column and of other pages
HIGH = 1.7, 2.9  # inches of the diagram of energies there
MOST_LOOPS = 24  # closed rods shown
REACTIONS = ("FZ", "MZ", "M3", "beta0", "betaL")  # of held ends


def figure(ds: xr.Dataset, sheet: Sheet = SCREEN) -> Figure:
    """The unrolled views of all equilibria of one case in the order of energy, and below them energy against index."""
    count, high = min(ds.sizes["equilibrium"], MOST[not sheet.narrow]), HIGH[not sheet.narrow]
    reaction = next((name for name in REACTIONS if name in ds and ds[name].dims == ("equilibrium",)), None)
    words = "the energy" if reaction is None else f"{labels.symbol(ds[reaction])} and the energy"
    unit = labels.unit(str(ds["z"].attrs.get("units", "1")))
    curves = [_curve(ds, k) for k in range(count)]
    form = frames(curves, sheet.width, TALL[not sheet.narrow] * sheet.width)

    def draw(fig: Figure) -> None:
        grid = fig.add_gridspec(2, 1, height_ratios=[form.height, high])
        cells = grid[0].subgridspec(form.rows, form.columns)
        for k in range(count):
            one = ds.isel(equilibrium=k)
            values = [one[name] for name in (reaction, "energy") if name is not None]
            below = ", ".join(labels.value(float(value), value) for value in values)
            index = int(one["index"])
            ax = fig.add_subplot(cells[k // form.columns, k % form.columns])
            title = f"{k + 1}: {stability(index, form.room)}"
            draw_frame(ax, curves[k], look(index), unit * (k == 0), title, below, form.size)
        energies(ds, fig.add_subplot(grid[1]), sheet.width, high)
        some = f"; {count} of {ds.sizes['equilibrium']} are shown" if count < ds.sizes["equilibrium"] else ""
        some = form.said(ds["index"].values) + some
        said = f"Unrolled views, {style.WAYS}, all at one scale, {words} below; dot: s = 0{some}."
        legend.below(fig, [], [said], sheet)

    return canvas.figure((sheet.width, form.height + high + 0.7 * sheet.titled), draw, ds, sheet=sheet)


def energies(ds: xr.Dataset, ax: Axes, width: float = SCREEN.width, high: float = HIGH[1]) -> Axes:
    """Energy against index on a page of so many inches, that high, a dot an equilibrium, filled where it is stable."""
    index = ds["index"].values
    ax.scatter(ds["index"], ds["energy"], c=["white" if one else style.INK for one in index], s=30,
               edgecolors=style.INK, linewidths=0.9, zorder=3)  # fmt: skip
    ax.set_xlabel(style.fitted("Morse index: number of unstable directions (0: stable)", width - 0.9))
    ax.set_ylabel(labels.label(ds["energy"]))
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.margins(0.04, 0.08)
    if index.size and index.min() == index.max():
        ax.set_xlim(index.min() - 0.5, index.max() + 0.5)
    noun = "equilibrium" if index.size == 1 else "equilibria"
    sentences = [
        f"{index.size} {noun}, {int((index == 0).sum())} stable (filled): {ds.attrs['stability'].replace('M3', 'M₃')}"
    ]
    if "searched" in ds.attrs:
        sentences.append(f"Not proved complete: searched over {labels.minus_signs(ds.attrs['searched'])}")
    ax.set_title("\n".join(style.fitted(one, width - 0.9) for one in sentences), loc="left")
    points = [point_numbers.Point(float(x), float(y), f"{k + 1}")
              for k, (x, y) in enumerate(zip(index, ds["energy"].values, strict=True))]  # fmt: skip
    ax.set_xlim(*ax.get_xlim()), ax.set_ylim(*ax.get_ylim())
    point_numbers.write(ax, points, [], [], (style.inches(ax)[0], high - 0.8))
    return style.with_grid(ax)


def loops(ds: xr.Dataset, sheet: Sheet = SCREEN) -> Figure:
    """The unrolled view of each closed rod at one scale, in the colours of the push, with its index and energy."""
    count = min(ds.sizes["equilibrium"], MOST_LOOPS)
    curves = [_curve(ds, k) for k in range(count)]
    form = frames(curves, sheet.width - 1.0, TALL[not sheet.narrow] * sheet.width)
    pushes = [push_from(ds["contact"].values[k], str(ds.attrs["side"])) for k in range(count)]
    norm, turn = push_scale.scale(pushes), 2 * np.pi * float(ds["rho"])
    unit = labels.unit(str(ds.attrs["length_unit"]))

    def draw(fig: Figure) -> None:
        drawn: Any = None
        axes = fig.subplots(form.rows, form.columns, squeeze=False).ravel()
        for ax in axes[count:]:
            ax.set_axis_off()
        for k, ax in enumerate(axes[:count]):
            one = ds.isel(equilibrium=k)
            for wrap in range(int(one["wraps"]) + 1):
                ax.axhline(wrap * turn, color=style.FAINT, linewidth=0.8, zorder=0)
            index, waves = int(one["index"]), int(one["folds"])
            meets = "\nintersects itself" if "overlaps" in str(one["caution"].values) else ""
            below = f"energy {labels.value(float(one['energy']), one['energy'])}{meets}"
            drawn = draw_frame(ax, curves[k], {"push": pushes[k], "norm": norm}, unit * (k == 0),
                               f"{k + 1}: {waves} wave{'s' * (waves > 1)}, {stability(index)}", below,
                               form.size)  # fmt: skip
        push_scale.bar(fig, drawn, list(axes), push_scale.unit(ds), form.height, below=sheet.narrow)
        sentences = [
            f"Unrolled views, {style.WAYS}, all at one scale; the lines are one turn around the cylinder apart. "
            f"The rod lies {ds.attrs['side']}.",
            "Orange: the cylinder would have to pull, a rod that is free to unbind lifts off there.",
            "Stable and index: of the closed rod on the surface, its section free to turn.",
        ]
        legend.below(fig, [], sentences, sheet)

    return canvas.figure((sheet.width, form.height + 0.9 + 0.6 * sheet.narrow), draw, ds, sheet=sheet)


def _curve(ds: xr.Dataset, k: int) -> tuple[Any, Any]:
    one = ds.isel(equilibrium=k)
    return one["z"].values, float(one["rho"]) * (one["alpha"].values - one["alpha"].values[0])


def stability(index: int, room: float = np.inf) -> str:
    """``stable`` or ``unstable in 2 ways``, in as many words as have room in so many inches of small letters."""
    words = ["stable"] if index == 0 else [f"unstable in {index} way{'s' * (index > 1)}", f"unstable ({index})"]
    return next((text for text in words if style.width_of(text, style.small()) <= room), words[-1])


@dataclass(frozen=True)
class Frames:
    """Frames of one size: columns and rows, their width and height [length], inches of all and of a title."""

    columns: int
    rows: int
    size: tuple[float, float]
    height: float
    room: float

    def said(self, indices: Any) -> str:
        """What a short title of a frame means, where there is no room for a long one."""
        short = [int(index) for index in indices if stability(int(index), self.room).endswith(")")]
        return f"; unstable ({short[0]}): in {short[0]} way{'s' * (short[0] > 1)}" if short else ""


def frames(curves: Sequence[tuple[Any, Any]], width: float, tallest: float) -> Frames:
    """The frames in which all curves have the largest scale that they share in so many inches."""
    wide, tall = (max((float(np.ptp(curve[k])) for curve in curves), default=1.0) or 1.0 for k in (0, 1))
    wide, tall = max(wide, 0.4 * tall) / FILL, max(tall, 0.3 * wide) / FILL / (1 - FOOT)
    scales = {}
    for rows in range(1, max(len(curves), 1) + 1):
        columns = max(-(-len(curves) // rows), 1)
        scales[rows] = min(max(width / columns - BESIDE, 0.1) / wide, max(tallest / rows - AROUND, 0.2) / tall)
    rows = min(rows for rows, scale in scales.items() if scale >= NEARLY * max(scales.values()))
    scale, columns = scales[rows], max(-(-len(curves) // rows), 1)
    return Frames(
        columns,
        rows,
        (wide, tall),
        rows * (tall * scale + AROUND),
        width / columns - 0.3 - style.width_of("14: ", style.small()),
    )


def look(index: int) -> dict[str, Any]:
    """The look of a shape: thick where it is stable."""
    return {"color": style.INK, "linewidth": 1.1 if index else 2.4}


def draw_frame(
    ax: Axes,
    curve: tuple[Any, Any],
    how: dict[str, Any],
    unit: str,
    title: str,
    below: str,
    size: tuple[float, float],
) -> Any:
    """Draw an unrolled view, z to the right and the distance around the cylinder down; a dot at its start.

    Parameters
    ----------
    ax
        The frame; it gets the ratio of its sides.
    curve
        z and rho alpha, (n,) each.
    how
        Colour and width of the curve; or its push and the scale of its colours.
    unit
        Of its lengths, as the bar names it; no bar where it is empty.
    title, below
        Texts above and below the frame.
    size
        Width and height of the frame [length].

    Returns
    -------
    The line that has the colours of the push, else None.
    """
    x, y = curve
    drawn = None
    if "push" in how:
        drawn = push_scale.line(ax, x, y, **how)
    else:
        ax.plot(x, y, **how, solid_capstyle="round", solid_joinstyle="round", zorder=3)
    ax.plot(x[0], y[0], "o", color=style.INK, markersize=3, zorder=4)
    left, low = (x.max() + x.min() - size[0]) / 2, (y.max() + y.min() + size[1] * (1 + FOOT)) / 2
    ax.set(xlim=(left, left + size[0]), ylim=(low, low - size[1]), xticks=[], yticks=[], aspect="equal")
    length = round_length(BAR * size[0])
    begin, up = 0.06, 0.05
    if unit:
        ax.plot([begin, begin + length / size[0]], [up, up], color=style.INK, linewidth=1.6, solid_capstyle="butt",
                transform=ax.transAxes, zorder=4)  # fmt: skip
        ax.annotate(f"{length:g} {unit}", (begin + length / size[0], up), (3, 0), xycoords="axes fraction",
                    textcoords="offset points", va="center", size=style.small(), color=style.SOFT)  # fmt: skip
    for spine in ax.spines.values():
        spine.set(visible=True, color=style.FAINT)
    ax.set_title(title, loc="left", size=style.small(), pad=3)
    ax.set_xlabel(below, size=style.small(), labelpad=2)
    return drawn


def round_length(most: float) -> float:
    """The largest of 1, 2 and 5 times a power of ten that is not more."""
    power = 10.0 ** floor(log10(most) + 1e-9)
    return max(digit * power for digit in (1, 2, 5) if digit * power <= most * (1 + 1e-9))
