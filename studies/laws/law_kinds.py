"""The kinds of laws: the keys of each, what it claims of a line of numbers in words, and its verdict.

The verdict on a direction is that of `line_verdicts`. The other `KINDS` compare the line with numbers: a formula,
bounds, an exponent, the place of a boundary. *true*: every case agrees. *not decided*: cases without a value, or too
few or too wide steps, leave it open. *false*: a case disagrees, whatever the missing ones are. A formula and bounds do
not count the solved cases in which the observable is not defined.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from decimal import ROUND_UP, Context, Decimal
from itertools import pairwise
from typing import Any

import numpy as np
import scipy  # its parts are imported when used
from numpy.typing import NDArray

from .line_verdicts import DIRECTIONS, FAILS, HOLDS, UNDECIDED, Array, Line, Verdict, keeps_direction

CONFIDENCE = 0.95  # of the interval of an exponent
ROUNDING = 1e-13  # relative: a smaller excess over a tolerance is rounding
FINEST = 6  # digits of a number whose error is smaller


# Writes a number or a formula; of what: the "observable", the "axis", or a "place" on the axis.
Show = Callable[[Any, str], str]
# What was measured, in words, of the numbers of the verdict, the law's keys, and the axis.
Finding = Callable[[Mapping[str, float], Mapping[str, Any], str, Show], str]


def as_given(value: Any, of: str) -> str:
    """A number with four digits, a formula as the study has it."""
    return value if isinstance(value, str) else f"{value:.4g}"


def with_error(value: float, error: float) -> str:
    """A number and its error with the same decimals; the error has two digits at most and is rounded up.

    It is left out where it is 0 or unknown, and where the first `FINEST` digits of the number do not show it.

    >>> with_error(3.7284, 0.4212), with_error(-0.004, 97.0), with_error(2.0, 3e-15)
    ('3.73 ± 0.43', '0 ± 97', '2')
    >>> with_error(123456.0, 4310.0), with_error(-1.23e-7, 4e-9)
    ('123500 ± 4400', '(-1.23 ± 0.04)e-07')
    """
    if not (math.isfinite(value) and abs(value) < error * 10**FINEST < math.inf):
        return f"{value:.{FINEST}g}"
    bound = Context(prec=2, rounding=ROUND_UP).create_decimal(repr(float(error)))
    number = Decimal(repr(float(value))).quantize(bound)
    number = number or abs(number)  # not "-0"
    power = max(number.adjusted(), bound.adjusted())
    if -5 < power < 10:
        return f"{number:f} ± {bound:f}"
    return f"({number.scaleb(-power):f} ± {bound.scaleb(-power):f})e{power:+03d}"


def _equals(rule: Mapping[str, Any], show: Show) -> str:
    relative = rule.get("relative")
    near = show(rule["absolute"], "observable") if relative is None else f"{100 * relative:.4g} %"
    return f"equals {show(rule['formula'], 'observable')} within {near}"


def _off(numbers: Mapping[str, float], rule: Mapping[str, Any], axis: str, show: Show) -> str:
    off = f"{100 * numbers['off']:.3g} %" if "relative" in rule else show(numbers["off"], "observable")
    return f"at most {off} off, at {axis} = {show(numbers['at'], 'axis')}"


def _bounds(rule: Mapping[str, Any], show: Show) -> str:
    of = "observable"
    ends = (("least", "at least"), ("most", "at most"))
    return f"is {' and '.join(f'{words} {show(rule[key], of)}' for key, words in ends if key in rule)}"


def _range(numbers: Mapping[str, float], rule: Mapping[str, Any], axis: str, show: Show) -> str:
    return f"{show(numbers['smallest'], 'observable')} to {show(numbers['largest'], 'observable')}"


def _scales(rule: Mapping[str, Any], show: Show) -> str:
    return f"scales with the exponent {rule['exponent']:.4g} within {rule['within']:.4g}"


def _exponent(numbers: Mapping[str, float], rule: Mapping[str, Any], axis: str, show: Show) -> str:
    return f"exponent {with_error(numbers['exponent'], numbers['interval'])}"


def _passes(rule: Mapping[str, Any], show: Show) -> str:
    place = f"{show(rule['x'], 'place')} within {show(rule['within'], 'axis')}"
    return f"passes {show(rule['passes'], 'observable')} at {place}"


def _gap(numbers: Mapping[str, float], rule: Mapping[str, Any], axis: str, show: Show) -> str:
    return f"passes between {show(numbers['from'], 'axis')} and {show(numbers['to'], 'axis')}"


def equals(line: Line, rule: Mapping[str, Any]) -> Verdict:
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
    return _of_cases(line, off > allowed * (1 + ROUNDING), _off, rule, numbers)


def bound(line: Line, rule: Mapping[str, Any]) -> Verdict:
    """Whether each value is at least `least` and at most `most`."""
    beyond = np.full(line.values.shape, -np.inf)
    for key, sign in (("least", 1), ("most", -1)):
        if key in line.targets:
            beyond = np.fmax(beyond, sign * (line.targets[key] - line.values))
    known = line.values[np.isfinite(line.values)]
    numbers = {"smallest": float(known.min()), "largest": float(known.max())} if known.size else {}
    return _of_cases(line, beyond > ROUNDING * np.abs(line.values), _range, rule, numbers)


def scales(line: Line, rule: Mapping[str, Any]) -> Verdict:
    """Whether the values are a power of the axis, with `exponent` within `within`.

    The exponent is the slope of a straight line through the logarithms of the sizes, by least squares; its interval of
    95 % follows from their distances to that line.
    """
    known = np.isfinite(line.values)
    x, y = line.along[known], line.values[known]
    if np.unique(x).size < 3:
        return Verdict(UNDECIDED, reason=line.gap_words() or "an exponent needs three cases", found="no exponent")
    if not (_one_sign(x) and _one_sign(y)):
        which = "axis" if not _one_sign(x) else "observable"
        return Verdict(FAILS, reason=f"the {which} is 0 or changes its sign, so it is no power", found="no exponent")
    exponent, half, factor = fit_power(np.abs(x), np.abs(y))
    off, within = abs(exponent - rule["exponent"]), rule["within"]
    numbers = {"exponent": exponent, "interval": half, "factor": factor * float(np.sign(y[0]))}
    words = _exponent(numbers, rule, line.axis, as_given)
    if off - half > within:
        return Verdict(FAILS, found=words, numbers=numbers, far=off)
    reason = line.gap_words() or _branch_changes(line)
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


def boundary(line: Line, rule: Mapping[str, Any]) -> Verdict:
    """Whether the observable passes a value between two neighbours of the axis that both are within `within` of `x`,
    and nowhere else."""
    level = line.values - line.targets["passes"]
    place = line.along - line.targets["x"]
    steps = passes(level, line.cut)
    if not steps:
        reason = line.gap_words() or _branch_changes(line)
        return Verdict(UNDECIDED if reason else FAILS, reason=reason, found="it does not pass", far=np.inf)
    gaps = [f"between {line.along[i]:.4g} and {line.along[j]:.4g}" for i, j in steps]
    words = f"passes {' and '.join(gaps[:3])}{' and elsewhere' if len(gaps) > 3 else ''}"
    i, j = max(steps, key=lambda step: float(np.max(np.abs(place[list(step)]))))
    numbers = {"from": float(line.along[i]), "to": float(line.along[j])}
    low, high = sorted((float(place[i]), float(place[j])))
    within, far = rule["within"] * (1 + ROUNDING), max(abs(low), abs(high))
    told_of: dict[str, Any] = {"found": words, "numbers": numbers, "far": far}
    if len(steps) > 1:
        return Verdict(FAILS, reason=f"it passes {len(steps)} times", **told_of)
    if low > within or high < -within:
        return Verdict(FAILS, **told_of)
    reason = line.gap_words() or _branch_changes(line)
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
    line: Line, wrong: NDArray[np.bool_], finding: Finding, rule: Mapping[str, Any], numbers: dict[str, float]
) -> Verdict:
    """The verdict on cases that each agree or not. numbers: that were measured; empty where no case has a value."""
    words = finding(numbers, rule, line.axis, as_given) if numbers else "no case has a value"
    exceptions = [(int(i), int(i)) for i in np.flatnonzero(wrong)]
    counted = np.ones(wrong.shape, dtype=bool) if line.undefined is None else ~line.undefined
    left, targets = line.values[counted], {key: target[counted] for key, target in line.targets.items()}
    reason, far = replace(line, values=left, targets=targets).gap_words(), numbers.get("off", float(len(exceptions)))
    verdict = FAILS if exceptions else UNDECIDED if reason or not left.size else HOLDS
    beside = f"not defined in {int((~counted).sum())} of {counted.size} cases" if not counted.all() else ""
    return Verdict(verdict, None, exceptions, "; ".join(filter(None, [reason, beside])), words, numbers, far)


def _one_sign(values: Array) -> bool:
    return bool((values > 0).all() or (values < 0).all())


def _branch_changes(line: Line) -> str:
    count = int(line.cut.sum())
    return f"{count} of {line.cut.size} steps lead to another branch of equilibria" if count else ""


MONOTONE = "monotone"
STEPS, CASES = "steps the wrong way", "cases outside"  # what the exceptions of a verdict are


@dataclass(frozen=True)
class LawKind:
    """A kind of law.

    does: what the observable does, in words, of the law's keys. judge: the verdict on a line. finding: what was
    measured, in words; None for a direction. needs: the keys that a law must have. one_of: keys of which it must have
    one; exclusive: and no more. keys: further keys. exceptions: what its exceptions are.
    """

    does: Callable[[Mapping[str, Any], Show], str]
    judge: Callable[[Line, Mapping[str, Any]], Verdict]
    finding: Finding | None = None
    needs: tuple[str, ...] = ()
    one_of: tuple[str, ...] = ()
    exclusive: bool = False
    keys: tuple[str, ...] = ()
    exceptions: str = CASES

    @property
    def all_keys(self) -> tuple[str, ...]:
        """Every key that a law of this kind may have."""
        return (*self.needs, *self.one_of, *self.keys)


KINDS: dict[str, LawKind] = {
    MONOTONE: LawKind(
        lambda rule, show: DIRECTIONS[rule["direction"]].does,
        keeps_direction,
        needs=("direction",),
        keys=("says", "alternatives", "also"),
        exceptions=STEPS,
    ),
    "equals": LawKind(_equals, equals, _off, ("formula",), ("relative", "absolute"), exclusive=True),
    "bounded": LawKind(_bounds, bound, _range, one_of=("least", "most")),
    "scales": LawKind(_scales, scales, _exponent, ("exponent", "within")),
    "boundary": LawKind(_passes, boundary, _gap, ("passes", "x", "within")),
}
