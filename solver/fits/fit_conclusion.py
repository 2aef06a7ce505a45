"""From the minima of a search to the result of a fit, and its words: the outcome, the intervals, what limits it."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy import special

from ..numerics.arrays import ALIKE, NEGLIGIBLE, Array, whole_turns
from ..problem.declared_fields import POSITIVE
from ..problem.errors import choices
from ..problem.outcomes import SOLVED
from ..problem.quantities import quantity
from .data import scale_of
from .fit_result import NO_INTERVALS, Fit, OtherMinimum
from .model import FitMinimum, Model
from .parameters import Parameter, values_at, values_in_words
from .uncertainty import LEVEL, Uncertainty, uncertainty

# a sum of squares of N data is 0 where it is smaller than N times this: 1e-8 of a standard error each. x10: as good
ZERO = 1e-16


# probability of a larger sum of squares that is told, as statistics has it. x10: one good fit in ten is said to miss
UNLIKELY = 0.01
MISFIT = "misfit: "  # how such an outcome begins
# below it, the minimum is no answer: it may be another one than that of the rod. x10: one fit in 100,000 whose errors
# are as stated is refused
IMPOSSIBLE = 1e-6
# correlation of two parameters that is told: each alone is known seven times worse than with the other given. x10: none
# is told
_ALIKE = 0.99
# Distance of the points in rho that is told: 0.5 rad or 29 degrees of azimuth. Errors of measurement are smaller, and
# the intervals are those of errors so small that the shape changes in proportion to them. x10: points on the other side
# are not told
FAR = 0.5


def result(model: Model, minima: Sequence[FitMinimum]) -> Fit:
    """The result; minima: what a search found, the best one first, or none where there was no value at all."""
    if not minima:
        why = f"most often: {model.refused.most_common(1)[0][0]}"
        return replace(
            _empty_fit(model), outcome=f"failed: at none of the values tried the data can be computed, {why}"
        )
    best, data, parameters = minima[0], model.data, model.parameters
    known = uncertainty(parameters, best.x, best.jacobian, best.found.residuals, data.known, best.free)
    names = [parameter.name for parameter in parameters]
    directions = [_in_units(model, way) for way in known.directions]
    others = tuple(_others(model, minima, known))
    exact = not data.known and known.freedom <= 0
    tested = data.known and known.freedom > 0
    probability = float(special.chdtrc(known.freedom, 2 * best.cost)) if tested else np.nan
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = np.sqrt(np.diag(known.covariance))
        correlation = known.covariance / np.outer(spread, spread)
    return replace(
        _empty_fit(model),
        outcome=_outcome(model, best, directions, probability),
        reached=_miss_of(model, best) == "",
        values=values_at(parameters, best.x),
        intervals={n: (float(a), float(b)) for n, a, b in zip(names, known.low, known.high, strict=True)},
        rule=_rule(data.known, known),
        covariance=known.covariance,
        correlation=correlation,
        condition=known.condition,
        directions=directions,
        shares={name: row[data.as_given] for name, row in zip(names, known.shares, strict=True)},
        computed=best.found.computed[data.as_given],
        residuals=best.found.residuals[data.as_given],
        feet=_feet(model, best),
        cost=best.cost,
        freedom=known.freedom,
        probability=probability,
        minima=others,
        remarks=tuple(_remarks(model, best, directions, correlation, probability, others, exact)),
        case=best.found.sol.case,
        solution=best.found.sol,
    )


def _empty_fit(model: Model) -> Fit:
    """The result before anything is known of the values."""
    F, N = len(model.parameters), model.data.size
    empty, nothing = np.full((F, F), np.nan), np.full(N, np.nan)
    names = [parameter.name for parameter in model.parameters]
    return Fit(
        outcome="", reached=True, values=dict.fromkeys(names, np.nan),
        intervals=dict.fromkeys(names, (np.nan, np.nan)), rule="",
        covariance=empty, correlation=empty, condition=np.inf, directions=[],
        shares={name: nothing for name in names}, groups=tuple(model.data.groups),
        measured=model.data.measured[model.data.as_given], computed=nothing, residuals=nothing, feet=None, cost=np.inf,
        freedom=N - F, probability=np.nan, minima=(), remarks=(), case=model.case, solution=None, solves=model.solves,
        derivatives=model.derivatives,
    )  # fmt: skip


def _in_units(model: Model, way: Array) -> dict[str, float]:
    """A direction by field: relative for a positive field, else in its unit; scaled so that the first one is 1."""
    changes = {
        parameter.name: d * (parameter.scale or 1.0) for parameter, d in zip(model.parameters, way, strict=True) if d
    }
    first = next(iter(changes.values()))
    return {name: float(value / first) for name, value in changes.items()}


def _others(model: Model, minima: Sequence[FitMinimum], known: Uncertainty) -> list[OtherMinimum]:
    """The other minima. Where the data do not determine all parameters, equal ones are places of one valley."""
    places: list[FitMinimum] = [minima[0]]
    for minimum in minima[1:]:
        # of two sums of squares that differ by less than ALIKE, none is lower
        levels = [other.cost * (1 + ALIKE) + model.data.size * ZERO for other in places]
        low = any(minimum.cost <= level for level in levels) if known.directions else False
        if not minimum.stop and not low:
            places.append(minimum)
    return [
        OtherMinimum(
            values_at(model.parameters, minimum.x),
            minimum.cost,
            _as_good(model, minimum, minima[0], known),
            tuple(part.name for part, free in zip(model.parameters, minimum.free, strict=True) if not free),
        )
        for minimum in places[1:]
    ]


def _as_good(model: Model, minimum: FitMinimum, best: FitMinimum, known: Uncertainty) -> bool:
    """Whether the data do not exclude a minimum: by the likelihood ratio, or where sigma is unknown by the F test."""
    F, more = best.x.size, 2 * (minimum.cost - best.cost)
    if model.data.known:
        return bool(more <= special.chdtri(F, 1 - LEVEL))
    if known.freedom <= 0:
        # ALIKE, of a residual: a datum that is missed by more is not reached
        return bool(np.abs(minimum.found.residuals).max() <= ALIKE)
    variance = 2 * best.cost / known.freedom
    return bool(more <= F * variance * special.fdtri(F, known.freedom, LEVEL))


def _feet(model: Model, best: FitMinimum) -> tuple[Array, Array, Array] | None:
    """s, alpha and z of the rod at the points, in the order in which these were given."""
    points, sol = model.data.points, best.found.sol
    if points is None:
        return None
    at = best.found.place[np.argsort(points.order)]
    return sol.s[at], sol.alpha[at], sol.z[at]


def _outcome(model: Model, best: FitMinimum, directions: Sequence[dict[str, float]], probability: float) -> str:
    """Solved, undetermined, a misfit, or failed, with the reason."""
    if best.stop:
        return f"failed: {best.stop}"
    if why := _miss_of(model, best):
        return f"failed: {why}"
    if directions:
        return f"undetermined: {'; '.join(_tell(model, best, way) for way in directions)}"
    if probability < IMPOSSIBLE:
        return f"{MISFIT}{_too_large(probability)}"
    return SOLVED


def _miss_of(model: Model, best: FitMinimum) -> str:
    """That no value reaches the targets, where there are no more of them than parameters; else ""."""
    data = model.data
    if data.points is not None or data.size > len(model.parameters):
        return ""
    target, reached = np.array(list(data.targets.values())), best.found.computed
    sizes = np.array([scale_of(model.case, name, value) for name, value in data.targets.items()])
    if (np.abs(reached - target) <= ALIKE * np.maximum(sizes, np.abs(reached))).all():
        return ""
    goals = choices(f"{name} = {value:g}" for name, value in data.targets.items())
    nearest = choices(f"{name} = {value:.6g}" for name, value in zip(data.targets, reached, strict=True))
    ranges = " and ".join(
        parameter.name + (parameter.between or _starts_in_words(model, parameter)) for parameter in model.parameters
    )
    verb = "reaches" if len(model.parameters) == 1 else "reach"
    place = values_in_words(model.parameters, best.x)
    return f"the search found no {ranges} that {verb} {goals}; the nearest reached is {nearest}, at {place}"


def _far(model: Model, best: FitMinimum, probability: float) -> str:
    """That the points are too far from the rod, by alpha and z alone, unless sigma says that they may be; else ""."""
    points, sol = model.data.points, best.found.sol
    if points is None or probability >= UNLIKELY:
        return ""
    place = best.found.place
    square = np.zeros(points.size)
    if "alpha" in points.columns:
        off = points.columns["alpha"] - sol.alpha[place]
        if points.wrapped:
            off = off - whole_turns(off)
        square += off**2
    if "z" in points.columns:
        square += ((points.columns["z"] - sol.z[place]) / float(sol.case.rho)) ** 2
    far = float(np.sqrt(square.mean()))
    if far <= FAR:
        return ""
    return (
        f"the rod misses the points by {far:.3g} rho (root mean square): check the units of alpha (rad, or 17deg) and "
        "z, and where the rod begins"
    )


def _starts_in_words(model: Model, parameter: Parameter) -> str:
    """Where the starts of a field without bounds lie."""
    if not model.starts:
        return f" (start: {parameter.value(parameter.start):.4g})"
    low, high = (parameter.value(x) for x in parameter.span)
    return f" (starts from {low:.4g} to {high:.4g})"


def _tell(model: Model, best: FitMinimum, way: dict[str, float]) -> str:
    """A direction in words."""
    if len(way) == 1:
        return f"the data do not depend on {next(iter(way))}"
    rates = {
        parameter.name: _rate(parameter, parameter.value(float(x)))
        for parameter, x in zip(model.parameters, best.x, strict=True)
        if parameter.name in way
    }
    relative = next((name for name, rate in rates.items() if rate), None)
    size = 0.01 if relative is None else 0.01 / (way[relative] * rates[relative])
    parts = {name: _change(size * value, rates[name], name) for name, value in way.items()}
    names, same = list(parts), len(set(parts.values())) == 1 and relative is not None
    if same:
        changes = f"{', '.join(names[:-1])} and {names[-1]} by {parts[names[0]]} each"
    else:
        changes = choices(f"{name} by {part}" for name, part in parts.items())
    return f"the data cannot tell {' and '.join(way)} apart: no datum changes when these change together, {changes}"


def _rate(parameter: Parameter, value: float) -> float:
    """The relative change of a field for a change by 1 of its direction; 0 for an angle and for a value of 0."""
    if parameter.name in POSITIVE:
        return 1.0
    angular = quantity(parameter.name).dimension == "rad"
    # a value below this share of the scale of its parameter is 0
    return 0.0 if angular or abs(value) < NEGLIGIBLE * parameter.scale else 1 / value


def _change(change: float, rate: float, name: str) -> str:
    """``+1 %``; for an angle or a value of 0 the change itself."""
    if rate:
        return f"{100 * change * rate:+.4g} %"
    return f"{change:+.4g}{' rad' if quantity(name).dimension == 'rad' else ''}"


def _rule(sigma: bool, known: Uncertainty) -> str:
    """How the intervals were found."""
    percent = f"{100 * LEVEL:g} % intervals"
    if sigma:
        return f"{percent} by the given sigma and the normal distribution"
    if known.freedom <= 0:
        return NO_INTERVALS
    degrees = f"{known.freedom} degree{'s' * (known.freedom != 1)} of freedom"
    return f"{percent} by the variance of the residuals and Student's t with {degrees}"


def _remarks(
    model: Model,
    best: FitMinimum,
    directions: Sequence[dict[str, float]],
    correlation: Array,
    probability: float,
    others: Sequence[OtherMinimum],
    exact: bool,
) -> Iterator[str]:
    """Sentences on what limits the result."""
    parameters = model.parameters
    if best.stop or _miss_of(model, best):  # else the outcome says it
        yield from (_tell(model, best, way) for way in directions)
    for parameter, x, free in zip(parameters, best.x, best.free, strict=True):
        if not free:
            yield (
                f"{parameter.name} ends at its bound, {parameter.value(float(x)):.6g}: it has no interval, and the "
                "intervals of other fields hold while it stays there"
            )
    if probability < UNLIKELY and not _outcome(model, best, directions, probability).startswith(MISFIT):
        yield _too_large(probability)
    if far := _far(model, best, probability):
        yield far
    for i, j in np.argwhere(np.triu(np.abs(correlation) > _ALIKE, 1)):
        pair = f"{parameters[i].name} and {parameters[j].name}"
        yield f"the data hardly tell {pair} apart: correlation {correlation[i, j]:+.5f}"
    if good := sum(other.as_good for other in others):
        what = "the data are also reached at" if exact else "the data do not exclude"
        yield f"{what} {good} other minim{'um' if good == 1 else 'a'}: the values are not unique"
    if count := model.refused.total():
        reason, _ = model.refused.most_common(1)[0]
        yield f"at {count} of the values tried the data cannot be computed, most often: {reason}"


def _too_large(probability: float) -> str:
    return (
        f"the residuals are larger than sigma allows (chance {probability:.1e}): sigma is too small, the assumed rod "
        "is wrong, or the search missed the right minimum (try more starts); the intervals are too narrow"
    )
