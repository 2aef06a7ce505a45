"""From the minima of a search to the result of a fit."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import special

from ..numerics.arrays import Array
from . import wording
from .data import DISTANCE
from .fit_result import Fit, OtherMinimum
from .parameters import values_at
from .uncertainty import LEVEL, Uncertainty, uncertainty

if TYPE_CHECKING:
    from .model import Minimum, Model

EQUAL = 1e-6  # relative: of two sums of squares that differ by less, none is lower
ZERO = 1e-16  # a sum of squares of N data is 0 where it is smaller than N times this
_EXACT = 1e-6  # a residual of data that are no more than the parameters: it is reached


def result(model: "Model", minima: Sequence["Minimum"]) -> Fit:
    """The result; minima: what a search found, the best one first, or none where there was no value at all."""
    if not minima:
        return _nothing(model)
    best, data, parameters = minima[0], model.data, model.parameters
    known = uncertainty(parameters, best.x, best.jacobian, best.found.residuals, data.known, best.free)
    names = [parameter.name for parameter in parameters]
    directions = [_in_units(model, way) for way in known.directions]
    others = tuple(_others(model, minima, known))
    back = _as_given(model)
    exact = not data.known and known.freedom <= 0
    tested = data.known and known.freedom > 0
    probability = float(special.chdtrc(known.freedom, 2 * best.cost)) if tested else np.nan
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = np.sqrt(np.diag(known.covariance))
        correlation = known.covariance / np.outer(spread, spread)
    return Fit(
        outcome=wording.outcome(model, best, directions, probability),
        reached=wording.miss_of(model, best) == "",
        values=values_at(parameters, best.x),
        intervals={n: (float(a), float(b)) for n, a, b in zip(names, known.low, known.high, strict=True)},
        rule=wording.rule(data.known, known),
        covariance=known.covariance,
        correlation=correlation,
        condition=known.condition,
        directions=directions,
        shares={name: row[back] for name, row in zip(names, known.shares, strict=True)},
        groups=tuple(data.groups),
        measured=_measure(model)[back],
        computed=best.found.computed[back],
        residuals=best.found.residuals[back],
        feet=_feet(model, best),
        cost=best.cost,
        freedom=known.freedom,
        probability=probability,
        minima=others,
        remarks=tuple(wording.remarks(model, best, directions, correlation, probability, others, exact)),
        case=best.found.sol.case,
        solution=best.found.sol,
        solves=model.solves,
        derivatives=model.derivatives,
    )


def _nothing(model: "Model") -> Fit:
    """The result where the data cannot be computed at any of the values tried."""
    F, N = len(model.parameters), model.data.size
    empty, nothing = np.full((F, F), np.nan), np.full(N, np.nan)
    names = [parameter.name for parameter in model.parameters]
    why = model.refused.most_common(1)[0][0]
    return Fit(
        outcome=f"failed: at none of the values tried the data can be computed, most often: {why}", reached=True,
        values=dict.fromkeys(names, np.nan), intervals=dict.fromkeys(names, (np.nan, np.nan)), rule="",
        covariance=empty, correlation=empty, condition=np.inf, directions=[],
        shares={name: nothing for name in names}, groups=tuple(model.data.groups),
        measured=_measure(model)[_as_given(model)], computed=nothing, residuals=nothing, feet=None, cost=np.inf,
        freedom=N - F, probability=np.nan, minima=(), remarks=(), case=model.case, solution=None, solves=model.solves,
        derivatives=model.derivatives,
    )  # fmt: skip


def _in_units(model: "Model", way: Array) -> dict[str, float]:
    """A direction by field: relative for a positive field, else in its unit; scaled so that the first one is 1."""
    changes = {
        parameter.name: d * (parameter.scale or 1.0) for parameter, d in zip(model.parameters, way, strict=True) if d
    }
    first = next(iter(changes.values()))
    return {name: float(value / first) for name, value in changes.items()}


def _others(model: "Model", minima: Sequence["Minimum"], known: Uncertainty) -> "list[OtherMinimum]":
    """The other minima. Where the data do not determine all parameters, equal ones are places of one valley."""
    places: list[Minimum] = [minima[0]]
    for minimum in minima[1:]:
        levels = [other.cost * (1 + EQUAL) + model.data.size * ZERO for other in places]
        low = any(minimum.cost <= level for level in levels) if known.directions else False
        if not minimum.stop and not low:
            places.append(minimum)
    return [
        OtherMinimum(
            values_at(model.parameters, minimum.x), minimum.cost, _as_good(model, minimum, minima[0], known),
            tuple(part.name for part, free in zip(model.parameters, minimum.free, strict=True) if not free),
        )
        for minimum in places[1:]
    ]  # fmt: skip


def _as_good(model: "Model", minimum: "Minimum", best: "Minimum", known: Uncertainty) -> bool:
    """Whether the data do not exclude a minimum: by the likelihood ratio, or where sigma is unknown by the F test."""
    F, more = best.x.size, 2 * (minimum.cost - best.cost)
    if model.data.known:
        return bool(more <= special.chdtri(F, 1 - LEVEL))
    if known.freedom <= 0:
        return bool(np.abs(minimum.found.residuals).max() <= _EXACT)
    variance = 2 * best.cost / known.freedom
    return bool(more <= F * variance * special.fdtri(F, known.freedom, LEVEL))


def _measure(model: "Model") -> Array:
    """The data as measured, (N,); the distance of a point is 0."""
    points = model.data.points
    columns = [np.array(list(model.data.targets.values()))]
    if points is not None:
        columns += [np.zeros(points.size)] if points.groups == (DISTANCE,) else list(points.columns.values())
    return np.concatenate(columns)


def _as_given(model: "Model") -> Any:
    """The indices that put points back into the order in which they were given, (N,)."""
    targets, points = len(model.data.targets), model.data.points
    parts = [np.arange(targets)]
    if points is not None:
        back = np.argsort(points.order, kind="stable")
        parts += [targets + k * points.size + back for k in range(len(points.groups))]
    return np.concatenate(parts)


def _feet(model: "Model", best: "Minimum") -> tuple[Array, Array, Array] | None:
    """s, alpha and z of the rod at the points, in the order in which these were given."""
    points, evaluation = model.data.points, best.found
    if points is None:
        return None
    place = np.arange(points.size) if evaluation.feet is None else evaluation.feet.order
    at = place[np.argsort(points.order, kind="stable")]
    return evaluation.sol.s[at], evaluation.sol.alpha[at], evaluation.sol.z[at]
