"""The kinds of laws: the keys of each, the verdict on a line, and the words for it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from . import number_verdicts
from .line_verdicts import DIRECTIONS, Verdict
from .number_verdicts import NumberLine

MONOTONE = "monotone"
STEPS, CASES = "steps the wrong way", "cases outside"  # what the exceptions of a verdict are


@dataclass(frozen=True)
class Kind:
    """A kind of law.

    does: the words for a law of given keys. needs: the keys that a law must have. one_of: keys of which it must have
    one; exclusive: and no more. keys: further keys. judge: the verdict on a line; None for a direction, which
    `line_verdicts.judge` judges. exceptions: what its exceptions are.
    """

    does: Callable[[Mapping[str, Any]], str]
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


def _equals(rule: Mapping[str, Any]) -> str:
    relative = rule.get("relative")
    near = f"{rule['absolute']:.4g}" if relative is None else f"{100 * relative:.4g} %"
    return f"equals {rule['formula']} within {near}"


def _bound(rule: Mapping[str, Any]) -> str:
    ends = [f"{word} {_show(rule[key])}" for key, word in (("least", "at least"), ("most", "at most")) if key in rule]
    return f"is {' and '.join(ends)}"


def _scales(rule: Mapping[str, Any]) -> str:
    return f"scales with the exponent {rule['exponent']:.4g} within {rule['within']:.4g}"


def _boundary(rule: Mapping[str, Any]) -> str:
    return f"passes {_show(rule['passes'])} at {_show(rule['x'])} within {rule['within']:.4g}"


def _show(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.4g}"


KINDS: dict[str, Kind] = {
    MONOTONE: Kind(
        lambda rule: DIRECTIONS[rule["direction"]].does,
        needs=("direction",),
        keys=("says", "alternatives", "also"),
        exceptions=STEPS,
    ),
    "equals": Kind(_equals, ("formula",), ("relative", "absolute"), exclusive=True, judge=number_verdicts.equals),
    "bounded": Kind(_bound, one_of=("least", "most"), judge=number_verdicts.bound),
    "scales": Kind(_scales, ("exponent", "within"), judge=number_verdicts.scales),
    "boundary": Kind(_boundary, ("passes", "x", "within"), judge=number_verdicts.boundary),
}
FORMULAS = ("formula", "least", "most", "passes", "x")  # keys whose value may be a formula
