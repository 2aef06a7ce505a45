"""What a fit says in words: its outcome, the rule of its intervals, and remarks on what limits it."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..numerics.arrays import Array
from ..problem.errors import choices
from ..problem.trajectory import SOLVED
from .data import scale_of
from .parameters import POSITIVE, written
from .result import OtherMinimum
from .uncertainty import LEVEL, Uncertainty

if TYPE_CHECKING:
    from .model import Model
    from .search import Minimum

_REACHED = 1e-6  # relative: a target that is missed by more is not reached
UNLIKELY = 0.01  # probability of a larger sum of squares
_ALIKE = 0.99  # correlation of two parameters that is told


def outcome(model: "Model", best: "Minimum", directions: Sequence[dict[str, float]]) -> str:
    """Solved, undetermined, or failed, with the reason."""
    if best.stop:
        return f"failed: {best.stop}"
    if why := missed(model, best):
        return f"failed: {why}"
    if directions:
        return f"undetermined: {'; '.join(_told(way) for way in directions)}"
    return SOLVED


def missed(model: "Model", best: "Minimum") -> str:
    """That no value reaches the targets, where there are no more of them than parameters; else ""."""
    data = model.data
    if data.points is not None or data.size > len(model.parameters):
        return ""
    wanted, reached = np.array(list(data.targets.values())), best.found.computed
    sizes = np.array([scale_of(model.case, name, value) for name, value in data.targets.items()])
    if (np.abs(reached - wanted) <= _REACHED * np.maximum(sizes, np.abs(reached))).all():
        return ""
    goals = choices(f"{name} = {value:g}" for name, value in data.targets.items())
    nearest = choices(f"{name} = {value:.6g}" for name, value in zip(data.targets, reached, strict=True))
    ranges = " and ".join(one.name + one.between for one in model.parameters)
    verb = "reaches" if len(model.parameters) == 1 else "reach"
    found = written(model.parameters, best.x)
    return f"the search found no {ranges} that {verb} {goals}; the nearest reached is {nearest}, at {found}"


def _told(way: dict[str, float]) -> str:
    """A direction in words."""
    if len(way) == 1:
        return f"the data do not depend on {next(iter(way))}"
    changes = choices(f"{name} by {_change(name, value)}" for name, value in way.items())
    return f"the data cannot tell {' and '.join(way)} apart: no datum changes when these change together, {changes}"


def _change(name: str, value: float) -> str:
    return f"{value:+.4g} %" if name in POSITIVE else f"{value / 100:+.4g}"


def rule(sigma: bool, known: Uncertainty) -> str:
    """How the intervals were found."""
    percent = f"{100 * LEVEL:g} % intervals"
    if sigma:
        return f"{percent} by the given sigma and the normal distribution"
    if known.freedom <= 0:
        return "no intervals: no sigma is given, and there are no more data than fitted values"
    return f"{percent} by the variance of the residuals and Student's t with {known.freedom} degrees of freedom"


def remarks(
    model: "Model",
    best: "Minimum",
    directions: Sequence[dict[str, float]],
    correlation: Array,
    probability: float,
    others: Sequence[OtherMinimum],
) -> Iterator[str]:
    """Sentences on what limits the result."""
    parameters = model.parameters
    if best.stop or missed(model, best):  # else the outcome says it
        yield from map(_told, directions)
    for one, x, free in zip(parameters, best.x, best.free, strict=True):
        if not free:
            yield (
                f"{one.name} ends at its bound, {one.value(float(x)):.6g}: it has no interval, and the intervals of "
                "other fields hold while it stays there"
            )
    if probability < UNLIKELY:
        yield (
            f"the residuals are larger than sigma allows (chance {probability:.1e}): sigma or the rod that is assumed "
            "is wrong, and the intervals are too narrow"
        )
    for i, j in np.argwhere(np.triu(np.abs(correlation) > _ALIKE, 1)):
        pair = f"{parameters[i].name} and {parameters[j].name}"
        yield f"the data hardly tell {pair} apart: correlation {correlation[i, j]:+.5f}"
    if good := sum(one.as_good for one in others):
        yield f"the data do not exclude {good} other minim{'um' if good == 1 else 'a'}: the values are not unique"
    if count := model.refused.total():
        reason, _ = model.refused.most_common(1)[0]
        yield f"at {count} of the values tried the data cannot be computed, most often: {reason}"
