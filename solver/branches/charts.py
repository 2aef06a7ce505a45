"""Coordinates on the equilibria of one path, in which continuation follows an equilibrium.

The level of an orbit is measured from a saddle or from one of the two ends (`Path`). Next to a saddle the coordinate is
log|gap|, as transit times are linear in it; where beta_t is small at an end, the coordinate is that beta_t, with its
sign.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..core import branch_calls as core
from ..core.library import numbers_of
from ..core.tuning import AS_HIGH, NUDGE, SAME_SADDLE
from ..numerics.arrays import ALIKE, FAINT
from ..orbits.boundary import Path, boundary_of, height_scale
from ..problem.dimensionless import EndsProblem


@dataclass(frozen=True)
class Chart:
    """A coordinate x on the equilibria of one path near `at`.

    kind: where the level is measured from, a "saddle", the "start" or the "end". scale: the change of x over which the
    orbit changes its form. nudge: of x, over which differences are taken: shorter where the orbit passes an angle at
    which G is almost level. logarithmic: whether x is log|gap|; else x is beta_t at that end, with its sign.
    """

    kind: str
    at: Path
    scale: float
    nudge: float
    logarithmic: bool


def charts(problem: EndsProblem, path: Path) -> list[Chart]:
    """Coordinates in which the equilibrium can be followed, the best first.

    The others are needed where the best one ends and the branch does not, as where its saddle meets a centre.
    """
    rows = core.charts(numbers_of(problem)[0], path)
    return [Chart(kind, Path(*at), scale, nudge, logarithmic) for kind, at, scale, nudge, logarithmic in rows]


def coordinate(chart: Chart) -> float:
    """x of the path at which the chart was made."""
    if chart.logarithmic:
        return chart.at.y
    direction = chart.at.direction_at_end if chart.kind == "end" else chart.at.leaving
    return direction * float(np.exp(chart.at.y / 2))


def path_at(problem: EndsProblem, chart: Chart, x: float) -> Path | None:
    """The path at x; None where its saddle no longer exists, or there is no such path."""
    at = core.path_at(numbers_of(problem)[0], chart, x)
    return None if at is None else Path(*at)


def same_equilibrium(problem: EndsProblem, path: Path, other: Path) -> bool:
    """Whether two paths of one problem are the same orbit, from whichever angles their levels are measured."""
    if (path.leaving, path.turns, path.helix) != (other.leaving, other.turns, other.helix):
        return False
    if path.helix:
        return True
    if abs(np.sin((path.pin - other.pin) / 2)) > ALIKE and path.sign == other.sign:
        boundary, rounding = boundary_of(problem), AS_HIGH * height_scale(problem)
        pins = [boundary.own_pin(pin) for pin in (path.pin, other.pin)]
        if np.isin(pins, boundary.saddles).all() and abs(boundary.fall(*pins)) < rounding:  # such as mirror images
            if abs(np.exp(path.y) - np.exp(other.y)) < rounding:
                return True
            other = replace(other, pin=path.pin)
    first = charts(problem, path)[0]
    others = (chart for chart in charts(problem, other) if alike(first, chart, ALIKE))
    at = coordinate(first)
    near = max(ALIKE / NUDGE * first.nudge, FAINT * abs(at))
    return any(abs(at - coordinate(chart)) < near for chart in others)


def alike(chart: Chart, other: Chart, near: float = SAME_SADDLE) -> bool:
    """Whether two charts have one coordinate; near: half of the largest angle between their saddles."""
    same = (chart.kind, chart.logarithmic, chart.at.sign) == (other.kind, other.logarithmic, other.at.sign)
    return same and (chart.kind != "saddle" or abs(np.sin((chart.at.pin - other.at.pin) / 2)) < near)
