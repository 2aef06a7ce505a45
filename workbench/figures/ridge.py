"""Ridge plots: beta, kappa and the push along s for the values of an axis, one curve above the other."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D

from solver.problem.errors import no_such
from studies.laws import NOISE

from ..data import labels
from . import canvas, drawn_rods, legend, push_scale, style
from .drawn_rods import DrawnRods
from .scales import Ticks
from .sheet import SCREEN, Sheet

PANELS = {"beta": "angle β", "kappa": "curvature κ", "push": "push"}  # name -> title
MOST = 60
# the range of a curve in steps from one curve to the next, where there are many of them; filled curves do not overlap
OVERLAP = {"beta": 1.6, "kappa": 1.6, "push": 1.0}
EACH, TALL = 0.3, (2.6, 7.2)  # inches of one curve, and of a panel
LINE = 1.45  # heights of a letter from one line of text to the next


def figure(
    ds: xr.Dataset, x: str | None = None, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN
) -> Figure:
    """Draw beta, kappa and the push along s for the rods along an axis, a panel for each.

    The curves of a panel share one scale, which its bar shows, and are offset; the value of the axis stands at the left
    of its line, where beta, kappa or the push is 0; where 0 is far from all curves, the title names another value.

    Parameters
    ----------
    ds : xr.Dataset
    x, at
        As `axis` and `at` of `drawn_rods.choose`.
    sheet : Sheet
        What the figure is drawn for. Its panel is ``beta``, ``kappa`` or ``push``.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        As of `drawn_rods.choose`, and for an unknown panel.
    """
    if sheet.panel is not None and sheet.panel not in PANELS:
        raise no_such("panel", sheet.panel, PANELS)
    names = [name for name in PANELS if sheet.panel in (None, name)]
    found = drawn_rods.choose(ds, names, x, at, MOST)
    ridges = [_ridge(found, name) for name in names]
    ends = min(ridge.ends()[0] for ridge in ridges), max(ridge.ends()[1] for ridge in ridges)
    tall = float(np.clip(EACH * (ends[1] - ends[0]), *TALL)) * (0.7 if sheet.narrow else 1.0)
    rows, columns = (len(names), 1) if sheet.narrow else (1, len(names))

    def draw(fig: Figure) -> None:
        grid = fig.add_gridspec(rows, columns)
        for i, ridge in enumerate(ridges):
            ax = fig.add_subplot(grid[i, 0] if sheet.narrow else grid[0, i])
            _panel(ax, found, ridge, ends, tall, labelled=sheet.narrow or i == 0)
        pulled = "push" in names and any(push_scale.pulls(rod["push"]) for rod in found.solved)
        entries = [Patch(color=style.PUSHED, label="the cylinder pushes")] if "push" in names else []
        if pulled:
            entries.append(
                Patch(color=push_scale.PULL, label="the cylinder would have to pull: the rod would lift off")
            )
        said = found.said()
        legend.below(fig, entries, [*said, *found.notes], sheet)

    height = rows * (tall + 0.75) + 0.5 + 0.7 * sheet.titled
    return canvas.figure((sheet.width, height), draw, found.source, sheet=sheet)


@dataclass(frozen=True, eq=False)
class Ridge:
    """The curves of one panel.

    curves: of each rod in the unit of the panel, None where it is not solved. foot: the value at the line of a curve.
    step: from one curve to the next.
    """

    name: str
    curves: list[Any]
    foot: float
    step: float

    def ends(self) -> tuple[float, float]:
        """The lowest and the highest point of all curves in steps from the line of the first."""
        drawn = [(k, curve) for k, curve in enumerate(self.curves) if curve is not None]
        low = min(k + (curve.min() - self.foot) / self.step for k, curve in drawn)
        high = max(k + (curve.max() - self.foot) / self.step for k, curve in drawn)
        return float(min(low, 0.0)), float(max(high, len(self.curves) - 1))

    @property
    def size(self) -> float:
        """What the step was made from: the range of nearly every curve."""
        return self.step * _overlap(self.name, len(self.curves))


def _ridge(found: DrawnRods, name: str) -> Ridge:
    """The curves of one quantity; a few that have a much larger range than the others do not flatten them."""
    change = np.degrees if name == "beta" else np.asarray
    curves = [change(rod[name]) if rod.arrays is not None else None for rod in found.rods]
    drawn = [curve for curve in curves if curve is not None]
    low, high = min(curve.min() for curve in drawn), max(curve.max() for curve in drawn)
    far = low > 2 * (high - low) or high < -2 * (high - low)  # 0 lies far from all curves
    foot = float(low) if far and high - low > NOISE * max(abs(low), abs(high)) else 0.0
    sizes = [max(curve.max(), foot) - min(curve.min(), foot) for curve in drawn]
    size = float(np.quantile(sizes, 0.9)) or 1.0
    return Ridge(name, curves, foot, size / _overlap(name, len(curves)))


def _overlap(name: str, count: int) -> float:
    """The range of a curve in steps from one of so many curves to the next."""
    return min(OVERLAP[name], 0.5 + 0.2 * count)


def _panel(ax: Axes, found: DrawnRods, ridge: Ridge, ends: tuple[float, float], tall: float, labelled: bool) -> None:
    """One quantity of all rods, on axes of that height in inches. ends: of all panels, in steps."""
    count, step, foot = len(ridge.curves), ridge.step, ridge.foot
    colours = style.ramp_colours(count)
    norm = push_scale.scale([curve for curve in ridge.curves if curve is not None])
    width = float(np.clip(16 / count, 0.7, 1.4))
    for k, (rod, values) in enumerate(zip(found.rods, ridge.curves, strict=True)):
        ax.axhline(k * step + foot, color=style.FAINT, linewidth=0.6, zorder=1)
        order = 3 + 0.9 * (count - k) / count  # the lower curve stands before the upper one
        where = Affine2D().translate(0, k * step) + ax.transData
        if values is None:
            ax.text(0.5, k * step + foot, "unsolved", transform=ax.get_yaxis_transform(), ha="center", va="bottom",
                    color=style.SOFT, size=style.small())  # fmt: skip
        elif ridge.name == "push":
            for side, colour in ((np.maximum(values, 0), style.PUSHED), (np.minimum(values, 0), push_scale.PULL)):
                ax.fill_between(rod["s"], 0, side, color=colour, alpha=0.25, linewidth=0, transform=where, zorder=order)
            push_scale.line(ax, rod["s"], values, values, norm, width, rod.name, k * step, order)
        else:
            ax.plot(rod["s"], values, color=colours[k], linewidth=1.1, transform=where, zorder=order, label=rod.name)
    margin = 0.02 * (ends[1] - ends[0])
    ax.set_ylim(foot + (ends[0] - margin) * step, foot + (ends[1] + margin) * step)
    ax.set_xlim(0, max(float(rod["s"][-1]) for rod in found.solved))
    ax.xaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
    ax.xaxis.set_major_formatter(Ticks())
    ax.set_xlabel(f"s [{labels.unit(str(found.source.attrs['length_unit']))}]")
    _name_curves(ax, found, ridge, tall, labelled)
    _bar(ax, ridge, found.source)
    ax.grid(axis="x", color=style.FAINT, linewidth=0.6)
    ax.set_axisbelow(True)


def _name_curves(ax: Axes, found: DrawnRods, ridge: Ridge, tall: float, labelled: bool) -> None:
    """The values of the axis at the left of their curves, as many as have room."""
    lines = tall * ridge.step / float(np.ptp(ax.get_ylim())) / (style.small() * LINE / 72)  # of text between two curves
    shown = range(0, len(found.rods), max(int(np.ceil(1 / lines)), 1))
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    texts = [found.rods[k].value if labelled else "" for k in shown]
    ax.set_yticks([ridge.foot + k * ridge.step for k in shown], texts)
    if found.axis is not None:
        long = (
            style.LETTER * style.normal() * len(labels.axis_label(found.axis, found.source[found.axis]))
            < canvas.LEAST * tall
        )
        ax.set_ylabel(labels.axis_label(found.axis, found.source[found.axis], long))
    ax.yaxis.label.set_visible(labelled)


def _bar(ax: Axes, ridge: Ridge, ds: xr.Dataset) -> None:
    """The title of a panel, and at its right edge a bar of a round length that shows its scale."""
    rounds: Sequence[float] = (1, 2, 5, 10, 30, 45, 90, 180, 360)
    if ridge.name != "beta" or ridge.size < rounds[0]:
        power = 10.0 ** np.floor(np.log10(ridge.size))
        rounds = [digit * power for digit in (1, 2, 5)]
    length = max(one for one in rounds if one <= ridge.size * (1 + 1e-9))
    top = ax.get_ylim()[1]
    ax.plot([1.015, 1.015], [top - length, top], color=style.INK, linewidth=2.2, solid_capstyle="butt", clip_on=False,
            transform=ax.get_yaxis_transform("grid"))  # fmt: skip
    unit = {"beta": "°", "kappa": f" {labels.unit(str(ds.attrs['length_unit']))}⁻¹"}
    unit["push"] = f" {labels.unit(push_scale.unit(ds))}"
    foot = f"; line: {labels.number(ridge.foot)}{unit[ridge.name]}" if ridge.foot else ""
    text = f"{PANELS[ridge.name]}; bar: {labels.number(length)}{unit[ridge.name]}{foot}"
    ax.set_title(style.wrap(text, ax), loc="left", size=style.normal())
