"""Phase portraits: the orbit of a rod among the level sets of beta'^2 + G(beta), beside the potential G."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from solver.mechanics.potential import TAU, Loads, potential, slope, slope_rate
from solver.numerics.roots import bracket
from solver.problem.errors import InputError, no_such

from ..store import schema
from ..words import labels
from . import canvas, colours, drawn_rods, fonts, legend
from .drawn_rods import DrawnRod
from .scales import RoomLocator
from .sheet import SCREEN, Sheet

PANELS = {"portrait": "phase portrait", "potential": "potential"}
COLUMN = 1.4  # inches that a rod needs among others
BANDS = 2  # rows of rods at most
ANGLES = 1441  # of a level set
LEVELS = 7  # level sets
ROUNDING = 1e-12
SPARE = 0.06  # of the window, to the left and right of what must be seen
LEAST = np.radians(0.5)  # of a window
SEPARATRIX: dict[str, Any] = {"color": colours.INK, "linewidth": 0.9, "linestyle": (0, (4, 2)), "zorder": 3,
                              "label": "separatrix"}  # fmt: skip
SADDLE = "the separatrix, through a saddle (×)"


def figure(
    ds: xr.Dataset, x: str | None = None, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN
) -> Figure:
    """Draw (beta, beta') of one rod beside its potential G(beta); of the rods along an axis one above the other.

    The rod stays on the level set beta'^2 + G(beta) = h. The separatrices are the level sets through the saddles, the
    maxima of G.

    Parameters
    ----------
    ds : xr.Dataset
    x, at
        As `axis` and `at` of `drawn_rods.choose`.
    sheet : Sheet
        What the figure is drawn for. Its panel is ``portrait`` or ``potential``.

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
    most = max(int((sheet.width - 0.6) / COLUMN), 1)
    bands = 1 if sheet.narrow else BANDS
    if schema.loads_vary(ds):
        raise InputError("a portrait needs loads that are constant along the rod; choose --kind ridge or states")
    found = drawn_rods.choose(ds, ("beta", "dbeta"), x, at, bands * most)
    windows = np.array([window_of(rod) for rod in found.solved])
    window = float(windows[:, 0].min()), float(windows[:, 1].max())
    orbits = [orbit(rod, window) for rod in found.solved]
    alone = len(orbits) == 1
    bands = ceil(len(orbits) / most)
    across = len(names) if alone and not sheet.narrow else ceil(len(orbits) / bands)
    rows = 1 if alone and not sheet.narrow else len(names) * bands
    tall = min(0.75 * sheet.width / across, 3.6) if alone else 1.9
    tall = min(tall, 1.25) if sheet.narrow else tall
    unit = labels.unit(str(found.source.attrs["length_unit"]))
    source = found.source
    if found.axis is None and found.at():
        source = source.assign_attrs(title=f"{source.attrs['title']}, {found.at()}")

    def draw(fig: Figure) -> None:
        grid = fig.add_gridspec(rows, across)
        for i, one in enumerate(orbits):
            for j, name in enumerate(names):
                cell = divmod(j, across) if alone else ((i // across) * len(names) + j, i % across)
                ax = fig.add_subplot(grid[cell])
                (_portrait if name == "portrait" else _potential)(ax, one, unit)
                _frame(ax, name, one, alone, j, leftmost=alone or cell[1] == 0, wide=sheet.width / across)
        if not alone:
            _share(fig.axes, len(names), across)
        said = found.said() if source is found.source or not sheet.titled else []  # the title says it
        legend.below(fig, _entries(orbits, names), [*said, *found.notes], sheet)

    return canvas.figure((sheet.width, rows * (tall + 0.65) + 0.9), draw, source, sheet=sheet)


@dataclass(frozen=True, eq=False)
class Orbit:
    """A rod in its phase plane.

    beta, dbeta: along the rod, (n,) [rad], [1/length]. h: its level [1/length^2]. saddles, centres: the critical points
    of G in the window [rad]. window: the angles that are shown [rad].
    """

    rod: DrawnRod
    beta: NDArray[np.float64]
    dbeta: NDArray[np.float64]
    h: float
    saddles: NDArray[np.float64]
    centres: NDArray[np.float64]
    window: tuple[float, float]

    def G(self, beta: Any) -> Any:
        """The potential [1/length^2]."""
        return potential(_loads(self.rod), beta) / self.rod.rho**2

    def angles(self) -> NDArray[np.float64]:
        """Angles over the window."""
        return np.linspace(*self.window, ANGLES)


def window_of(rod: DrawnRod) -> tuple[float, float]:
    """The angles of a rod and the next saddle on either side, with some room [rad]."""
    low, high = float(rod["beta"].min()), float(rod["beta"].max())
    every = critical_angles(rod, low - TAU, high + TAU)
    maxima = every[slope_rate(_loads(rod), every) < 0]
    left, right = maxima[maxima < low], maxima[maxima > high]
    low = max(left[-1] if left.size else low, low - np.pi)
    high = min(right[0] if right.size else high, high + np.pi)
    spare = max(SPARE * (high - low), LEAST)
    return float(low - spare), float(high + spare)


def orbit(rod: DrawnRod, window: tuple[float, float]) -> Orbit:
    """The orbit of a rod, with the critical points of G that lie in a window."""
    every = critical_angles(rod, *window)
    is_saddle = slope_rate(_loads(rod), every) < 0
    level = rod["dbeta"][0] ** 2 + potential(_loads(rod), rod["beta"][0]) / rod.rho**2
    return Orbit(rod, rod["beta"], rod["dbeta"], float(level), every[is_saddle], every[~is_saddle], window)


def critical_angles(rod: DrawnRod, low: float, high: float) -> NDArray[np.float64]:
    """The angles between two where H = G'/2 is 0, where the rod could be a helix, rising [rad]."""
    loads = _loads(rod)
    angles = np.arange(np.floor(low / TAU) * TAU, high + TAU, TAU / 1440) + 1e-4
    value = slope(loads, angles)
    k = np.flatnonzero(value[1:] * value[:-1] < 0)
    sign = np.sign(value[k + 1])
    roots = bracket(lambda b: (sign * slope(loads, b), sign * slope_rate(loads, b)), angles[k], angles[k + 1])
    return np.asarray(roots[(roots > low) & (roots < high)], dtype=float)


def _loads(rod: DrawnRod) -> Loads:
    return Loads(rod.lam, rod.mu, rod.phi)


def _portrait(ax: Axes, one: Orbit, unit: str) -> None:
    """The orbit, the separatrices and some level sets."""
    G = one.G(one.angles())
    fastest = max(float(np.abs(one.dbeta).max()), *(_height(one.G(b), G) for b in one.saddles), 1e-12)
    levels = np.linspace(float(G.min()), float(G.min()) + 1.4 * (fastest**2 + 1e-12), LEVELS + 2)[1:]
    for level in levels:
        _level_set(ax, one, float(level), color=colours.FAINT, linewidth=0.8, label="_level", zorder=1)
    for level in _levels(one):
        _level_set(ax, one, level, **SEPARATRIX)
    ax.plot(np.degrees(one.beta), one.dbeta, color=colours.PUSHED, linewidth=1.4, label="rod", zorder=5)
    _mark(ax, one, lambda angles: 0 * angles, one.dbeta[[0, -1]])
    ax.set_ylim(-1.15 * fastest, 1.15 * fastest)
    ax.set_ylabel(f"β′ [1/{unit}]")


def _mark(ax: Axes, one: Orbit, height: Callable[[Any], Any], ends: Any) -> None:
    """Mark saddles and centres at their height, and the two ends of the rod at theirs."""
    places: list[tuple[str, Any, Any, str, int, str]] = [
        ("saddle", one.saddles, height(one.saddles), "x", 5, colours.INK),
        ("centre", one.centres, height(one.centres), "+", 6, colours.SOFT),
        ("s = 0", one.beta[:1], ends[:1], "o", 4, colours.INK),
        ("s = L", one.beta[-1:], ends[1:], "s", 4, colours.INK),
    ]
    for name, angles, heights, marker, size, colour in places:
        ax.plot(np.degrees(angles), heights, marker, color=colour, markersize=size, label=name, zorder=6)


def _levels(one: Orbit) -> list[float]:
    """The levels of the saddles, rising, each once."""
    found: list[float] = []
    for level in sorted(one.G(one.saddles).tolist()):
        if not found or level - found[-1] > ROUNDING * (1 + abs(level)) * 100:
            found.append(level)
    return found


def _height(level: Any, G: Any) -> float:
    """The largest beta' of a level set."""
    return float(np.sqrt(max(float(level) - float(G.min()), 0.0)))


def _level_set(ax: Axes, one: Orbit, level: float, **look: Any) -> None:
    """Both halves of beta' = +-sqrt(level - G), with the angles where they meet."""
    angles = np.sort(np.concatenate([one.angles(), one.saddles]))
    above = level - one.G(angles)
    size = ROUNDING * (abs(level) + float(np.ptp(above)))
    above = np.where(np.abs(above) < size, 0.0, above)
    k = np.flatnonzero(above[1:] * above[:-1] < 0)
    low, high = np.where(above[k] < 0, angles[k], angles[k + 1]), np.where(above[k] < 0, angles[k + 1], angles[k])
    for _ in range(50):
        middle = (low + high) / 2
        inside = one.G(middle) < level
        low, high = np.where(inside, low, middle), np.where(inside, middle, high)
    order = np.argsort(np.concatenate([angles, high]), kind="stable")
    angles, above = (np.concatenate(pair)[order] for pair in ((angles, high), (above, np.zeros(high.size))))
    rate = np.sqrt(np.where(above < 0, np.nan, above))
    for half in (rate, -rate):
        ax.plot(np.degrees(angles), half, **look)


def _potential(ax: Axes, one: Orbit, unit: str) -> None:
    """G over the angle, and the level h of the rod, where it lies above G."""
    angles = one.angles()
    G = one.G(angles)
    ax.plot(np.degrees(angles), G, color=colours.INK, linewidth=1.0, label="G", zorder=3)
    reached = (float(one.beta.min()), float(one.beta.max()))
    ax.plot(np.degrees(reached), [one.h, one.h], color=colours.PUSHED, linewidth=1.4, label="h", zorder=4)
    for level in _levels(one):
        ax.plot(np.degrees(one.window), [level, level], **SEPARATRIX)
    _mark(ax, one, one.G, [one.h, one.h])
    low, high = min(float(G.min()), one.h), max(one.h, *one.G(one.saddles), float(G.min()))
    ax.set_ylim(low - 0.08 * (high - low or 1.0), high + 0.14 * (high - low or 1.0))
    ax.set_ylabel(f"G, h [1/{unit}²]")


def _frame(ax: Axes, name: str, one: Orbit, alone: bool, j: int, leftmost: bool, wide: float) -> None:
    """The title and the scales of a panel."""
    ax.set_xlim(*np.degrees(one.window))
    ax.set_label(f"{one.rod.name}, {PANELS[name]}")
    if alone:
        ax.set_title(PANELS[name] if name == "portrait" else "potential G and level h", loc="left")
    elif j == 0:
        fits = fonts.width_of(one.rod.name, fonts.small()) < wide - 0.3
        ax.set_title(one.rod.name if fits else one.rod.value, loc="left", size=fonts.small())
    ax.set_xlabel("angle to the axis  β [°]" if wide > COLUMN + 0.5 else "β [°]")
    ax.xaxis.set_major_locator(RoomLocator("angles"))
    ax.yaxis.label.set_visible(leftmost)


def _share(axes: Sequence[Axes], panels: int, across: int) -> None:
    """For each quantity one range of numbers over all rods, with numbers at the left and below only."""
    for j in range(panels):
        ends = [ax.get_ylim() for ax in axes[j::panels]]
        for i, ax in enumerate(axes[j::panels]):
            ax.set_ylim(np.min(ends), np.max(ends))
            ax.tick_params(labelleft=i % across == 0, labelbottom=j == panels - 1)
            ax.xaxis.label.set_visible(j == panels - 1)


def _entries(orbits: Sequence[Orbit], names: Sequence[str]) -> list[Artist]:
    """The legend."""
    rod = "the rod, at its level h" if "potential" in names else "the rod"
    looks: list[tuple[bool, str, dict[str, Any]]] = [
        (True, rod, {"color": colours.PUSHED, "linewidth": 1.8}),
        (True, "s = 0", {"marker": "o", "markersize": 4, "linestyle": "none"}),
        (True, "s = L", {"marker": "s", "markersize": 4, "linestyle": "none"}),
        (any(one.saddles.size for one in orbits), SADDLE, {"linewidth": 0.9, "linestyle": (0, (4, 2))}),
        (any(one.centres.size for one in orbits), "centre: a helix",
         {"color": colours.SOFT, "marker": "+", "markersize": 6, "linestyle": "none"}),
        ("portrait" in names, "other level sets of β′² + G", {"color": colours.FAINT, "linewidth": 1.2}),
    ]  # fmt: skip
    return [
        Line2D([], [], label=label, **({"color": colours.INK} | look)) for is_drawn, label, look in looks if is_drawn
    ]
