"""How an orbit answers to a change of its start: the condition number, without following any change along the rod.

Two changes of the start span all others. One along the flow f = (beta_t, -H) stays along it: it becomes f(t). One
across becomes a(t) f(t) + b(t) with b = (c H, beta_t)/D, D = beta_t^2 + c H^2, because the flow keeps areas; only the
shear a(t) has to be integrated, a' = (1 - c H') (beta_t^2 - c H^2)/D^2. It grows by the same amount each period, so a
rod of a million bends is again no more work than one of three, and next to a saddle no large numbers cancel.

c, a time squared, says which way is across. Any constant is right; one for each panel keeps D from nearly vanishing in
it, also where the whole orbit is slow (next to a fold) or small (next to a helix). Where c changes from one panel to
the next, b does by a multiple of f, which goes to a.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..mechanics.potential import Loads, slope, slope_higher_rates, slope_rate, slope_size
from ..numerics.arrays import Array
from ..numerics.chebyshev import basis
from ..problem.reduced import Reduced
from .panels import EPS, Panels, running
from .pieces import HELIX, LIBRATION

if TYPE_CHECKING:
    from .periodic_orbit import Orbit


def slope_weight(problem: Reduced) -> Array:
    """w = max(1, |beta_t(0)|, sqrt|H'(beta(0))|), (B,): what a change of beta_t(0) is multiplied by.

    A change of the slope then counts as one of the angle would a quarter of a swing later, so that the condition number
    does not depend on where in its swing an orbit happens to start.
    """
    assert problem.dbeta0 is not None
    natural = np.sqrt(np.abs(slope_rate(problem, problem.beta0)))
    return np.maximum(np.maximum(1, np.abs(problem.dbeta0)), natural)


def condition(orbit: "Orbit") -> Array:
    """Largest |d beta/d beta(0)| and w |d beta/d beta_t(0)| along the rod, at least 1, (B,); w as in `slope_weight`."""
    weight, (steady, worst) = slope_weight(orbit.problem), beside_helix(orbit.problem)
    moves = (orbit.arcs.kind != HELIX) & (orbit.count.reshape(-1, 2).sum(axis=1) > 0) & ~steady
    if moves.any():
        largest = np.where(moves, 1.0, worst)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            _along(orbit, weight, largest)
        worst = np.where(moves, np.where(np.isnan(largest), np.inf, largest), worst)
    return worst


def beside_helix(problem: Reduced) -> tuple[Any, Array]:
    """Which rods stay so near to one helix, or are so short, that H' hardly changes along them; and what the condition
    number is of all as if it did not: bounded about a centre, linear where H' = 0, exponential about a saddle, (B,)
    each.

    How far beta strays follows from H'(beta(0)) as if that were constant; by how much H' changes on this way, times the
    time in which a change of it works (all of it, or where the rod is long, one radian), has to stay small.
    """
    assert problem.dbeta0 is not None
    beta, span = problem.beta0, problem.span
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        rate, (second, _) = slope_rate(problem, beta), slope_higher_rates(problem, beta)
        even, odd = _fields(rate, span)
        strays = np.abs(problem.dbeta0) * odd + 2 * np.abs(slope(problem, beta)) * _fields(rate, span / 2)[1] ** 2
        third = np.abs(problem.lam) + 8 * np.abs(problem.mu) + np.abs(problem.phi) + 20  # nowhere larger
        change = np.abs(second) * strays + third * strays**2 / 2
        steady = change * span * np.fmin(span, 1 / np.sqrt(np.abs(rate))) < 0.1
        return steady, np.maximum(1, np.maximum(even, odd * slope_weight(problem)))


@dataclass(frozen=True, eq=False)
class _Flow:
    """The flow at the nodes of P panels in units of each problem's own time and largest speed.

    v, h: (P, n), beta_t and H as one travels away from the start; across: (P,), c; shear: (P, n + 1), the series of a
    from the start on, in its own part; total: (2 B,), what a whole part adds to it.
    """

    v: Array
    h: Array
    across: Array
    shear: Array
    total: Array


def _flow_of(orbit: "Orbit", unit: Array, speed: Array) -> _Flow:
    problem, panels = orbit.problem, orbit.panels
    points, b = basis(panels.series.shape[2] - 1), panels.arc // 2
    loads, one = Loads.columns(problem, b), unit[b, None]
    beta, v = panels.series[:, 0] @ points.values, panels.series[:, 1] @ points.values / speed[b, None]
    half = (panels.duration / 2)[:, None] * one
    h = _slope_along(orbit, loads, beta, v, half, speed[b, None] * one)
    rate = slope_rate(loads, beta) / one**2
    c = _across(v, np.abs(h), rate, half[:, 0])
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
    """H at the panels' nodes, (P, n), as one travels away from the start.

    Of H at beta no digit may be left, next to a helix; of the derivative of the speed none, in a very short panel. So
    that which loses less.
    """
    points, panels = basis(v.shape[1]), orbit.panels
    way = orbit.arcs.direction[panels.arc // 2] * np.where(panels.arc % 2 == 1, -1, 1)
    turns = v.min(axis=1) < v.max(axis=1) / 2
    lost = EPS * v.shape[1] ** 2 * np.where(turns, 1, v.max(axis=1)) / half[:, 0]
    direct = EPS * slope_size(loads, beta).max(axis=1) / unit[:, 0] < lost
    derived = -(v @ points.analyse @ points.differentiate) / half
    return np.where(direct[:, None], way[:, None] * slope(loads, beta) / unit, derived)


def _across(v: Array, h: Array, rate: Array, half: Array) -> Array:
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
    """What a gains on entering each panel from the one before, (P,); a backward course follows the forward one."""
    panel = np.arange(c.size)
    part = orbit.panels.arc
    starts = panel == orbit.first[part]
    out = orbit.first[part - part % 2]
    before = np.where(starts, np.where((part % 2 == 1) & (orbit.count[part - part % 2] > 0), out, panel), panel - 1)
    return np.where(before == panel, 0.0, _jump(v[:, 0], h[:, 0], c[before], c))


def _along(orbit: "Orbit", weight: Array, worst: Array) -> None:
    """Raise `worst` (B,) to the largest growth at the panels' nodes that the rod meets, and at its far end."""
    problem, panels = orbit.problem, orbit.panels
    part = panels.arc
    b = part // 2
    # in a time in which the orbit's own rates are near one, and with speeds of at most one
    unit = np.sqrt(np.abs(problem.lam) + np.abs(problem.mu) + np.abs(problem.phi) + 1)
    speed = np.zeros(problem.size)
    np.maximum.at(speed, b, panels.fastest)
    speed = np.where(speed > 0, speed, 1.0)
    flow = _flow_of(orbit, unit, speed)
    start = _start(orbit, flow, weight / unit)
    points, span = basis(panels.series.shape[2] - 1), problem.span[b, None]
    running_a, across = flow.shear @ points.values, flow.across[:, None]
    clock = orbit.since[:, None] + (panels.duration / 2)[:, None] * (1 + points.nodes)
    there, back, period = (x[b, None] for x in (orbit.ahead, orbit.back, orbit.period))
    folded, second = (orbit.kind == LIBRATION)[b, None], (part % 2 == 1)[:, None]
    ahead, after = flow.total[0::2], flow.total[1::2]
    a_round = np.where(orbit.kind == LIBRATION, 2 * (ahead + after), ahead)
    rounds = np.floor(span / period)
    begin, end = np.where(second, 2 * there, 0), np.where(second, 2 * (there + back), 2 * there)
    shift, whole = np.where(second, 2 * ahead[b, None], 0), 2 * flow.total[part, None]
    way = np.where(second, -1.0, 1.0)
    for a, time, sign, open_ in (
        (shift + running_a, begin + clock, 1.0, True),
        (shift + whole - running_a, end - clock, -1.0, folded),
    ):
        met = open_ & ((time <= span) | (rounds > 0))
        # the last of the rounds may end before this place
        many = np.where(rounds > 0, rounds - (time + rounds * period > span), 0)
        for extra in (0.0, a_round[b, None] * many):
            grown = _grown([x[:, b, None] for x in start], a + extra, way * sign * flow.v, way * flow.h, across)
            np.maximum.at(worst, b, np.where(met, grown, 0).max(axis=1))
    series = np.zeros((part.size, 4, points.nodes.size + 1))
    series[:, 0], series[:, 1, :-1] = panels.series[:, 1] / speed[b, None], flow.h @ points.analyse
    series[:, 2], series[:, 3, 0] = flow.shear, flow.across
    where = orbit.locate(problem.span[:, None])
    v, h, a, c = np.moveaxis(orbit.read(series, where)[:, 0], 1, 0)
    second, mirrored = where.second[:, 0], where.mirrored[:, 0]
    a = np.where(mirrored, 2 * np.where(second, after, ahead) - a, a) + np.where(second, 2 * ahead, 0)
    way = np.where(second, -1.0, 1.0)
    a = a + where.rounds[:, 0] * a_round
    moves = orbit.count.reshape(-1, 2).sum(axis=1) > 0
    grown = _grown(start, a, way * np.where(mirrored, -v, v), way * h, c)
    worst[moves] = np.maximum(worst, grown)[moves]


def _grown(start: Any, a: Array, v: Array, h: Array, c: Array) -> Array:
    """The larger of the two growths, where the start's changes are `start` along f and across it, (2, ...) each."""
    along, across = start
    size = v * v + c * h * h
    return np.asarray(np.abs((along + across * a) * v + across * (c * h / size)).max(axis=0))


def _start(orbit: "Orbit", flow: _Flow, weight: Array) -> tuple[Array, Array]:
    """What a change of beta and w times one of beta_t at the start are along f and across it, (2, B) each."""
    out = orbit.count[0::2] > 0
    panel = np.where(out, orbit.first[0::2], orbit.first[1::2])
    panel = np.minimum(panel, flow.across.size - 1)
    v, h, c = flow.v[panel, 0], flow.h[panel, 0] * np.where(out, 1.0, -1.0), flow.across[panel]
    size = v * v + c * h * h
    return np.stack([v / size, -c * h / size * weight]), np.stack([h, v * weight])


def _flow(problem: Reduced, panels: Panels, unit: Array) -> tuple[Array, Array, Array]:
    """|beta_t|, H and H' at the panels' nodes, (P, n) each, in a unit of time for each problem: 1/unit, (B,)."""
    b = panels.arc // 2
    loads, one = Loads.columns(problem, b), unit[b, None]
    points = basis(panels.series.shape[2] - 1)
    beta, v = panels.series[:, 0] @ points.values, panels.series[:, 1] @ points.values
    return v / one, slope(loads, beta) / one**2, slope_rate(loads, beta) / one**2


def shear(problem: Reduced, panels: Panels, unit: Array) -> Array:
    """The series of the shear a(t) with c = 1 on each panel from its near end, (P, n + 1), in time of 1/unit, (B,)."""
    points = basis(panels.series.shape[2] - 1)
    v, H, rate = _flow(problem, panels, unit)
    size = v * v + H * H
    pace = (1 - rate) * ((v - H) * (v + H) / size) / size
    scale: Array = (panels.duration / 2 * unit[panels.arc // 2])[:, None]
    return (pace * scale) @ points.analyse @ points.integrate


def _fields(rate: Array, span: Array) -> tuple[Array, Array]:
    """The largest values on [0, span] of the two solutions of eta'' = -rate eta that begin as 1 and as t, (B,) each."""
    root = np.sqrt(np.abs(rate))
    angle = np.minimum(root * span, 700)
    bounded = np.where(angle < np.pi / 2, np.sin(angle), 1.0)
    odd = np.where(rate > 0, bounded, np.sinh(angle)) / root
    return np.where(rate >= 0, 1.0, np.cosh(angle)), np.where(root * span > 1e-150, odd, span)
