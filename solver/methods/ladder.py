"""The ladder of a method: the values of one knob, from cheap to dear, for the comparison of accuracy against cost."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

# Evaluations after which a ladder ends: about 0.4 s on the machine of docs/reference/methods.md. Evaluations, not
# seconds, so that a busy machine runs the same rungs. The first limit is for methods that call Python at each one.
MOST_CALLED, MOST_COMPILED = 20_000, 1_000_000
_LOOSE = 0.9  # the tolerance of a rung whose knob is another one: only a rung without a digit fails


@dataclass(frozen=True)
class Ladder:
    """A method, the knob that is varied, its values from cheap to dear, and its look in diagrams.

    colour, marker, line: as Matplotlib reads them; bold: whether the line is drawn thicker. label: default: the name of
    the method. fixed: the other knobs. cold: whether the first call at a value is slow (it compiles) and is not timed.
    most: a rung that would take more evaluations is not run.
    """

    method: str
    knob: str
    values: tuple[float, ...]
    colour: str = "black"
    marker: str = "o"
    line: str = "-"
    bold: bool = False
    label: str = ""
    fixed: Mapping[str, Any] = field(default_factory=dict)
    cold: bool = False
    most: float = MOST_CALLED

    @property
    def name(self) -> str:
        """The label, or else the name of the method."""
        return self.label or self.method

    def options(self, value: float) -> dict[str, Any]:
        """The arguments of `solve` on the rung of that value."""
        tol = {} if self.knob == "tol" else {"tol": _LOOSE}
        return {"method": self.method, **tol, **self.fixed, self.knob: value}


def tens(first: int, last: int, step: int = 1) -> tuple[float, ...]:
    """10^-first, ..., 10^-last."""
    return tuple(10.0**-k for k in range(first, last + 1, step))


def twos(last: int, times: int = 1) -> tuple[int, ...]:
    """times 1, 2, 4, ..., 2^last."""
    return tuple(times * 2**k for k in range(last + 1))


TOLERANCES = (*tens(1, 11, 2), 1e-12, 1e-13)
