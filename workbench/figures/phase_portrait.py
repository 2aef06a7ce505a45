"""Phase portraits: the orbit of a rod among the level sets of beta'^2 + G(beta), beside the potential G."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from solver.numerics.roots import sign_changes
from solver.orbits.boundary import critical_points
from solver.orbits.potential import TAU, potential, slope_rate
from solver.problem.errors import InputError

from ..stored.stored_study import StoredStudy
from ..words import labels
from . import canvas, colours, drawn_rods, fonts
from .axis_scales import RoomLocator
from .drawn_rods import DrawnRod
from .sheet import SCREEN, Sheet

PANELS = {"portrait": "phase portrait", "potential": "potential"}
COLUMN = 1.3  # inches that a rod needs among others
BANDS = 2  # rows of rods at most
ANGLES = 1441  # of a level set
LEVELS = 7  # level sets
ROD = "the rod, at its level h"
OTHERS = "other level sets of β′² + G"
ROUNDING = 1e-12
SPARE = 0.06  # of the window, to the left and right of what must be seen
LEAST = np.radians(0.5)  # of a window
SEPARATRIX: dict[str, Any] = {
    "color": colours.INK,
    "linewidth": 0.9,
    "linestyle": (0, (4, 2)),
    "zorder": 3,
    "gid": "separatrix",
    "label": "the separatrix, through a saddle (×)",
}


def figure(
    stored: StoredStudy, x: str | None = None, at: Mapping[str, float] | None = None, sheet: Sheet = SCREEN
) -> Figure:
    """Draw (beta, beta') of one rod beside its potential G(beta); of the rods along an axis one above the other.

    The rod stays on the level set beta'^2 + G(beta) = h. The separatrices are the level sets through the saddles, the
    maxima of G.

    Parameters
    ----------
    stored : StoredStudy
    x, at
        As `axis` and `at` of `drawn_rods.choose`.
    sheet : Sheet
        What the figure is drawn for. Its panel is ``portrait`` or ``potential``.

    Raises
    ------
    InputError
        As of `drawn_rods.choose`, and for an unknown panel.
    """
    names = sheet.choose(PANELS)
    most = max(int((sheet.width - 0.6) / COLUMN), 1)
    if stored.leaves:
        raise InputError("a portrait needs rods that lie on the cylinder; choose --kind ridge or lines")
    if stored.loads_vary:
        raise InputError("a portrait needs loads that are constant along the rod; choose --kind ridge or states")
    chosen = drawn_rods.choose(stored, ("beta", "dbeta"), x, at, most * (1 if sheet.narrow else BANDS))
    windows = np.array([window_of(rod) for rod in chosen.solved])
    window = float(windows[:, 0].min()), float(windows[:, 1].max())
    orbits = [orbit(rod, window) for rod in chosen.solved]
    alone = len(orbits) == 1
    columns = ceil(len(orbits) / ceil(len(orbits) / most))
    across = columns if not alone else 1 if sheet.narrow else len(names)
    tall = min(0.75 * sheet.width / across, 3.6) if alone else 1.9
    tall = min(tall, 1.25) if sheet.narrow else tall
    unit = labels.unit(chosen.source.units["length"])
    source = chosen.source
    heights = {name: np.array([orbit_of_rod.ends(name) for orbit_of_rod in orbits]) for name in names}
    if chosen.axis is None and chosen.at():
        source = source.with_title(f"{source.attrs['title']}, {chosen.at()}")

    def panel(i: int, name: str, ax: Axes) -> None:
        """Draw a panel of a rod; among others it has numbers at the left and below only."""
        drawn, wide = orbits[i], sheet.width / across
        (_portrait if name == "portrait" else _potential)(ax, drawn)
        ax.set(xlim=np.degrees(drawn.window), ylim=(heights[name][:, 0].min(), heights[name][:, 1].max()))
        ax.set_label(f"{drawn.rod.name}, {PANELS[name]}")
        ax.xaxis.set_major_locator(RoomLocator("angles"))
        left, lowest = alone or i % across == 0, alone or name == names[-1]
        ax.tick_params(labelleft=left, labelbottom=lowest)
        if lowest:
            ax.set_xlabel("angle to the axis  β [°]" if wide > COLUMN + 0.5 else "β [°]")
        if left:
            rate, potential = ("rate of the angle  β′", "potential G, level h") if alone else ("β′", "G, h")
            ax.set_ylabel(f"{rate} [1/{unit}]" if name == "portrait" else f"{potential} [1/{unit}²]")
        if alone:
            ax.set_title(PANELS[name] if name == "portrait" else "potential G and level h", loc="left")
        elif name == names[0]:
            fits = fonts.width_of(drawn.rod.name, fonts.small()) < wide - 0.3
            ax.set_title(drawn.rod.name if fits else drawn.rod.value, loc="left", size=fonts.small())

    high = tall + 0.65
    rows = canvas.in_rows([partial(panel, 0, name) for name in names], across, high)
    if not alone:
        groups = [range(first, min(first + across, len(orbits))) for first in range(0, len(orbits), across)]
        rows = [
            row
            for band in groups
            for name in names
            for row in canvas.in_rows([partial(panel, i, name) for i in band], across, high)
        ]
    said = chosen.said() if source is chosen.source or not sheet.titled else []  # the title says it
    return canvas.page(source, sheet, rows, [*said, *chosen.notes], 0.9)


@dataclass(frozen=True, eq=False)
class DrawnOrbit:
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
        return potential(self.rod.loads, beta) / self.rod.rho**2

    def angles(self) -> NDArray[np.float64]:
        """Angles over the window."""
        return np.linspace(*self.window, ANGLES)

    def fastest(self) -> float:
        """The largest beta' of the rod and of the separatrices [1/length]."""
        lowest = float(self.G(self.angles()).min())
        heights = np.sqrt(np.maximum(self.G(self.saddles) - lowest, 0.0))
        return float(max(np.abs(self.dbeta).max(), heights.max(initial=1e-12)))

    def ends(self, name: str) -> tuple[float, float]:
        """The lowest and the highest place of a panel."""
        if name == "portrait":
            return -1.15 * self.fastest(), 1.15 * self.fastest()
        lowest = float(self.G(self.angles()).min())
        low, high = min(lowest, self.h), max(lowest, self.h, self.G(self.saddles).max(initial=lowest))
        return low - 0.08 * (high - low or 1.0), high + 0.14 * (high - low or 1.0)


def window_of(rod: DrawnRod) -> tuple[float, float]:
    """The angles of a rod and the next saddle on either side, with some room [rad]."""
    low, high = float(rod["beta"].min()), float(rod["beta"].max())
    maxima, _ = saddles_and_centres(rod, low - TAU, high + TAU)
    left, right = maxima[maxima < low], maxima[maxima > high]
    low = max(left[-1] if left.size else low, low - np.pi)
    high = min(right[0] if right.size else high, high + np.pi)
    spare = max(SPARE * (high - low), LEAST)
    return float(low - spare), float(high + spare)


def orbit(rod: DrawnRod, window: tuple[float, float]) -> DrawnOrbit:
    """The orbit of a rod, with the critical points of G that lie in a window."""
    level = rod["dbeta"][0] ** 2 + potential(rod.loads, rod["beta"][0]) / rod.rho**2
    saddles, centres = saddles_and_centres(rod, *window)
    return DrawnOrbit(rod, rod["beta"], rod["dbeta"], float(level[0]), saddles, centres, window)


def saddles_and_centres(rod: DrawnRod, low: float, high: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The maxima and the minima of G between two angles, where the rod could be a helix, rising [rad]."""
    critical = critical_points(rod.loads).beta
    turns = TAU * np.arange(np.floor((low - np.pi) / TAU), high / TAU + 1)
    angles = (turns[:, None] + critical).ravel()
    angles = angles[(angles > low) & (angles < high)]
    rates = slope_rate(rod.loads, angles)
    return angles[rates < 0], angles[rates > 0]


def _portrait(ax: Axes, one: DrawnOrbit) -> None:
    """The orbit, the separatrices and some level sets."""
    G = one.G(one.angles())
    for level in np.linspace(float(G.min()), float(G.min()) + 1.4 * (one.fastest() ** 2 + 1e-12), LEVELS + 2)[1:]:
        _level_set(ax, one, float(level), color=colours.FAINT, linewidth=0.8, gid="_level", zorder=1, label=OTHERS)
    for level in _levels(one):
        _level_set(ax, one, level, **SEPARATRIX)
    ax.plot(np.degrees(one.beta), one.dbeta, color=colours.DATA, linewidth=1.4, gid="rod", label=ROD, zorder=5)
    _mark(ax, one, lambda angles: 0 * angles, one.dbeta[[0, -1]])


def _mark(ax: Axes, one: DrawnOrbit, height: Callable[[Any], Any], ends: Any) -> None:
    """Mark saddles and centres at their height, and the two ends of the rod at theirs."""
    places: list[tuple[str, str, Any, Any, str, int, str]] = [
        ("saddle", "", one.saddles, height(one.saddles), "x", 5, colours.INK),
        ("centre", "centre: a helix" * bool(one.centres.size), one.centres, height(one.centres), "+", 6, colours.SOFT),
        ("s = 0", "s = 0", one.beta[:1], ends[:1], "o", 4, colours.INK),
        ("s = L", "s = L", one.beta[-1:], ends[1:], "s", 4, colours.INK),
    ]
    for name, words, angles, heights, marker, size, colour in places:
        ax.plot(np.degrees(angles), heights, marker, color=colour, markersize=size, gid=name, label=words, zorder=6)


def _levels(one: DrawnOrbit) -> list[float]:
    """The levels of the saddles, rising, each once."""
    levels: list[float] = []
    for level in sorted(one.G(one.saddles).tolist()):
        if not levels or level - levels[-1] > ROUNDING * (1 + abs(level)) * 100:
            levels.append(level)
    return levels


def _level_set(ax: Axes, one: DrawnOrbit, level: float, **look: Any) -> None:
    """Both halves of beta' = +-sqrt(level - G), with the angles where they meet."""
    angles = np.sort(np.concatenate([one.angles(), one.saddles]))
    above = level - one.G(angles)
    size = ROUNDING * (abs(level) + float(np.ptp(above)))
    above = np.where(np.abs(above) < size, 0.0, above)
    meet = sign_changes(lambda b: level - one.G(b), angles, above)
    order = np.argsort(np.concatenate([angles, meet]), kind="stable")
    angles, above = (np.concatenate(pair)[order] for pair in ((angles, meet), (above, np.zeros(meet.size))))
    rate = np.sqrt(np.where(above < 0, np.nan, above))
    for half in (rate, -rate):
        ax.plot(np.degrees(angles), half, **look)


def _potential(ax: Axes, one: DrawnOrbit) -> None:
    """G over the angle, and the level h of the rod, where it lies above G."""
    angles = one.angles()
    ax.plot(np.degrees(angles), one.G(angles), color=colours.INK, linewidth=1.0, gid="G", zorder=3)
    reached = (float(one.beta.min()), float(one.beta.max()))
    ax.plot(np.degrees(reached), [one.h, one.h], color=colours.DATA, linewidth=1.4, gid="h", label=ROD, zorder=4)
    for level in _levels(one):
        ax.plot(np.degrees(one.window), [level, level], **SEPARATRIX)
    _mark(ax, one, one.G, [one.h, one.h])
