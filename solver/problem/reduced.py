"""The dimensionless problems: all that a method sees.

In units of rho (t = s/rho, lam = l rho, mu = m rho, phi = p rho^2) every case leaves three numbers and its ends. E is
in none of them: doubling E and every load changes no bit.
"""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from ..numerics.arrays import Array
from .case import Case, Ends
from .errors import InputError


@dataclass(frozen=True, eq=False)
class Reduced:
    """The fields that both kinds of problem share, for B problems, (B,) each.

    lam, mu, phi: MZ rho/A, M3 rho/A, FZ rho^2/A. span: L/rho. beta0: angle at the start.
    """

    lam: Array
    mu: Array
    phi: Array
    span: Array
    beta0: Array

    @property
    def size(self) -> int:
        """The number of problems."""
        return self.beta0.size

    def take(self, index: Any) -> Self:
        """The problems that an index array, a mask or a slice selects."""
        return type(self)(**{name: value[index] for name, value in vars(self).items()})

    def with_start(self, dbeta0: Array) -> "StartProblem":
        """The start problems with the same loads, length and beta0, and the given slopes."""
        return StartProblem(self.lam, self.mu, self.phi, self.span, self.beta0, dbeta0)

    def with_end(self, betaL: Array) -> "EndsProblem":
        """The ends problems with the same loads, length and beta0, and the given far angles."""
        return EndsProblem(self.lam, self.mu, self.phi, self.span, self.beta0, betaL)


@dataclass(frozen=True, eq=False)
class StartProblem(Reduced):
    """B start problems. dbeta0: d beta/dt at the start, (B,)."""

    dbeta0: Array
    kind: ClassVar[str] = "start"


@dataclass(frozen=True, eq=False)
class EndsProblem(Reduced):
    """B ends problems. betaL: angle at the far end, (B,)."""

    betaL: Array
    kind: ClassVar[str] = "ends"


def reduce(case: Case) -> StartProblem | EndsProblem:
    """The dimensionless problems of a case; section 2 of the physics notes.

    Raises `InputError` for a case whose loads vary along the rod.
    """
    refuse_varying(case)
    return dimensionless_problem(case)


def dimensionless_problem(case: Case, kind: type = float) -> StartProblem | EndsProblem:
    """The same of any case; where loads vary along the rod, with those that the case gives. kind: of the numbers."""
    FZ, MZ, M3 = case.loads
    rho, A, given = case.rho, case.rod.bending_stiffness, case.given
    numbers: Array = np.empty((6, *case.shape), kind)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        numbers[0], numbers[1], numbers[2] = MZ / A * rho, M3 / A * rho, FZ / A * rho * rho
        numbers[3] = case.rod.L / rho
        if isinstance(given, Ends):
            numbers[4], numbers[5] = given.beta0, given.betaL
            return EndsProblem(*numbers.reshape(6, -1))
        numbers[4], numbers[5] = given.beta, given.dbeta * rho
        return StartProblem(*numbers.reshape(6, -1))


def refuse_varying(case: Case) -> None:
    """Raise `InputError` for a case whose loads vary along the rod."""
    if case.varies:
        given = (("weight", case.rod.weight), ("friction", case.cylinder.friction))
        got = " and ".join(f"{name}={value}" for name, value in given if value is not None and np.any(value))
        raise InputError(
            f"this task needs loads that are constant along the rod, got {got}; of a rod with weight or friction "
            "solve, observe, follow, equilibria, sensitivity and fit are known"
        )


def flat(value: Any, shape: tuple[int, ...]) -> Array:
    """A field of a case as a contiguous array, (B,)."""
    value = np.asarray(value)
    value = np.asarray(value, dtype=complex if value.dtype.kind == "c" else float)
    if value.ndim == 0:
        return np.full(math.prod(shape), value)
    return np.ascontiguousarray(np.broadcast_to(value, shape)).reshape(-1)
