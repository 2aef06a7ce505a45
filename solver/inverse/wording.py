"""What a fit says in words: its outcome, the rule of its intervals, and remarks on what limits it."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..numerics.arrays import Array
from ..problem.errors import choices
from ..problem.quantities import quantity
from ..problem.trajectory import SOLVED
from .data import scale_of
from .fit_result import NO_INTERVALS, OtherMinimum
from .parameters import POSITIVE, Parameter, values_in_words
from .uncertainty import LEVEL, Uncertainty

if TYPE_CHECKING:
    from .model import Minimum, Model

_REACHED = 1e-6  # relative: a target that is missed by more is not reached
UNLIKELY = 0.01  # probability of a larger sum of squares that is told
MISFIT = "misfit: "  # how such an outcome begins
IMPOSSIBLE = 1e-6  # below it, the minimum is no answer: it may be another one than that of the rod
_ALIKE = 0.99  # correlation of two parameters that is told
# Distance of the points in rho that is told: 0.5 rad or 29 degrees of azimuth. Errors of measurement are smaller, and
# the intervals are those of errors so small that the shape changes in proportion to them.
FAR = 0.5
_ROUNDING = 1e-9  # of the scale of a parameter: a smaller value is 0


def outcome(model: "Model", best: "Minimum", directions: Sequence[dict[str, float]], probability: float) -> str:
    """Solved, undetermined, a misfit, or failed, with the reason."""
    if best.stop:
        return f"failed: {best.stop}"
    if why := miss_of(model, best):
        return f"failed: {why}"
    if directions:
        return f"undetermined: {'; '.join(_tell(model, best, way) for way in directions)}"
    if probability < IMPOSSIBLE:
        return f"{MISFIT}{_too_large(probability)}"
    return SOLVED


def miss_of(model: "Model", best: "Minimum") -> str:
    """That no value reaches the targets, where there are no more of them than parameters; else ""."""
    data = model.data
    if data.points is not None or data.size > len(model.parameters):
        return ""
    target, reached = np.array(list(data.targets.values())), best.found.computed
    sizes = np.array([scale_of(model.case, name, value) for name, value in data.targets.items()])
    if (np.abs(reached - target) <= _REACHED * np.maximum(sizes, np.abs(reached))).all():
        return ""
    goals = choices(f"{name} = {value:g}" for name, value in data.targets.items())
    nearest = choices(f"{name} = {value:.6g}" for name, value in zip(data.targets, reached, strict=True))
    ranges = " and ".join(
        parameter.name + (parameter.between or _starts_in_words(model, parameter)) for parameter in model.parameters
    )
    verb = "reaches" if len(model.parameters) == 1 else "reach"
    place = values_in_words(model.parameters, best.x)
    return f"the search found no {ranges} that {verb} {goals}; the nearest reached is {nearest}, at {place}"


def miss(model: "Model", best: "Minimum") -> float:
    """The root mean square distance of the points from the rod in units of rho; of alpha and z alone."""
    points, sol = model.data.points, best.found.sol
    if points is None:
        return 0.0
    place = np.arange(points.size) if best.found.feet is None else best.found.feet.order
    square = np.zeros(points.size)
    if "alpha" in points.columns:
        off = points.columns["alpha"] - sol.alpha[place]
        if points.wrapped:
            off = off - 2 * np.pi * np.round(off / (2 * np.pi))
        square += off**2
    if "z" in points.columns:
        square += ((points.columns["z"] - sol.z[place]) / float(sol.case.rho)) ** 2
    return float(np.sqrt(square.mean()))


def _far(model: "Model", best: "Minimum", probability: float) -> str:
    """That the points are too far from the rod, unless sigma says that they may be; else ""."""
    far = miss(model, best)
    if far <= FAR or probability >= UNLIKELY:
        return ""
    return (
        f"the rod misses the points by {far:.3g} rho (root mean square): check the units of alpha (rad, or 17deg) and "
        "z, and where the rod begins"
    )


def _starts_in_words(model: "Model", parameter: Parameter) -> str:
    """Where the starts of a field without bounds lie."""
    if not model.starts:
        return f" (start: {parameter.value(parameter.start):.4g})"
    low, high = (parameter.value(x) for x in parameter.span)
    return f" (starts from {low:.4g} to {high:.4g})"


def _as_good(model: "Model", count: int, exact: bool) -> str:
    """How many other minima are as good as the best one."""
    if not exact:
        return f"the data do not exclude {count} other minim{'um' if count == 1 else 'a'}"
    what = "data" if model.data.points else "target" if len(model.data.targets) == 1 else "targets"
    many = len(model.parameters) > 1
    noun = ("set of values" if count == 1 else "sets of values") if many else "value" if count == 1 else "values"
    return f"{count} other {noun} {'reaches' if count == 1 else 'reach'} the {what}"


def _tell(model: "Model", best: "Minimum", way: dict[str, float]) -> str:
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
    return 0.0 if angular or abs(value) < _ROUNDING * parameter.scale else 1 / value


def _change(change: float, rate: float, name: str) -> str:
    """``+1 %``; for an angle or a value of 0 the change itself."""
    if rate:
        return f"{100 * change * rate:+.4g} %"
    return f"{change:+.4g}{' rad' if quantity(name).dimension == 'rad' else ''}"


def rule(sigma: bool, known: Uncertainty) -> str:
    """How the intervals were found."""
    percent = f"{100 * LEVEL:g} % intervals"
    if sigma:
        return f"{percent} by the given sigma and the normal distribution"
    if known.freedom <= 0:
        return NO_INTERVALS
    return f"{percent} by the variance of the residuals and Student's t with {known.freedom} degrees of freedom"


def remarks(
    model: "Model",
    best: "Minimum",
    directions: Sequence[dict[str, float]],
    correlation: Array,
    probability: float,
    others: Sequence[OtherMinimum],
    exact: bool,
) -> Iterator[str]:
    """Sentences on what limits the result."""
    parameters = model.parameters
    if best.stop or miss_of(model, best):  # else the outcome says it
        yield from (_tell(model, best, way) for way in directions)
    for parameter, x, free in zip(parameters, best.x, best.free, strict=True):
        if not free:
            yield (
                f"{parameter.name} ends at its bound, {parameter.value(float(x)):.6g}: it has no interval, and the "
                "intervals of other fields hold while it stays there"
            )
    if probability < UNLIKELY and not outcome(model, best, directions, probability).startswith(MISFIT):
        yield _too_large(probability)
    if far := _far(model, best, probability):
        yield far
    for i, j in np.argwhere(np.triu(np.abs(correlation) > _ALIKE, 1)):
        pair = f"{parameters[i].name} and {parameters[j].name}"
        yield f"the data hardly tell {pair} apart: correlation {correlation[i, j]:+.5f}"
    if good := sum(other.as_good for other in others):
        yield f"{_as_good(model, good, exact)}: the values are not unique"
    if count := model.refused.total():
        reason, _ = model.refused.most_common(1)[0]
        yield f"at {count} of the values tried the data cannot be computed, most often: {reason}"


def _too_large(probability: float) -> str:
    return (
        f"the residuals are larger than sigma allows (chance {probability:.1e}): sigma is too small, the assumed rod "
        "is wrong, or the search missed the right minimum (try more starts); the intervals are too narrow"
    )
