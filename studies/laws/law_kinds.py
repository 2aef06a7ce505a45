"""The kinds of laws: the keys of each, and the verdict on a line; the words for them are in `law_words`.

The verdict on one line of numbers against other numbers: a formula, bounds, an exponent, the place of a boundary.
*holds*: every case agrees. *not decided*: cases without a value, or too few or too wide steps, leave it open.
*fails*: a case disagrees, whatever the missing ones are.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import scipy  # its parts are imported when used
from numpy.typing import NDArray

from . import law_words
from .line_verdicts import FAILS, HOLDS, UNDECIDED, Verdict

Array = NDArray[np.float64]
CONFIDENCE = 0.95  # of the interval of an exponent
ROUNDING = 1e-13  # relative: a smaller excess over a tolerance is rounding


@dataclass(frozen=True, eq=False)
class NumberLine:
    """The values of an observable in the rising order of an axis, and the numbers that a law compares them with.

    axis: its name. along, values: (n,), NaN where there is no value. cut: (n - 1,), the steps that cross to another
    branch. targets: key of the law -> (n,). why: why a target has no value, or "".
    """

    axis: str
    along: Array
    values: Array
    cut: NDArray[np.bool_]
    targets: Mapping[str, Array]
    why: str = ""

    def missing(self) -> str:
        """How many cases have no value, in words; "" for none."""
        lost = ~np.isfinite(self.values)
        none = np.logical_or.reduce([~np.isfinite(target) for target in self.targets.values()], axis=0)
        sentences = [f"{int(lost.sum())} of {lost.size} cases have no value"] if lost.any() else []
        if np.any(none):
            sentences.append(f"the formula has no value in {int(np.sum(none))} of {lost.size} cases ({self.why})")
        return "; ".join(sentences)


def equals(line: NumberLine, rule: Mapping[str, Any]) -> Verdict:
    """Whether each value is that of the formula, within `relative` times the size of the formula or `absolute`."""
    formula = line.targets["formula"]
    off = np.abs(line.values - formula)
    relative = rule.get("relative")
    if relative is not None:
        off = np.divide(off, np.abs(formula), out=np.where(off > 0, np.inf, off), where=formula != 0)
    allowed = rule["absolute"] if relative is None else relative
    numbers = {}
    if np.isfinite(off).any() or (off > 0).any():
        worst = int(np.nanargmax(off))
        numbers = {"off": float(off[worst]), "at": float(line.along[worst])}
    return _of_cases(line, off > allowed * (1 + ROUNDING), "equals", rule, numbers)


def bound(line: NumberLine, rule: Mapping[str, Any]) -> Verdict:
    """Whether each value is at least `least` and at most `most`."""
    beyond = np.full(line.values.shape, -np.inf)
    for key, sign in (("least", 1), ("most", -1)):
        if key in line.targets:
            beyond = np.fmax(beyond, sign * (line.targets[key] - line.values))
    known = line.values[np.isfinite(line.values)]
    numbers = {"smallest": float(known.min()), "largest": float(known.max())} if known.size else {}
    return _of_cases(line, beyond > ROUNDING * np.abs(line.values), "bounded", rule, numbers)


def scales(line: NumberLine, rule: Mapping[str, Any]) -> Verdict:
    """Whether the values are a power of the axis, with `exponent` within `within`.

    The exponent is the slope of a straight line through the logarithms of the sizes, by least squares; its interval of
    95 % follows from their distances to that line.
    """
    known = np.isfinite(line.values)
    x, y = line.along[known], line.values[known]
    if np.unique(x).size < 3:
        return Verdict(UNDECIDED, reason=line.missing() or "an exponent needs three cases", found="no exponent")
    if not (_one_sign(x) and _one_sign(y)):
        which = "axis" if not _one_sign(x) else "observable"
        return Verdict(FAILS, reason=f"the {which} is 0 or changes its sign, so it is no power", found="no exponent")
    exponent, half, factor = fit_power(np.abs(x), np.abs(y))
    off, within = abs(exponent - rule["exponent"]), rule["within"]
    numbers = {"exponent": exponent, "interval": half, "factor": factor * float(np.sign(y[0]))}
    words = law_words.finding("scales", numbers, rule, line.axis)
    if off - half > within:
        return Verdict(FAILS, found=words, numbers=numbers, far=off)
    reason = line.missing() or _branch_changes(line)
    if off + half > within:
        reason = "; ".join(filter(None, [reason, f"the interval of the exponent reaches beyond ± {within:g}"]))
    return Verdict(UNDECIDED if reason else HOLDS, reason=reason, found=words, numbers=numbers, far=off)


def fit_power(x: Array, y: Array) -> tuple[float, float, float]:
    """Exponent, half of its 95 % interval, and factor of the power law through positive values, (n,) with n >= 3."""
    u, v = np.log(x), np.log(y)
    mean, spread = u.mean(), float(((u - u.mean()) ** 2).sum())
    exponent = float(((u - mean) * v).sum()) / spread
    left = v - v.mean() - exponent * (u - mean)
    free = x.size - 2
    half = float(scipy.special.stdtrit(free, (1 + CONFIDENCE) / 2)) * np.sqrt(float((left**2).sum()) / free / spread)
    return exponent, float(half), float(np.exp(v.mean() - exponent * mean))


def boundary(line: NumberLine, rule: Mapping[str, Any]) -> Verdict:
    """Whether the observable passes a value between two neighbours of the axis that both are within `within` of `x`,
    and nowhere else."""
    level = line.values - line.targets["passes"]
    place = line.along - line.targets["x"]
    steps = passes(level, line.cut)
    if not steps:
        reason = line.missing() or _branch_changes(line)
        return Verdict(UNDECIDED if reason else FAILS, reason=reason, found="it does not pass", far=np.inf)
    gaps = [f"between {line.along[i]:.4g} and {line.along[j]:.4g}" for i, j in steps]
    words = f"passes {' and '.join(gaps[:3])}{' and elsewhere' if len(gaps) > 3 else ''}"
    i, j = max(steps, key=lambda step: float(np.max(np.abs(place[list(step)]))))
    share = level[i] / (level[i] - level[j])
    numbers = {
        "from": float(line.along[i]),
        "to": float(line.along[j]),
        "at": float(line.along[i] + share * (line.along[j] - line.along[i])),
    }
    low, high = sorted((float(place[i]), float(place[j])))
    within, far = rule["within"] * (1 + ROUNDING), max(abs(low), abs(high))
    told_of: dict[str, Any] = {"found": words, "numbers": numbers, "far": far}
    if len(steps) > 1:
        return Verdict(FAILS, reason=f"it passes {len(steps)} times", **told_of)
    if low > within or high < -within:
        return Verdict(FAILS, **told_of)
    reason = line.missing() or _branch_changes(line)
    if far > within:
        reason = "; ".join(filter(None, [reason, f"the step is wider than ± {rule['within']:g} about the value of x"]))
    return Verdict(UNDECIDED if reason else HOLDS, reason=reason, **told_of)


def passes(level: Array, cut: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """The pairs of neighbouring known values between which a level changes its sign, without those across a cut."""
    known = np.flatnonzero(np.isfinite(level))
    crossed = np.concatenate([[0], np.cumsum(cut)])
    return [
        (i, j) for i, j in pairwise(known.tolist()) if (level[i] < 0) != (level[j] < 0) and crossed[i] == crossed[j]
    ]


def _of_cases(
    line: NumberLine, wrong: NDArray[np.bool_], kind: str, rule: Mapping[str, Any], numbers: dict[str, float]
) -> Verdict:
    """The verdict on cases that each agree or not. numbers: that were measured; empty where no case has a value."""
    words = law_words.finding(kind, numbers, rule, line.axis) if numbers else "no case has a value"
    exceptions = [(int(i), int(i)) for i in np.flatnonzero(wrong)]
    reason, far = line.missing(), numbers.get("off", float(len(exceptions)))
    verdict = FAILS if exceptions else UNDECIDED if reason else HOLDS
    return Verdict(verdict, None, exceptions, reason, words, numbers, far)


def _one_sign(values: Array) -> bool:
    return bool((values > 0).all() or (values < 0).all())


def _branch_changes(line: NumberLine) -> str:
    count = int(line.cut.sum())
    return f"{count} of {line.cut.size} steps lead to another branch of equilibria" if count else ""


MONOTONE = "monotone"
STEPS, CASES = "steps the wrong way", "cases outside"  # what the exceptions of a verdict are


@dataclass(frozen=True)
class Kind:
    """A kind of law.

    needs: the keys that a law must have. one_of: keys of which it must have
    one; exclusive: and no more. keys: further keys. judge: the verdict on a line; None for a direction, which
    `line_verdicts.judge` judges. exceptions: what its exceptions are.
    """

    needs: tuple[str, ...] = ()
    one_of: tuple[str, ...] = ()
    exclusive: bool = False
    keys: tuple[str, ...] = ()
    judge: Callable[[NumberLine, Mapping[str, Any]], Verdict] | None = None
    exceptions: str = CASES

    @property
    def all_keys(self) -> tuple[str, ...]:
        """Every key that a law of this kind may have."""
        return (*self.needs, *self.one_of, *self.keys)


KINDS: dict[str, Kind] = {
    MONOTONE: Kind(needs=("direction",), keys=("says", "alternatives", "also"), exceptions=STEPS),
    "equals": Kind(("formula",), ("relative", "absolute"), exclusive=True, judge=equals),
    "bounded": Kind(one_of=("least", "most"), judge=bound),
    "scales": Kind(("exponent", "within"), judge=scales),
    "boundary": Kind(("passes", "x", "within"), judge=boundary),
}
FORMULAS = ("formula", "least", "most", "passes", "x")  # keys whose value may be a formula
