"""A case: a rod, a cylinder, and the values given at the start or at both ends. Frozen values, validated when made.

Every numeric field may be a number or an array; the fields of a case broadcast against each other. An angle may
also be text: `Start(beta="30deg", ...)`, `Ends("pi/6", ["10deg", "20deg"])`.
"""

import math
from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..numerics.arrays import NEGLIGIBLE
from .declared_fields import (
    ANGLES,
    CHOICES,
    FIELDS,
    OFF_WALL,
    PAIRS,
    PARTS,
    TILTS,
    VARY_LOADS,
    CylinderFields,
    EndsFields,
    RodFields,
    StartFields,
)
from .errors import InputError, choices, show
from .field_values import (
    check_field_names,
    check_values,
    numbers_in_place,
    numbers_of,
    refuse,
    refuse_unmet,
    write_fields,
)
from .shown import table_of

STIFFNESS = {"solid": np.pi / 4, "paper": np.pi / 16}  # A / (E (a^4 - inner_radius^4))
GIVEN = "given"  # in files, in place of a word of STIFFNESS: EI and GJ are given
# of EI to GJ, and of GJ to EI: beyond, squares and sums with other numbers overflow or lose all digits. x10: as good
MOST_RATIO = 1e12
ELASTIC = ("E", "nu")  # either pair determines both stiffnesses
DIRECT = ("EI", "GJ")
_WAYS = "give E and nu (and inner_radius for a tube), or EI and GJ"
SIDES = {"outside": 1.0, "inside": -1.0}  # the sign of rho - R, and of the contact force where the cylinder pushes
TWISTS = ("F1", "dgamma", "M3")  # fields of Start: each alone determines the twisting moment
ALONG_ITSELF, IN_PLACE, ALONG_AXIS = 0, 1, -1  # ways to move against the wall
# the sign of sliding towards larger s, and the way
SLIDING = {
    "forward": (1.0, ALONG_ITSELF),
    "backward": (-1.0, ALONG_ITSELF),
    "rotating": (1.0, IN_PLACE),
    "axial-forward": (1.0, ALONG_AXIS),
    "axial-backward": (-1.0, ALONG_AXIS),
}


def fields_to_add(given: Collection[str]) -> list[str]:
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
class Rod(RodFields):
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

    def __post_init__(self) -> None:
        check_values(self)  # before missing fields are named: a wrong value stays wrong
        self._check_fields()
        if self.EI is not None:
            self._check_ratio()
        if self.inner_radius is not None:
            self._check_bore()

    def _check_fields(self) -> None:
        """Raise `InputError` unless the fields say one section, in one way."""
        given = [name for name, _ in self.given()]
        elastic, direct = ([name for name in names if name in given] for names in ((*ELASTIC, "inner_radius"), DIRECT))
        if elastic and direct:
            raise InputError(f"Rod has one section: {_WAYS}; got {self._write(*elastic, *direct)}")
        if missing := fields_to_add(given):
            other = "" if elastic or direct else f": {_WAYS}"
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
        """Raise `InputError` unless inner_radius < a."""
        full = np.greater_equal(self.inner_radius, self.a)
        refuse("Rod", "inner_radius", self.inner_radius, full, f"less than Rod.a = {self.a!s}")

    def _check_ratio(self) -> None:
        """Raise `InputError` unless EI/GJ is within `MOST_RATIO`."""
        off = np.abs(np.log(self.EI) - np.log(self.GJ)) > np.log(MOST_RATIO)
        rule = f"from {1 / MOST_RATIO:g} to {MOST_RATIO:g} times Rod.GJ = {self.GJ!s}"
        refuse("Rod", "EI", self.EI, off, rule)

    def __repr__(self) -> str:
        return write_fields(self, skip=() if self.EI is None else ("stiffness",))

    def given(self) -> list[tuple[str, Any]]:
        """Name and value of each numeric field that is given, in order."""
        values = ((name, getattr(self, name)) for name in PARTS["rod"] if name not in CHOICES)
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


@check_field_names
@dataclass(frozen=True, eq=False)
class Cylinder(CylinderFields):
    """The cylinder on which the rod lies, without friction unless a coefficient is given.

    Parameters
    ----------
    R : float or array
        Radius of the cylinder [length].
    side : {"outside", "inside"}
        The side of the wall on which the rod lies.
    inclination : float, str or array, optional
        Angle of the axis, in the direction of s, to the upward vertical [rad], 0 to pi: "90deg" lies, "180deg"
        descends. Only for a rod with weight. Default: 0.
    friction : float or array, optional
        Coefficient of the friction of a rod that slides everywhere, at least 0. Default: no friction.
    sliding : {"forward", "backward", "rotating", "axial-forward", "axial-backward"}, optional
        How a rod with friction moves: along itself towards larger s or smaller s, turning in place, counterclockwise
        seen against s, or as a whole along the axis of the cylinder. Default: forward.
    contact : {"bilateral", "unilateral"}
        "bilateral": the cylinder holds the rod on, so that it lies on the wall all along. "unilateral": the cylinder
        only pushes, and the rod may leave it. Only between `Ends`, and without friction.

    Raises
    ------
    InputError
        If R is not positive, the inclination is outside [0, pi], the friction is negative, a word is unknown, sliding
        is given without friction, or friction with unilateral contact.

    Examples
    --------
    >>> from solver import Cylinder
    >>> Cylinder(R=0.75, side="inside")
    Cylinder(R=0.75, side='inside')
    """

    def __post_init__(self) -> None:
        check_values(self)
        refuse_unmet(vars(self))
        if self.contact == "unilateral" and self.friction is not None and np.any(self.friction):
            why = "with friction a rod has no energy, whose minimum the shape beside a cylinder that only pushes is"
            raise InputError(f"contact='unilateral' excludes friction, got friction={show(self.friction)}: {why}")
        if self.friction is not None:
            object.__setattr__(self, "sliding", self.sliding or next(iter(SLIDING)))

    @property
    def sense(self) -> tuple[float, int]:
        """The sign of sliding towards larger s, and the way: ALONG_ITSELF, IN_PLACE or ALONG_AXIS."""
        return SLIDING[self.sliding or "forward"]

    @property
    def turns_in_place(self) -> bool:
        """Whether a rod turns in place against friction: then its twisting moment varies along it."""
        return self.friction is not None and self.sense[1] == IN_PLACE

    def __repr__(self) -> str:
        return write_fields(self)


@check_field_names
@dataclass(frozen=True, eq=False)
class Start(StartFields):
    """A start problem: every value is given at s = 0. An initial value problem with one solution.

    Exactly one of F1, dgamma and M3 is given; each determines the twisting moment. An angle may also be text: "30deg",
    "pi/6".

    Parameters
    ----------
    beta : float, str or array
        Angle from the axis of the cylinder to the tangent [rad].
    dbeta : float or array
        Rate of that angle [rad/length].
    F1 : float or array, optional
        Internal force along the inward normal [force].
    F2 : float or array
        Internal force in the surface, across the rod [force].
    F3 : float or array
        Internal force along the tangent, tension positive [force].
    dgamma : float or array, optional
        Rate of the rotation of the section against the normal [rad/length].
    alpha, gamma : float, str or array
        Azimuth, and rotation of the section [rad]. With weight, alpha = 0 is the low side of the cylinder.
    M3 : float or array, optional
        Twisting moment [force length].

    Raises
    ------
    InputError
        If none or several of F1, dgamma and M3 are given, or F1 is given with dbeta = 0.

    Examples
    --------
    >>> from solver import Start
    >>> start = Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)
    >>> round(start.beta, 4)
    0.5236
    """

    def __post_init__(self) -> None:
        check_values(self)
        if sum(getattr(self, name) is not None for name in TWISTS) != 1:
            got = ", ".join(f"{name}={getattr(self, name)}" for name in TWISTS)
            raise InputError(f"Start needs exactly one of F1, dgamma and M3, got {got}")
        if self.F1 is not None and np.any(np.equal(self.dbeta, 0)):
            raise InputError(
                "Start.F1 cannot determine the twist at dbeta = 0 (F1 is proportional to dbeta), "
                f"got F1={self.F1} and dbeta=0; give dgamma or M3 instead"
            )


@check_field_names
@dataclass(frozen=True, eq=False)
class Ends(EndsFields):
    """An ends problem: how both ends are held. A boundary value problem with many solutions.

    One of each pair is given, and the other one is found: beta0 or M10, betaL or M1L, FZ or height, MZ or azimuth, M3
    or rotation. A load that is neither given nor replaced is 0. An angle may also be text: "30deg", "pi/6".

    Parameters
    ----------
    beta0, betaL : float, str or array
        Angle from the axis of the cylinder to the tangent at s = 0 and at s = L [rad].
    FZ : float or array
        Axial force at s = L, a dead load, tension positive [force]. Default: 0.
    MZ, M3 : float or array
        Axial moment and twisting moment at s = L, dead loads [force length]. Default: 0.
    alpha, gamma : float, str or array
        Azimuth, and rotation of the section, at s = 0 [rad]. With weight, alpha = 0 is the low side of the cylinder.
    height : float or array, optional
        z(L) - z(0) [length], held instead of FZ.
    azimuth : float, str or array, optional
        alpha(L) - alpha(0) [rad], held instead of MZ.
    rotation : float, str or array, optional
        gamma(L) - gamma(0) [rad], held instead of M3.
    M10, M1L : float or array, optional
        Bending moment A beta' at s = 0 and at s = L [force length], given instead of the angle; 0: a hinge.
    radius0, radiusL : float or array, optional
        Only with unilateral contact: distance of the centreline from the axis at s = 0 and at s = L [length]. Default:
        on the wall. At radius 0 the azimuth turns only the frame that beta and the rotation are measured in; there
        that frame is held, so MZ at radiusL = 0 is a result.
    tilt0, tiltL : float, str or array, optional
        Only with unilateral contact: angle of the tangent at s = 0 and at s = L out of the tangent plane of the
        cylinder through that point, positive outwards [rad]. Default: 0.
    M20, M2L : float or array, optional
        Bending moment about the binormal in the surface, given instead of the tilt [force length]. With M10 = M20 = 0
        the start is a ball joint.

    Raises
    ------
    InputError
        If a field is not a finite number or, for an angle, such a text; if both of a pair are given, or neither an
        end's angle nor its moment.

    Examples
    --------
    >>> from solver import Ends
    >>> Ends(beta0=0.5, betaL="pi/4", FZ=-8.66).FZ
    -8.66
    >>> Ends(beta0=0.5, M1L=0.0, height=12.0).MZ
    0.0
    """

    def __post_init__(self) -> None:
        check_values(self)
        for field, partner in (*PAIRS, *TILTS):
            value, other = getattr(self, field), getattr(self, partner)
            if value is not None and other is not None:
                raise InputError(f"Ends takes {field} or {partner}, got both: {field}={value}, {partner}={other}")
            if value is None and other is None and field not in OFF_WALL:
                if field in ANGLES:
                    raise InputError(f"Ends needs {field} or {partner}, got neither; {partner}=0 is a hinge")
                object.__setattr__(self, field, PARTS["ends"][field].default)

    @classmethod
    def helix(cls, rod: Rod, cylinder: Cylinder, tension: Any, lay: Any, twist: Any = None) -> "Ends":
        """The ends of a rod that is wound on the cylinder as a uniform helix under tension.

        In a uniform helix H(beta) = 0, so F2 = (M3 - A sin cos/rho) sin^2/rho. With F3 = T these give
        FZ = T cos + F2 sin and MZ = rho (T sin - F2 cos) + M3 cos + A sin^3/rho.

        Parameters
        ----------
        rod, cylinder : Rod, Cylinder
            As of the case.
        tension : float or array
            T, the internal force along the rod, F3 [force].
        lay : float, str or array
            beta, the angle from the axis of the cylinder to the rod [rad]; negative for a left-handed helix.
        twist : float or array, optional
            Twist of the section per length, M3/C [rad/length]; 0 for a rod whose ends may turn. Default: that of
            M3 = A sin cos/rho, with which no force acts across the rod in the surface (F2 = 0, FZ = T cos).

        Raises
        ------
        InputError
            If a value is not a finite number or, for the angle, such a text.

        Examples
        --------
        >>> from solver import Cylinder, Ends, Rod
        >>> ends = Ends.helix(Rod(EI=3.9e7, GJ=3.0e7, a=10.0, L=6e3), Cylinder(R=180.0), 1e4, "89deg")
        >>> print(f"{ends.FZ:.2f}")
        174.52
        """
        wound = numbers_in_place({"tension": tension, "lay": lay, "twist": twist})
        if missing := [name for name in ("tension", "lay") if name not in wound]:
            raise InputError(f"a rod that is wound needs tension and lay, got no {missing[0]}")
        beta, T = wound["lay"], wound["tension"]
        rho, A = cylinder.R + SIDES[cylinder.side] * np.asarray(rod.a), rod.bending_stiffness
        s, c = np.sin(beta), np.cos(beta)
        M3 = wound["twist"] * rod.torsional_stiffness if "twist" in wound else A * s * c / rho
        F2 = (M3 - A * s * c / rho) * s**2 / rho
        loads = {"FZ": T * c + F2 * s, "MZ": rho * (T * s - F2 * c) + M3 * c + A * s**3 / rho, "M3": M3}
        return cls(beta0=beta, betaL=beta, **{name: np.asarray(value)[()] for name, value in loads.items()})

    def __repr__(self) -> str:
        return write_fields(self)


@check_field_names
@dataclass(frozen=True, eq=False)
class Case:
    """One case, or a grid of cases: the fields of its parts broadcast to `shape`.

    Parameters
    ----------
    rod : Rod
    cylinder : Cylinder
    given : Start or Ends

    Raises
    ------
    InputError
        If the fields do not broadcast, a rod inside the cylinder has no room (R <= a), an inclination is given
        without weight, an end lies in the wall or has no rod long enough, or unilateral contact does not fit the
        problem.

    Examples
    --------
    >>> from solver import Case, Cylinder, Rod, Start
    >>> rod = Rod(E=[1e4, 2e4, 4e4], nu=0.25, a=0.25, L=20.0)
    >>> case = Case(rod, Cylinder(R=0.75), Start(beta=0.5, dbeta=0.5, F3=10.0, M3=0.0))
    >>> case.shape, case.kind, case.rho
    ((3,), 'start', 1.0)
    """

    rod: Rod
    cylinder: Cylinder
    given: Start | Ends

    def __post_init__(self) -> None:
        for name, kinds in (("rod", (Rod,)), ("cylinder", (Cylinder,)), ("given", (Start, Ends))):
            if not isinstance(getattr(self, name), kinds):
                names = " or ".join(kind.__name__ for kind in kinds)
                raise InputError(f"Case.{name} must be a {names}, got {show(getattr(self, name))}")
        try:
            self.shape  # noqa: B018  (computed here so that a mismatch is refused when the case is made)
        except ValueError:
            shapes = {f"{type(o).__name__}.{f}": np.shape(v) for o, f, v in self._numeric if np.ndim(v)}
            raise InputError(f"the fields of a Case must broadcast, got shapes {shapes}") from None
        if self.cylinder.side == "inside":
            tight = np.less_equal(self.cylinder.R, self.rod.a)
            radius = self.rod.a if np.ndim(self.rod.a) else f"{self.rod.a:.10g}"
            refuse("Cylinder", "R", self.cylinder.R, tight, f"larger than Rod.a = {radius} for a rod inside")
        refuse_unmet({name: value for part in self._parts for name, value in vars(part).items() if name in FIELDS})
        if self.leaves:
            self._check_free_ends()
        elif isinstance(self.given, Ends):
            self._check_reach()

    def _check_free_ends(self) -> None:
        """Refuse a start problem, an end within the wall, and ends that are farther apart than the rod is long."""
        given, rho = self.given, self.rho
        if not isinstance(given, Ends):
            raise InputError(
                "contact='unilateral' needs Ends, got Start: a rod is stable or not between ends; solve the start "
                "problem with bilateral contact and let its solution go (Solution.let_go)"
            )
        words = "at least R + a" if self.outward > 0 else "at most R - a"
        for name, radius in zip(OFF_WALL[:2], self.end_radii, strict=True):
            # of rho: an end that is nearer to the wall lies on it
            bad = self.outward * (radius - rho) < -NEGLIGIBLE * rho
            refuse("Ends", name, radius, bad, f"{words} = {_least(rho, bad)}")
        if given.MZ is not None:
            idle = np.not_equal(given.MZ, 0) & np.equal(self.end_radii[1], 0)
            refuse("Ends", "MZ", given.MZ, idle, "0 at radiusL = 0, where M3 does its work")
        far, length = self._distance_of_ends(given), np.broadcast_to(self.rod.L, self.shape)
        if (bad := np.atleast_1d(far > length * (1 + NEGLIGIBLE))).any():
            i = np.flatnonzero(bad)[0]
            raise InputError(
                f"the ends are {far.flat[i]:.10g} apart, and the rod is only L = {length.flat[i]:.10g} long"
            )

    def _distance_of_ends(self, given: Ends) -> NDArray[np.float64]:
        """How far apart the ends are at least, by what is held of them, (*cases) [length]."""
        first, last = self.end_radii
        across = np.abs(last - first)
        if given.azimuth is not None:
            across = np.sqrt(np.maximum(first**2 + last**2 - 2 * first * last * np.cos(given.azimuth), 0.0))
        return np.broadcast_to(np.hypot(across, 0.0 if given.height is None else given.height), self.shape)

    def _check_reach(self) -> None:
        """Refuse a held end that no rod of this length reaches."""
        L, given = self.rod.L, self.given
        for name, bound, words in (("height", L, "L"), ("azimuth", L / self.rho, "L/rho")):
            value = getattr(given, name)
            if value is not None:
                far = np.abs(value) > bound
                refuse("Ends", name, value, far, f"from -{words} to {words}, and {words} is {_least(bound, far)}")

    @property
    def _numeric(self) -> list[tuple[Any, str, Any]]:
        """Part, name and value of each numeric field that is given."""
        values = ((part, name, getattr(part, name)) for part in self._parts for name in part.__match_args__)
        return [row for row in values if row[2] is not None and not isinstance(row[2], str)]

    @property
    def _parts(self) -> tuple[Rod, Cylinder, Start | Ends]:
        return self.rod, self.cylinder, self.given

    @property
    def kind(self) -> str:
        """The kind of problem: "start" or "ends"."""
        return "ends" if isinstance(self.given, Ends) else "start"

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """The shape to which all numeric fields broadcast; () for a single case."""
        return np.broadcast_shapes(*(np.shape(value) for _, _, value in self._numeric))

    @property
    def size(self) -> int:
        """Number of cases."""
        return math.prod(self.shape)

    @property
    def outward(self) -> float:
        """+1 for a rod outside, which the cylinder pushes outward; -1 for a rod inside."""
        return SIDES[self.cylinder.side]

    @property
    def leaves(self) -> bool:
        """Whether the rod may leave the cylinder, which then only pushes."""
        return self.cylinder.contact == "unilateral"

    @property
    def end_radii(self) -> tuple[Any, Any]:
        """The distances of both ends from the axis [length]."""
        radii = (getattr(self.given, name, None) for name in OFF_WALL[:2])
        first, last = (self.rho if radius is None else radius for radius in radii)
        return first, last

    @cached_property
    def varies(self) -> bool:
        """Whether loads vary along a rod: it has weight, or slides with friction."""
        return any(name in VARY_LOADS and bool(np.any(value)) for _, name, value in self._numeric)

    @property
    def has_hinge(self) -> bool:
        """Whether a bending moment is given at an end in place of its angle."""
        return isinstance(self.given, Ends) and (self.given.M10 is not None or self.given.M1L is not None)

    @property
    def on_nodes(self) -> bool:
        """Whether its equilibria are shapes on nodes, and no orbits: loads vary along the rod, or it is hinged."""
        return self.varies or self.has_hinge

    @cached_property
    def rho(self) -> Any:
        """Distance of the centreline from the axis [length]: R + a outside, R - a inside; eq. (21)."""
        with np.errstate(over="ignore"):  # reported in the outcome
            return self.cylinder.R + self.outward * self.rod.a

    def _repr_html_(self) -> str | None:
        """A table for a notebook; None, which shows the `repr`, where the workbench cannot be imported."""
        return table_of("case", self)

    @cached_property
    def loads(self) -> tuple[Any, Any, Any]:
        """FZ [force], MZ and M3 [force length], constant along the rod; with weight or friction those at the end, of a
        start problem at the start.

        Of a start problem by eqs. (25) and (30), and M3 by eq. (33) from F1 or by eq. (24), row 6, from dgamma.
        """
        given, rod, rho = self.given, self.rod, self.rho
        if isinstance(given, Ends):
            if unknown := [field for field, _ in PAIRS[2:] if getattr(given, field) is None]:
                raise InputError(
                    f"{', '.join(unknown)} of held ends {'is' if len(unknown) == 1 else 'are'} "
                    "known only of a solution: see Solution.FZ, MZ and M3"
                )
            return given.FZ, given.MZ, given.M3
        A, s, c = rod.bending_stiffness, np.sin(given.beta), np.cos(given.beta)
        with np.errstate(all="ignore"):  # overflow is reported in the outcome of the case
            if given.M3 is not None:
                m = given.M3 / A
            elif given.dgamma is not None:
                m = (given.dgamma + s * c / rho) / rod.stiffness_ratio
            else:
                m = given.F1 / (A * given.dbeta) + 3 * s * c / rho
            FY = -given.F2 * c + given.F3 * s
            FZ = given.F2 * s + given.F3 * c
            return FZ, rho * FY + A * (m * c + s**3 / rho), A * m if given.M3 is None else given.M3


def _least(bound: Any, bad: Any) -> str:
    """The least of bounds, one or an array, where values are bad."""
    return f"{np.min(np.broadcast_to(bound, np.shape(bad)), where=bad, initial=np.inf):.10g}"


def check_case(function: str, value: object) -> Case:
    """The value if it is a Case. Raises `InputError` with how to make one."""
    if not isinstance(value, Case):
        how = f"{function}(Case(rod, cylinder, Start(...) or Ends(...)))"
        raise InputError(f"{function} takes a Case, got {show(value)}; write {how}")
    if function != "solve":
        refuse_leaving(value.cylinder, function)
    return value


def refuse_leaving(cylinder: Cylinder, function: str) -> None:
    """Raise `InputError` for a cylinder that only pushes."""
    if cylinder.contact == "unilateral":
        raise InputError(
            f"{function} is for rods that the cylinder holds on, got contact='unilateral'; of a rod that may leave it "
            "solve and observe are known"
        )


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

    Raises
    ------
    InputError
        For a value that is no finite number.

    Examples
    --------
    >>> from solver import weight_in_fluid
    >>> print(f"{weight_in_fluid(0.0635, 0.0543, fluid=1200.0):.1f} N/m")  # 5 inch pipe in mud
    222.0 N/m
    """
    given = {"a": a, "inner_radius": inner_radius, "density": density, "fluid": fluid, "gravity": gravity}
    outer, inner, solid, liquid, pull = (numbers_of("weight_in_fluid", name, value) for name, value in given.items())
    return np.pi * (outer - inner) * (outer + inner) * (solid - liquid) * pull
