"""The rod of a case: its section, its length, and its stiffness."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from .errors import no_such
from .field_values import check_numbers, refuse

STIFFNESS = {"solid": np.pi / 4, "paper": np.pi / 16}  # A / (E a^4)


@dataclass(frozen=True, eq=False)
class Rod:
    """A naturally straight, inextensible rod of circular section.

    Parameters
    ----------
    E : float or array
        Young's modulus [force/length^2].
    nu : float or array
        Poisson ratio.
    a : float or array
        Radius of the section [length].
    L : float or array
        Length [length].
    stiffness : {"solid", "paper"}
        Bending stiffness A: "solid" is pi/4 E a^4, the stiffness of a solid section; "paper" is pi/16 E a^4, eq. (20)
        as printed.

    Raises
    ------
    InputError
        If E, a or L is not positive, nu is outside (-1, 0.5], or the stiffness is unknown.

    Examples
    --------
    >>> from solver import Rod
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> print(f"A = {rod.bending_stiffness:.4f}, C = {rod.torsional_stiffness:.4f}")
    A = 32.8272, C = 26.2618
    """

    E: Any
    nu: Any
    a: Any
    L: Any
    stiffness: str = "solid"

    def __post_init__(self) -> None:
        check_numbers(self, skip=("stiffness",))
        for name in ("E", "a", "L"):
            value = getattr(self, name)
            refuse("Rod", name, value, np.less_equal(value, 0), "positive and finite")
        refuse("Rod", "nu", self.nu, np.less_equal(self.nu, -1) | np.greater(self.nu, 0.5), "in (-1, 0.5]")
        if self.stiffness not in STIFFNESS:
            raise no_such("stiffness", self.stiffness, STIFFNESS)

    @cached_property
    def bending_stiffness(self) -> Any:
        """A [force length^2], eq. (20) with the factor of `stiffness`; 0 or inf if it underflows or overflows."""
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            return STIFFNESS[self.stiffness] * self.E * np.power(self.a, 4.0)

    @property
    def torsional_stiffness(self) -> Any:
        """C = A / (1 + nu) [force length^2]; eq. (20)."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self.bending_stiffness / (1 + self.nu)
