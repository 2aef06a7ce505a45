"""The orbits of equilibria and their variations: how beta between two ends answers a change.

The orbit that joins the ends changes by a0 along its flow and by g0 of its level (`orbit.variations`), and with the
three loads. What is given at the ends decides how much of each (`system.parts_by_given`).
"""

from dataclasses import replace

import numpy as np

from ..core.panels import Cutting
from ..levels.line_point import LinePoint, Path
from ..levels.saddle_panels import with_saddle_panels
from ..levels.transit_times import STRETCH
from ..numerics.arrays import Array
from ..orbit.periodic_orbit import Orbit, relative_orbit, solve_orbit
from ..orbit.variations import GOAL, LENGTH, POINTS, Variations, variations_on
from ..problem.reduced import EndsProblem, StartProblem

_TIGHT = 1e-13  # tolerance of the orbits


def varied_orbits(problem: EndsProblem, paths: list[Path], places: list[LinePoint]) -> tuple[Orbit, Variations]:
    """The orbits of B equilibria that are no helices, and their variations."""
    start, level = _start(problem, paths, places)
    return _plain(problem, start, level), _vary(problem, start, level)


def equilibrium_variations(problem: EndsProblem, path: Path) -> Variations:
    """The variations of one equilibrium that is no helix."""
    return _vary(problem, *_start(problem, [path], [LinePoint(problem)]))


def plain_orbit(problem: EndsProblem, path: Path, place: LinePoint) -> Orbit:
    """The orbit of one equilibrium that is no helix."""
    return _plain(problem, *_start(problem, [path], [place]))


def _plain(problem: EndsProblem, start: StartProblem, level: tuple[Array, ...]) -> Orbit:
    pin, gap, excess = level
    orbit = solve_orbit(start, _TIGHT, (pin, gap), STRETCH)
    return with_saddle_panels(orbit, problem.span, gap, excess) if excess.any() else orbit


def _vary(problem: EndsProblem, start: StartProblem, level: tuple[Array, ...]) -> Variations:
    pin, gap, excess = level
    relative = relative_orbit(start, POINTS, Cutting(LENGTH, GOAL, STRETCH), (pin, gap))
    arcs = relative.arcs
    if excess.any():
        still = replace(arcs, pieces=replace(arcs.pieces, base=np.zeros_like(arcs.pieces.base)))
        relative = with_saddle_panels(replace(relative, arcs=still), problem.span, gap, excess)
    return variations_on(relative, arcs)


def _start(problem: EndsProblem, paths: list[Path], places: list[LinePoint]) -> tuple[StartProblem, tuple[Array, ...]]:
    """The start problems of B paths, without the time that a gap in floating point cannot express at a saddle; and the
    pins, the gaps, and the log by which the gaps are too large, (B,) each."""
    deepest, y = np.array([place.blank.deepest for place in places]), np.array([path.y for path in paths])
    gap = np.array([path.sign for path in paths]) * np.exp(np.maximum(y, deepest))
    pin, excess = np.array([path.pin for path in paths]), np.maximum(deepest - y, 0.0)
    falls = np.array([place.fall(path.pin, place.start) for place, path in zip(places, paths, strict=True)])
    speed = np.array([path.leaving for path in paths]) * np.sqrt(np.maximum(gap + falls, 0.0))
    start = replace(problem.started(speed), beta0=np.array([place.start for place in places]))
    brief = start.span.copy()
    for i in np.flatnonzero(excess):
        brief[i] = places[i].lengths([replace(paths[i], y=places[i].blank.deepest)])[0]
    return replace(start, span=brief), (pin, gap, excess)
