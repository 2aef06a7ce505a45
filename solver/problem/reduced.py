"""The dimensionless problem: all that a method ever sees.

In units of rho (t = s/rho, lam = l rho, mu = m rho, phi = p rho^2) three numbers and the ends are left of every case,
and E is in none of them: doubling E and every load leaves each bit.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .case import Case, Ends


@dataclass(frozen=True, eq=False)
class Reduced:
    """B problems, each field of shape (B,).

    lam, mu, phi: MZ rho/A, M3 rho/A, FZ rho^2/A. span: L/rho. beta0: angle at the start.
    dbeta0: d beta/dt at the start (start problems) or None; betaL: angle at the far end (ends problems) or None.
    """

    lam: Array
    mu: Array
    phi: Array
    span: Array
    beta0: Array
    dbeta0: Array | None = None
    betaL: Array | None = None

    @property
    def size(self) -> int:
        return self.beta0.size

    @property
    def kind(self) -> str:
        return "start" if self.betaL is None else "ends"

    def take(self, index: Any) -> "Reduced":
        """The problems that an index array or mask picks."""
        picked: dict[str, Any] = {name: None if v is None else v[index] for name, v in vars(self).items()}
        return Reduced(**picked)

    def started(self, dbeta0: Array) -> "Reduced":
        """The same problems with the start's slope given instead of the far angle."""
        return Reduced(self.lam, self.mu, self.phi, self.span, self.beta0, dbeta0=dbeta0)


def reduce(case: Case) -> Reduced:
    """The case without dimensions; section 2 of the physics notes (t = s/rho)."""
    FZ, MZ, M3 = case.loads
    rho, A, given = case.rho, case.rod.bending_stiffness, case.given
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        values = {
            "lam": MZ / A * rho,
            "mu": M3 / A * rho,
            "phi": FZ / A * rho * rho,
            "span": case.rod.L / rho,
            "beta0": given.beta0 if isinstance(given, Ends) else given.beta,
        }
        if isinstance(given, Ends):
            values["betaL"] = given.betaL
        else:
            values["dbeta0"] = given.dbeta * rho
    return Reduced(**{name: flat(value, case.shape) for name, value in values.items()})


def flat(value: Any, shape: tuple[int, ...]) -> Array:
    """A field of a case as one contiguous row, (B,)."""
    return np.ascontiguousarray(np.broadcast_to(np.asarray(value, dtype=float), shape)).reshape(-1)
