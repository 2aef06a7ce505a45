"""The condition number of an orbit: how much a change of its start grows, without following any change along the rod.

Two changes of the start span all others. One along the flow f = (beta_t, -H) stays along it: it becomes f(t). One
across becomes a(t) f(t) + b(t) with b = (c H, beta_t)/D, D = beta_t^2 + c H^2, because the flow keeps areas; only the
shear a(t) has to be integrated, a' = (1 - c H') (beta_t^2 - c H^2)/D^2. It grows by the same amount each period, so the
cost does not grow with the number of bends, and next to a saddle no large numbers cancel.

c, the square of a time, defines which direction is across. Any constant is valid; one for each panel keeps D from
nearly vanishing in it, also where the whole orbit is slow (next to a fold) or small (next to a helix). Where c changes
from one panel to the next, b changes by a multiple of f, which is added to a.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..mechanics.potential import Loads, load_size, slope, slope_rate, slope_size
from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis
from ..problem.reduced import StartProblem
from .linearised_growth import beside_helix, slope_weight
from .panels import EPS, Panels, running
from .phase import unfolded
from .pieces import HELIX, LIBRATION

if TYPE_CHECKING:
    from .periodic_orbit import Orbit


def condition(orbit: "Orbit") -> Array:
    """The condition number of B orbits, (B,), at least 1.

    The largest |d beta/d beta(0)| and w |d beta/d beta_t(0)| along the rod; w as in `slope_weight`.
    """
    weight, (steady, worst) = slope_weight(orbit.problem), beside_helix(orbit.problem)
    moves = (orbit.arcs.kind != HELIX) & (orbit.count.reshape(-1, 2).sum(axis=1) > 0) & ~steady
    if moves.any():
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            largest = _largest_growth(orbit, weight, np.where(moves, 1.0, worst))
        worst = np.where(moves, np.where(np.isnan(largest), np.inf, largest), worst)
    return worst


@dataclass(frozen=True, eq=False)
class _Flow:
    """The flow at the nodes of P panels in units of each problem's own time and largest speed.

    v, h: (P, n), |beta_t| and H as one moves away from the start. across: (P,), c. shear: (P, n + 1), the series of a
    from the start along the panel's arc. gain: (2 B,), what a whole arc adds to a.
    """

    v: Array
    h: Array
    across: Array
    shear: Array
    gain: Array


def _flow_of(orbit: "Orbit", unit: Array, speed: Array) -> _Flow:
    """The flow in time of 1/unit and speeds in units of `speed`, (B,) each."""
    problem, panels = orbit.problem, orbit.panels
    points, b = basis(panels.series.shape[2] - 1), panels.arc // 2
    loads, one = Loads.columns(problem, b), unit[b, None]
    beta, v = panels.series[:, 0] @ points.values, panels.series[:, 1] @ points.values / speed[b, None]
    half = (panels.duration / 2)[:, None] * one
    h = _slope_along(orbit, loads, beta, v, half, speed[b, None] * one)
    rate = slope_rate(loads, beta) / one**2
    c = across(v, np.abs(h), rate, half[:, 0])
    column = c[:, None]
    size = v * v + column * h * h
    series = ((1 - column * rate) * ((v * v - column * h * h) / size) / size * half) @ points.analyse @ points.integrate
    gain = series.sum(axis=1)
    jump = _jumps(orbit, v, h, c)
    closing = np.zeros(2 * problem.size)
    rotates = np.flatnonzero((orbit.count > 0) & (np.repeat(orbit.arcs.kind, 2) != LIBRATION))
    if rotates.size:
        start = orbit.first[rotates]
        closing[rotates] = _jump(v[start, 0], h[start, 0], c[start + orbit.count[rotates] - 1], c[start])
    series[:, 0] += running((gain + jump)[:, None], orbit.first, orbit.count)[:, 0] + jump
    total = np.bincount(panels.arc, weights=gain + jump, minlength=2 * problem.size) + closing
    return _Flow(v, h, c, series, total)


def _slope_along(orbit: "Orbit", loads: Loads, beta: Array, v: Array, half: Array, unit: Array) -> Array:
    """H at the panels' nodes, (P, n), as one moves away from the start.

    Next to a helix the formula for H loses its digits; in a very short panel the derivative of the speed does. Of the
    two the one that loses less.
    """
    points, panels = basis(v.shape[1]), orbit.panels
    sign = orbit.arcs.direction[panels.arc // 2] * np.where(panels.arc % 2 == 1, -1, 1)
    turns = v.min(axis=1) < v.max(axis=1) / 2
    lost = EPS * v.shape[1] ** 2 * np.where(turns, 1, v.max(axis=1)) / half[:, 0]
    direct = EPS * slope_size(loads, beta).max(axis=1) / unit[:, 0] < lost
    derived = -(v @ points.analyse @ points.differentiate) / half
    return np.where(direct[:, None], sign[:, None] * slope(loads, beta) / unit, derived)


def across(v: Array, h: Array, rate: Array, half: Array) -> Array:
    """c of each panel from |beta_t|, |H| and H' at its nodes, (P, n), and half its duration, (P,) -> (P,).

    1/|H'| makes the shear small. Beside a turning point, where beta_t vanishes, c H^2 has to be as large as beta_t^2 is
    in the panel; beside a helix, where H does, no larger; where the speed hardly changes, the rounding of H must not
    count.
    """
    fastest, steepest = v.max(axis=1), h.max(axis=1)
    slows, levels = v.min(axis=1) < fastest / 2, h.min(axis=1) < steepest / 2
    ratio = (fastest / steepest) ** 2
    c = 1 / np.maximum(np.abs(rate).max(axis=1), 1e-200)
    c = np.where(levels, np.fmin(c, 8 * ratio), c)
    c = np.where(levels & ~slows, np.fmin(c, (20 * half) ** 2), c)
    return np.where(slows, np.fmax(c, ratio / 2), c)


def _jump(v: Array, h: Array, old: Array, new: Array) -> Array:
    """What a gains where c changes: the part of b(old) - b(new) along f."""
    return v * h * ((old - new) / (v * v + old * h * h)) / (v * v + new * h * h)


def _jumps(orbit: "Orbit", v: Array, h: Array, c: Array) -> Array:
    """What a gains on entering each panel from the one before, (P,); the backward arc follows the forward one."""
    panel = np.arange(c.size)
    arc = orbit.panels.arc
    starts = panel == orbit.first[arc]
    out = orbit.first[arc - arc % 2]
    before = np.where(starts, np.where((arc % 2 == 1) & (orbit.count[arc - arc % 2] > 0), out, panel), panel - 1)
    return np.where(before == panel, 0.0, _jump(v[:, 0], h[:, 0], c[before], c))


def _largest_growth(orbit: "Orbit", weight: Array, least: Array) -> Array:
    """The largest growth at the panels' nodes that the rod passes, at its far end, and of `least`, (B,)."""
    problem, panels = orbit.problem, orbit.panels
    b = panels.arc // 2
    # in a time in which the orbit's own rates are near one, and with speeds of at most one
    unit = np.sqrt(load_size(problem) + 1)
    speed = np.zeros(problem.size)
    np.maximum.at(speed, b, panels.fastest)
    speed = np.where(speed > 0, speed, 1.0)
    flow = _flow_of(orbit, unit, speed)
    start = _start(orbit, flow, weight / unit)
    worst = _growth_at_nodes(orbit, flow, start, least)
    moves = orbit.count.reshape(-1, 2).sum(axis=1) > 0
    worst[moves] = np.maximum(worst, _growth_at_end(orbit, flow, start, speed))[moves]
    return worst


def _growth_at_nodes(orbit: "Orbit", flow: _Flow, start: tuple[Array, Array], least: Array) -> Array:
    """The largest growth at the panels' nodes that the rod passes, in its first period and in its last, (B,)."""
    problem, panels = orbit.problem, orbit.panels
    arc, b, worst = panels.arc, panels.arc // 2, least.copy()
    points, span = basis(panels.series.shape[2] - 1), problem.span[b, None]
    running_a, across = flow.shear @ points.values, flow.across[:, None]
    clock = orbit.since[:, None] + (panels.duration / 2)[:, None] * (1 + points.nodes)
    there, back, period = (x[b, None] for x in (orbit.ahead, orbit.back, orbit.period))
    folded, second = (orbit.kind == LIBRATION)[b, None], (arc % 2 == 1)[:, None]
    ahead, after = flow.gain[0::2], flow.gain[1::2]
    a_period = np.where(orbit.kind == LIBRATION, 2 * (ahead + after), ahead)
    periods = np.floor(span / period)
    begin, end = np.where(second, 2 * there, 0), np.where(second, 2 * (there + back), 2 * there)
    shift, whole = np.where(second, 2 * ahead[b, None], 0), 2 * flow.gain[arc, None]
    direction = np.where(second, -1.0, 1.0)
    for a, time, sign, open_ in (
        (shift + running_a, begin + clock, 1.0, True),
        (shift + whole - running_a, end - clock, -1.0, folded),
    ):
        passed = open_ & ((time <= span) | (periods > 0))
        # the last period may end before this place
        many = np.where(periods > 0, periods - (time + periods * period > span), 0)
        for extra in (0.0, a_period[b, None] * many):
            v, h = direction * sign * flow.v, direction * flow.h
            grown = _grown([x[:, b, None] for x in start], a + extra, v, h, across)
            np.maximum.at(worst, b, np.where(passed, grown, 0).max(axis=1))
    return worst


def _growth_at_end(orbit: "Orbit", flow: _Flow, start: tuple[Array, Array], speed: Array) -> Array:
    """The growth at the far end of the rod, (B,)."""
    panels = orbit.panels
    b, points = panels.arc // 2, basis(panels.series.shape[2] - 1)
    series = np.zeros((b.size, 4, points.nodes.size + 1))
    series[:, 0], series[:, 1, :-1] = panels.series[:, 1] / speed[b, None], flow.h @ points.analyse
    series[:, 2], series[:, 3, 0] = flow.shear, flow.across
    phase = orbit.locate(orbit.problem.span[:, None])
    v, h, a, c = np.moveaxis(orbit.read(series, phase)[:, 0], 1, 0)
    librates = (orbit.kind == LIBRATION)[:, None]
    a = unfolded(a[:, None], phase, flow.gain.reshape(-1, 2), librates)[:, 0]
    direction = np.where(phase.second[:, 0], -1.0, 1.0)
    return _grown(start, a, direction * np.where(phase.mirrored[:, 0], -v, v), direction * h, c)


def _grown(start: Any, a: Array, v: Array, h: Array, c: Array) -> Array:
    """The larger of the two growths, where the start's changes are `start` along f and across it, (2, ...) each."""
    along, across = start
    size = v * v + c * h * h
    return np.asarray(np.abs((along + across * a) * v + across * (c * h / size)).max(axis=0))


def _start(orbit: "Orbit", flow: _Flow, weight: Array) -> tuple[Array, Array]:
    """What a change of beta and w times one of beta_t at the start are along f and across it, (2, B) each."""
    out = orbit.count[0::2] > 0
    panel: Integers = np.where(out, orbit.first[0::2], orbit.first[1::2])
    panel = np.minimum(panel, flow.across.size - 1)
    v, h, c = flow.v[panel, 0], flow.h[panel, 0] * np.where(out, 1.0, -1.0), flow.across[panel]
    size = v * v + c * h * h
    return np.stack([v / size, -c * h / size * weight]), np.stack([h, v * weight])


def flow_at_nodes(problem: StartProblem, panels: Panels, unit: Array) -> tuple[Array, Array, Array]:
    """|beta_t|, H and H' at the panels' nodes, (P, n) each, in time of 1/unit, (B,)."""
    b = panels.arc // 2
    loads, one = Loads.columns(problem, b), unit[b, None]
    points = basis(panels.series.shape[2] - 1)
    beta, v = panels.series[:, 0] @ points.values, panels.series[:, 1] @ points.values
    return v / one, slope(loads, beta) / one**2, slope_rate(loads, beta) / one**2


def shear(problem: StartProblem, panels: Panels, unit: Array) -> Array:
    """The series of the shear a(t) with c = 1 on each panel from its near end, (P, n + 1), in time of 1/unit, (B,)."""
    points = basis(panels.series.shape[2] - 1)
    v, H, rate = flow_at_nodes(problem, panels, unit)
    size = v * v + H * H
    pace = (1 - rate) * ((v - H) * (v + H) / size) / size
    scale: Array = (panels.duration / 2 * unit[panels.arc // 2])[:, None]
    return (pace * scale) @ points.analyse @ points.integrate
