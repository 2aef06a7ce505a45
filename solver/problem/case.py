"""What is asked: a rod, a cylinder, and what is given at the ends. Frozen values, checked at the door.

Every numeric field may be a number or an array; the fields of a case broadcast against each other. An angle may
also be text: `Start(beta="30deg", ...)`, `Ends("pi/6", ["10deg", "20deg"])`.
"""

from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .angles import FORMS, angle
from .errors import InputError, no_such

STIFFNESS = {"solid": np.pi / 4, "paper": np.pi / 16}
SIDES = {"outside": 1.0, "inside": -1.0}
ANGLES = ("beta", "beta0", "betaL", "alpha", "gamma")  # the fields that may be text, as `angles` reads it
TWISTS = ("F1", "dgamma", "M3")  # of a start, each fixes the twisting moment


def _numbers(owner: str, field: str, value: Any) -> NDArray[np.float64] | float:
    """The value as a float or a float array, angles in rad; `InputError` where it is neither, or not finite."""
    try:
        array = np.asarray(value)
        if field in ANGLES and array.dtype.kind in "UO":
            array = _in_rad(np.array(value, dtype=object))
        if not _only_numbers(array):
            raise TypeError
        array = np.array(array, dtype=float)
    except (TypeError, ValueError):
        wanted = f"{FORMS}; or an array of these" if field in ANGLES else "a number or an array of numbers"
        raise InputError(f"{owner}.{field} must be {wanted}, got {value!r}") from None
    if array.size == 0:
        raise InputError(f"{owner}.{field} is empty; give at least one value")
    _refuse(owner, field, array, ~np.isfinite(array), "finite")
    if array.ndim == 0:
        return float(array)
    array.setflags(write=False)
    return array


def _in_rad(values: NDArray[Any]) -> NDArray[Any]:
    """An array of objects, its texts as the angles they write. Raises `ValueError`."""
    read = [angle(one) if isinstance(one, str) else one for one in values.flat]
    return np.array(read, dtype=object).reshape(values.shape)


def _only_numbers(array: NDArray[Any]) -> bool:
    """Whether each element is a real number: text that reads like one is none."""
    if array.dtype.kind == "O":
        return not any(one is None or isinstance(one, (str, bytes)) for one in array.flat)
    return array.dtype.kind in "biuf"


def _refuse(owner: str, field: str, value: ArrayLike, bad: ArrayLike, rule: str) -> None:
    bad = np.atleast_1d(bad)
    if bad.any():
        worst = np.atleast_1d(np.asarray(value))[bad].flat[0]
        where = f" (the first of {int(bad.sum())} among {bad.size} values)" if bad.size > 1 else ""
        raise InputError(f"{owner}.{field} must be {rule}, got {worst!s}{where}")


def _check_numbers(self: Any, skip: tuple[str, ...] = ()) -> None:
    """Turn each numeric field of a frozen dataclass into floats or read-only arrays."""
    for field in fields(self):
        value = getattr(self, field.name)
        optional = field.default is None
        if field.name not in skip and not (optional and value is None):
            object.__setattr__(self, field.name, _numbers(type(self).__name__, field.name, value))


@dataclass(frozen=True, eq=False)
class Rod:
    """A naturally straight, inextensible rod of circular section.

    E: Young's modulus [force/length^2]; nu: Poisson ratio; a: radius of the section [length]; L: length [length].
    stiffness: "solid" (pi/4 E a^4, the second moment of a solid section) or "paper" (eq. 20 as printed, a quarter).

    Raises `InputError` for E, a or L not positive, nu outside (-1, 0.5], or an unknown stiffness.
    """

    E: Any
    nu: Any
    a: Any
    L: Any
    stiffness: str = "solid"

    def __post_init__(self) -> None:
        _check_numbers(self, skip=("stiffness",))
        for name in ("E", "a", "L"):
            value = getattr(self, name)
            _refuse("Rod", name, value, np.less_equal(value, 0), "positive and finite")
        _refuse("Rod", "nu", self.nu, np.less_equal(self.nu, -1) | np.greater(self.nu, 0.5), "in (-1, 0.5]")
        if self.stiffness not in STIFFNESS:
            raise no_such("stiffness", self.stiffness, STIFFNESS)

    @property
    def bending_stiffness(self) -> Any:
        """A [force length^2]; eq. (20), with the factor that `stiffness` names; 0 or inf where no float holds it."""
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            return STIFFNESS[self.stiffness] * self.E * np.power(self.a, 4.0)

    @property
    def torsional_stiffness(self) -> Any:
        """C = A / (1 + nu) [force length^2]; eq. (20)."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self.bending_stiffness / (1 + self.nu)


@dataclass(frozen=True, eq=False)
class Cylinder:
    """The frictionless cylinder: R its radius [length]; side: where the rod lies, "outside" or "inside".

    Raises `InputError` for R not positive or an unknown side.
    """

    R: Any
    side: str = "outside"

    def __post_init__(self) -> None:
        _check_numbers(self, skip=("side",))
        _refuse("Cylinder", "R", self.R, np.less_equal(self.R, 0), "positive and finite")
        if self.side not in SIDES:
            raise no_such("side", self.side, SIDES)


@dataclass(frozen=True, eq=False)
class Start:
    """Everything given at s = 0: an initial value problem with one solution.

    beta [rad], dbeta [rad/length]: angle from the axis to the tangent, and its rate. F1 (inward normal), F2 (in the
    surface, across), F3 (tangent, tension positive) [force]: the internal force. The twist follows from exactly one
    of F1, dgamma [rad/length], the rate of the section's own rotation, and M3 [force length], the twisting moment.
    alpha, gamma [rad]: azimuth and rotation. beta, alpha and gamma may also be text: "30deg", "pi/6".

    Raises `InputError` for none or several of F1, dgamma and M3, or F1 together with dbeta = 0.
    """

    beta: Any
    dbeta: Any
    F1: Any = None
    F2: Any = 0.0
    F3: Any = 0.0
    dgamma: Any = None
    alpha: Any = 0.0
    gamma: Any = 0.0
    M3: Any = None

    def __post_init__(self) -> None:
        _check_numbers(self)
        if sum(getattr(self, name) is not None for name in TWISTS) != 1:
            got = ", ".join(f"{name}={getattr(self, name)}" for name in TWISTS)
            raise InputError(f"Start needs exactly one of F1, dgamma and M3, got {got}: each fixes the twisting moment")
        if self.F1 is not None and np.any(np.equal(self.dbeta, 0)):
            raise InputError(
                "Start.F1 cannot fix the twist where dbeta = 0 (F1 is proportional to dbeta), "
                f"got F1={self.F1} and dbeta=0; give dgamma or M3 instead"
            )


@dataclass(frozen=True, eq=False)
class Ends:
    """The angle at both ends and the dead loads: a boundary value problem with many solutions.

    beta0, betaL [rad]: the angle at s = 0 and s = L. FZ [force]: axial force, tension positive. MZ, M3
    [force length]: axial and twisting moment. alpha, gamma [rad]: azimuth and rotation at s = 0. The four angles may
    also be text: "30deg", "pi/6".

    Raises `InputError` for a field that is neither a number nor, where it is an angle, such a text.
    """

    beta0: Any
    betaL: Any
    FZ: Any = 0.0
    MZ: Any = 0.0
    M3: Any = 0.0
    alpha: Any = 0.0
    gamma: Any = 0.0

    def __post_init__(self) -> None:
        _check_numbers(self)


@dataclass(frozen=True, eq=False)
class Case:
    """One case, or a whole grid of them: the fields of its parts broadcast to `shape`.

    Raises `InputError` where they do not broadcast, or where a rod inside has no room (R <= a).
    """

    rod: Rod
    cylinder: Cylinder
    given: Start | Ends

    def __post_init__(self) -> None:
        for name, kinds in (("rod", (Rod,)), ("cylinder", (Cylinder,)), ("given", (Start, Ends))):
            if not isinstance(getattr(self, name), kinds):
                wanted = " or ".join(kind.__name__ for kind in kinds)
                raise InputError(f"Case.{name} must be a {wanted}, got {getattr(self, name)!r}")
        if self.cylinder.side == "inside":
            tight = np.less_equal(self.cylinder.R, self.rod.a)
            rule = f"larger than Rod.a = {self.rod.a!s} for a rod inside"
            _refuse("Cylinder", "R", np.broadcast_to(self.cylinder.R, np.shape(tight)), tight, rule)
        try:
            self.shape  # noqa: B018  (computed here so that a mismatch is refused at the door)
        except ValueError:
            shapes = {f"{type(o).__name__}.{f}": np.shape(v) for o, f, v in self._numeric() if np.ndim(v)}
            raise InputError(f"the fields of a Case must broadcast, got shapes {shapes}") from None

    def _numeric(self) -> Iterator[tuple[Any, str, Any]]:
        for part in (self.rod, self.cylinder, self.given):
            for field in fields(part):
                value = getattr(part, field.name)
                if value is not None and not isinstance(value, str):
                    yield part, field.name, value

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """The shape all numeric fields broadcast to; () for a single case."""
        return np.broadcast_shapes(*(np.shape(value) for _, _, value in self._numeric()))

    @property
    def size(self) -> int:
        """How many cases."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def outward(self) -> float:
        """+1 where contact pushes outward (rod outside), -1 inside."""
        return SIDES[self.cylinder.side]

    @cached_property
    def rho(self) -> Any:
        """Distance of the centreline from the axis [length]: R + a outside, R - a inside; eq. (21)."""
        with np.errstate(over="ignore"):  # told by the outcome
            return self.cylinder.R + self.outward * self.rod.a

    @cached_property
    def loads(self) -> tuple[Any, Any, Any]:
        """FZ [force], MZ, M3 [force length], constants of the rod; eqs. (25), (30), and (33) or (24) row 6 for M3."""
        given, rod, rho = self.given, self.rod, self.rho
        if isinstance(given, Ends):
            return given.FZ, given.MZ, given.M3
        A, s, c = rod.bending_stiffness, np.sin(given.beta), np.cos(given.beta)
        with np.errstate(all="ignore"):  # numbers beyond a float are told by the outcome of their case
            if given.M3 is not None:
                m = given.M3 / A
            elif given.dgamma is not None:
                m = (given.dgamma + s * c / rho) / (1 + rod.nu)
            else:
                m = given.F1 / (A * given.dbeta) + 3 * s * c / rho
            FY = -given.F2 * c + given.F3 * s
            FZ = given.F2 * s + given.F3 * c
            return FZ, rho * FY + A * (m * c + s**3 / rho), A * m if given.M3 is None else given.M3


def from_fields(kind: type, values: dict[str, Any]) -> Any:
    """A Rod, Cylinder, Start or Ends from a mapping; unknown and missing fields raise `InputError` with the choices."""
    known = {field.name: field for field in fields(kind)}
    for name in values:
        if name not in known:
            raise InputError(f"no field {name!r} in {kind.__name__}; choose from {', '.join(known)}")
    missing = [n for n, f in known.items() if f.default is MISSING and n not in values]
    if missing:
        raise InputError(f"{kind.__name__} needs {', '.join(missing)}; got {', '.join(values) or 'nothing'}")
    return kind(**values)
