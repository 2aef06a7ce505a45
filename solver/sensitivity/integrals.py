"""The derivatives of integrals along rods.

The change of a density has a part a times its pace along the orbit; that part is integrated by parts, so that what is
summed depends on the angle alone and whole periods add by their number.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..equilibrium import orbit_rates
from ..numerics.arrays import Array, Integers
from ..numerics.chebyshev import basis, derivative, polynomials
from ..numerics.roots import bracket
from ..observe.measurement import BARELY
from .density_changes import DensityChange


def integral(rods: DensityChange) -> Array:
    """Of the integral over the rod, (b, F)."""
    refined = rods.refined
    return _sums(refined, lambda v: v, np.ones_like, [refined])[0]


def parts(cut: DensityChange) -> tuple[Array, Array, Array]:
    """Of the integrals of the positive and of minus the negative values, and of the length of the positive ones.

    cut: of `cut_at_zeros`.
    """
    positive = (cut.nodes.values.mean(axis=1) > 0).astype(float)[:, None]
    (down,) = _sums(cut, lambda v: np.maximum(-v, 0), lambda v: (v <= 0) * -1.0, [cut])
    return _positive(cut, [cut])[0], down, _share(cut, positive)


def positive_between(cut: DensityChange, low: float, high: float) -> Array:
    """Of the integral of the positive values between two shares of the length, (b, F). cut: of `cut_at_zeros`."""
    short, long = _positive(cut, [cut.until(low), cut.until(high)])
    return long - short


def _positive(cut: DensityChange, lengths: list[DensityChange]) -> list[Array]:
    return _sums(cut, lambda v: np.maximum(v, 0), lambda v: (v > 0) * 1.0, lengths)


def _sums(
    rods: DensityChange,
    kept: Callable[[Array], Array],
    rate: Callable[[Array], Array],
    lengths: list[DensityChange],
) -> list[Array]:
    """Of the integrals of kept(values) over some lengths of the same rods, (b, F) each.

    rate: the derivative of `kept`, constant on each panel.
    """
    factor = rate(rods.nodes.values.mean(axis=1))[:, None]
    moved = np.moveaxis(rods.nodes.moved, 2, 1) * factor[..., None]
    still = rods.closest[1]
    level, size = kept(still), BARELY * (1 + np.abs(still))
    above = kept(rods.nodes.values) - level[rods.case, None]
    turned = factor * rods.differences
    near = rods.near & (np.abs(above - turned).max(axis=1) <= size[rods.case])
    above[near] = turned[near]
    none, found = np.zeros((rods.case.size, 4)), []
    for one in lengths:
        first, last = _above_at_ends(one, kept, rate, rods.closest)
        found.append(_by_parts(one, above, moved, none, first, last) + kept(one.ends[1].values)[:, None] * one.later)
    return found


def _above_at_ends(
    rods: DensityChange,
    kept: Callable[[Array], Array],
    rate: Callable[[Array], Array],
    closest: tuple[Integers, Array],
) -> list[Array]:
    """kept(values) at the two ends less that at rest at the closest critical point, (b,) each."""
    panel, still = closest
    level, size = kept(still), BARELY * (1 + np.abs(still))
    ends, rows = [], np.arange(panel.size)
    for t, place, values in zip(rods.times, rods.places, rods.ends, strict=True):
        base, x = (v[:, 0] for v in rods.varied.angles(t[:, None]))
        exact = rods.difference(rows, base[:, None], x[:, None], np.abs(place.v)[:, None])[:, 0]
        exact, plain = rate(values.values) * exact, kept(values.values) - level
        same = np.abs(np.sin((base - rods.varied.base[panel]) / 2)) < orbit_rates.SAME
        ends.append(np.where(same & (np.abs(plain - exact) <= size), exact, plain))
    return ends


def _share(rods: DensityChange, positive: Array) -> Array:
    """Of the length where the values are positive, (b, F): what it gains at every zero that it passes."""
    arc, panel = rods.varied.orbit.panels.arc, np.arange(rods.case.size)
    before = np.where(panel == rods.varied.orbit.first[arc], panel, panel - 1)
    crossed = positive[before, 0] != positive[:, 0]
    gained = rods.nodes.moved[:, 0] / np.abs(rods.nodes.pace[:, :1])
    jump = np.where(crossed[:, None], gained, 0.0)
    level = (rods.closest[1] > 0) * 1.0
    above = np.broadcast_to(positive - level[rods.case, None], rods.nodes.values.shape)
    begin, end = ((one.values > 0) * 1.0 for one in rods.ends)
    moved = np.zeros((rods.case.size, 4, above.shape[1]))
    return _by_parts(rods, above, moved, jump, begin - level, end - level) + end[:, None] * rods.later


def _by_parts(rods: DensityChange, above: Array, moved: Array, jump: Array, first: Array, last: Array) -> Array:
    """The integral of the change of a density: a times its pace is integrated by parts, so that a need not be.

    above (P, n), first and last (b,): the density at the nodes and at the two ends less that at the closest saddle.
    """
    varied, B = rods.varied, rods.problem.size
    rates = moved - above[:, None] * varied.nodes.M[:, :4]
    jumps = jump - above[:, :1] * varied.jump[:, :4]
    closing = -first[np.arange(2 * B) // 2, None] * varied.closing[:, :4]
    sums = varied.sums(rates, jumps, closing, rods.span)
    ends = rods.a * last[:, None] - rods.a0 * first[:, None]
    return np.asarray(np.einsum("bk,bfk->bf", sums, rods.e) + ends)


def cut_at_zeros(rods: DensityChange) -> DensityChange:
    """The same on panels on which the values have one sign."""
    found = _cut_at_turns(rods.refined)
    q, _, x = zeros_between(found.nodes.values)
    inside = np.abs(x) < 1 - 1e-12
    return replace(found, varied=found.varied.cut(q[inside], x[inside])) if q.size else found


def _cut_at_turns(rods: DensityChange) -> DensityChange:
    """The same, cut where the values turn between two nodes and have another sign there than at both nodes."""
    q, cell, x = zeros_between(rods.nodes.pace)
    up = rods.nodes.values > 0
    turned = rods.at(rods.case[q], *rods.varied.on_panels(q, x[:, None])).values[:, 0] > 0
    dips = (up[q, cell] == up[q, cell + 1]) & (up[q, cell] != turned)
    return replace(rods, varied=rods.varied.cut(q[dips], x[dips])) if dips.any() else rods


def zeros_between(values: Array) -> tuple[Integers, Integers, Array]:
    """Where series given by values at the nodes (P, n) change their sign: panels, the node before, and places, (N,)."""
    points, up = basis(values.shape[1]), values > 0
    q, cell = np.nonzero(up[:, 1:] != up[:, :-1])
    rises = up[q, cell + 1]
    one, other = points.nodes[cell], points.nodes[cell + 1]
    series = values[q] @ points.analyse
    both = np.stack([series, series @ derivative(points.nodes.size)])

    def value_and_rate(x: Array) -> tuple[Array, Array]:
        found = np.einsum("kcn,nc->kc", both, polynomials(x, points.nodes.size))
        return found[0], found[1]

    low, high = np.where(rises, one, other), np.where(rises, other, one)
    return q, cell, bracket(value_and_rate, low, high, steps=60)
