"""What a method is: dimensionless problems and stations in, a trajectory out."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from ..numerics.arrays import Array
from ..problem.reduced import Reduced
from ..problem.trajectory import Trajectory


class Run(Protocol):
    """How a method is called; t: (B, n) stations in units of rho, rising from 0, the last at most the span."""

    def __call__(self, problem: Reduced, t: Array, tol: float, **knobs: Any) -> Trajectory: ...


@dataclass(frozen=True)
class Knob:
    """One setting of a method: a whole number of at least `least`, a positive number, or a flag (least None)."""

    kind: type
    least: int | None = None

    def accepts(self, value: Any) -> bool:
        if self.kind is bool:
            return isinstance(value, bool)
        if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
            return False
        if self.kind is int:
            return isinstance(value, (int, np.integer)) and bool(self.least is None or value >= self.least)
        return bool(0 < value < 1)

    @property
    def rule(self) -> str:
        if self.kind is bool:
            return "True or False"
        return f"a whole number of at least {self.least}" if self.kind is int else "a number between 0 and 1"


@dataclass(frozen=True)
class Method:
    """One method: the kinds of problem it solves ("start", "ends"), its order of convergence (inf: geometric), and
    its knobs."""

    name: str
    run: Run
    kinds: tuple[str, ...]
    order: float
    summary: str
    knobs: Mapping[str, Knob] = field(default_factory=dict)
