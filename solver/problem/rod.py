"""The rod of a case: its section, its length, and its stiffness."""

from collections.abc import Collection
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, Literal

import numpy as np

from .errors import InputError, choices, known_name, no_such
from .field_values import check_field_names, check_numbers, refuse, refuse_outside, write_fields

STIFFNESS = {"solid": np.pi / 4, "paper": np.pi / 16}  # A / (E (a^4 - inner_radius^4))
GIVEN = "given"  # in files, in place of a word of STIFFNESS: EI and GJ are given
MOST_RATIO = 1e12  # of EI to GJ, and of GJ to EI: beyond, squares and sums with other numbers overflow
ELASTIC = ("E", "nu")  # either pair determines both stiffnesses
DIRECT = ("EI", "GJ")
_PAIRS = "give E and nu (and inner_radius for a tube), or EI and GJ"


def lacking(given: Collection[str]) -> list[str]:
    """The fields that a rod with the given fields still needs, in order."""
    pair = DIRECT if set(DIRECT) & set(given) else ELASTIC
    return [name for name in (*pair, "a", "L") if name not in given]


def fourth_powers(a: Any, inner_radius: Any = None) -> Any:
    """a^4 - inner_radius^4; default: a^4. Of arrays, also those of xarray."""
    if inner_radius is None:
        return np.power(a, 4.0)
    # as a product, which keeps its digits where the wall is thin
    return (a - inner_radius) * (a + inner_radius) * (a * a + inner_radius * inner_radius)


@check_field_names
@dataclass(frozen=True, eq=False, repr=False)
class Rod:
    """A naturally straight, inextensible rod of circular section: solid, a tube, or of given stiffnesses.

    Give E and nu, with inner_radius for a tube; or EI and GJ, for a section that is not of one isotropic material.

    Parameters
    ----------
    E : float or array, optional
        Young's modulus [force/length^2].
    nu : float or array, optional
        Poisson ratio.
    a : float or array
        Outer radius of the section [length].
    L : float or array
        Length [length].
    stiffness : {"solid", "paper"}
        Factor of the bending stiffness A of a rod with E: "solid" is pi/4 E (a^4 - inner_radius^4), of elasticity;
        "paper" is pi/16 E a^4, eq. (20) as printed, for a solid section only.
    inner_radius : float or array, optional
        Inner radius of a tube, at least 0 and less than a [length]. Default: a solid section.
    EI : float or array, optional
        Bending stiffness A [force length^2].
    GJ : float or array, optional
        Torsional stiffness C [force length^2].
    weight : float or array, optional
        Weight per length in the fluid around the rod [force/length], at least 0; `weight_in_fluid` gives that of a
        section. Default: none.

    Raises
    ------
    InputError
        If E, EI, GJ, a or L is not positive, the weight is negative, nu is outside (-1, 0.5], inner_radius is outside
        [0, a), the stiffness is unknown, or the fields are not one of the two ways to give a section.

    Examples
    --------
    >>> from solver import Rod
    >>> rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0)
    >>> print(f"A = {rod.bending_stiffness:.4f}, C = {rod.torsional_stiffness:.4f}")
    A = 32.8272, C = 26.2618
    >>> pipe = Rod(E=2.06e8, nu=0.3, a=0.0635, inner_radius=0.0543, L=300.0)  # steel; m, kN
    >>> print(f"A = {pipe.bending_stiffness:.2f}")
    A = 1224.03
    >>> Rod(EI=205.7, GJ=411.4, a=1.0, L=43.5)  # DNA; nm, pN
    Rod(a=1.0, L=43.5, EI=205.7, GJ=411.4)
    """

    E: Any = None
    nu: Any = None
    a: Any = None
    L: Any = None
    stiffness: Literal["solid", "paper"] = "solid"
    inner_radius: Any = None
    EI: Any = None
    GJ: Any = None
    weight: Any = None

    def __post_init__(self) -> None:
        check_numbers(self, skip=("stiffness",))
        # before missing fields are named: a wrong value stays wrong
        refuse_outside(self, "E", "EI", "GJ", "a", "L", "nu")
        self._check_fields()
        if self.EI is not None:
            self._check_ratio()
        if self.inner_radius is not None:
            self._check_bore()
        refuse_outside(self, "weight")

    def _check_fields(self) -> None:
        """Raise `InputError` unless the fields say one section, in one way."""
        if not known_name(self.stiffness, STIFFNESS):
            raise no_such("stiffness", self.stiffness, STIFFNESS)
        given = [name for name, _ in self.given()]
        elastic, direct = ([name for name in names if name in given] for names in ((*ELASTIC, "inner_radius"), DIRECT))
        if elastic and direct:
            raise InputError(f"Rod has one section: {_PAIRS}; got {self._write(*elastic, *direct)}")
        if missing := lacking(given):
            other = "" if elastic or direct else f": {_PAIRS}"
            raise InputError(f"Rod needs {choices(missing)}{other}; got {choices(given) or 'nothing'}")
        solid = [name for name in ("inner_radius", "EI") if name in given]
        if solid and self.stiffness != "solid":
            why = "it is eq. (20) as printed, of a solid section with E"
            raise InputError(f"stiffness={self.stiffness!r} excludes {self._write(*solid)}: {why}; choose 'solid'")
        for pair in (("inner_radius", "a"), DIRECT):
            shapes = [np.shape(value) for name, value in self.given() if name in pair]
            try:
                np.broadcast_shapes(*shapes)
            except ValueError:
                raise InputError(f"{choices(pair)} of Rod must broadcast, got the shapes {choices(shapes)}") from None

    def _write(self, *names: str) -> str:
        return choices(f"{name}={getattr(self, name)}" for name in names)

    def _check_bore(self) -> None:
        """Raise `InputError` unless 0 <= inner_radius < a."""
        refuse_outside(self, "inner_radius")
        bore = self.inner_radius
        full = np.greater_equal(bore, self.a)
        rule = f"less than Rod.a = {self.a!s}"
        refuse("Rod", "inner_radius", np.broadcast_to(bore, np.shape(full)), full, rule)

    def _check_ratio(self) -> None:
        """Raise `InputError` unless EI/GJ is within `MOST_RATIO`."""
        off = np.abs(np.log(self.EI) - np.log(self.GJ)) > np.log(MOST_RATIO)
        rule = f"from {1 / MOST_RATIO:g} to {MOST_RATIO:g} times Rod.GJ = {self.GJ!s}"
        refuse("Rod", "EI", np.broadcast_to(self.EI, np.shape(off)), off, rule)

    def __repr__(self) -> str:
        return write_fields(self, skip=() if self.EI is None else ("stiffness",))

    def given(self) -> list[tuple[str, Any]]:
        """Name and value of each numeric field that is given, in order."""
        values = ((field.name, getattr(self, field.name)) for field in fields(self) if field.name != "stiffness")
        return [(name, value) for name, value in values if value is not None]

    @property
    def section(self) -> str:
        """The word by which files name the section's stiffness: that of `stiffness`, or "given" for EI and GJ."""
        return self.stiffness if self.EI is None else GIVEN

    @cached_property
    def bending_stiffness(self) -> Any:
        """A [force length^2]: EI, or eq. (20) with the factor of `stiffness`; 0 or inf where it is out of range."""
        if self.EI is not None:
            return self.EI
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            return STIFFNESS[self.stiffness] * self.E * fourth_powers(self.a, self.inner_radius)

    @property
    def torsional_stiffness(self) -> Any:
        """C [force length^2]: GJ, or A / (1 + nu), eq. (20)."""
        if self.GJ is not None:
            return self.GJ
        with np.errstate(over="ignore", invalid="ignore"):
            return self.bending_stiffness / (1 + self.nu)

    @cached_property
    def stiffness_ratio(self) -> Any:
        """A/C: EI/GJ, or 1 + nu."""
        with np.errstate(over="ignore", under="ignore"):
            return 1 + self.nu if self.EI is None else self.EI / self.GJ


def weight_in_fluid(
    a: Any, inner_radius: Any = 0.0, density: float = 7850.0, fluid: float = 0.0, gravity: float = 9.80665
) -> Any:
    """The weight per length of a tube whose inside and outside are full of the same fluid.

    By Archimedes it is that of the section of metal less that of the same volume of fluid.

    Parameters
    ----------
    a, inner_radius : float or array
        Outer and inner radius [length].
    density : float
        Of the material [mass/length^3]; default: steel in kg/m^3.
    fluid : float
        Of the fluid [mass/length^3]; default: none.
    gravity : float
        [force/mass]; default: N/kg.

    Returns
    -------
    float or array
        [force/length]; with metres and kg/m^3, N/m.

    Examples
    --------
    >>> from solver import weight_in_fluid
    >>> print(f"{weight_in_fluid(0.0635, 0.0543, fluid=1200.0):.1f} N/m")  # 5 inch pipe in mud
    222.0 N/m
    """
    return np.pi * (a - inner_radius) * (a + inner_radius) * (density - fluid) * gravity
