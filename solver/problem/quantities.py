"""Every quantity of the workbench, one row each: all labels, units and former names come from this table.

A dimension is a pair of exponents (length, force); the unit of an angle is ``rad``; a ``text`` or flag has none.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from .errors import InputError, no_such
from .notices import RenamedWarning, warn


@dataclass(frozen=True)
class Quantity:
    """A quantity.

    estimated: whether its error is estimated; the error is the quantity ``<name>_error``. former: its name in 0.2.0,
    which is read until 0.5.0 wherever a name is given, and written nowhere.
    """

    name: str
    symbol: str
    dimension: tuple[int, int] | str
    long_name: str
    estimated: bool = False
    former: str = ""


_NUMBER = (0, 0)
_LENGTH = (1, 0)
_FORCE = (0, 1)
_MOMENT = (1, 1)
_PER_LENGTH = (-1, 0)
_LINE_LOAD = (-1, 1)


def _with_error(name: str, symbol: str, dimension: tuple[int, int] | str, long_name: str) -> Quantity:
    return Quantity(name, symbol, dimension, long_name, estimated=True)


_ROWS = (
    # the rod, the cylinder, the start and the ends
    Quantity("E", "E", (-2, 1), "Young's modulus"),
    Quantity("nu", "ν", _NUMBER, "Poisson ratio"),
    Quantity("EI", "EI", (2, 1), "bending stiffness, given"),
    Quantity("GJ", "GJ", (2, 1), "torsional stiffness, given"),
    Quantity("a", "a", _LENGTH, "radius of the rod"),
    Quantity("inner_radius", "aᵢ", _LENGTH, "inner radius of the rod"),
    Quantity("L", "L", _LENGTH, "length of the rod"),
    Quantity("weight", "w", _LINE_LOAD, "weight per length in the fluid"),
    Quantity("R", "R", _LENGTH, "radius of the cylinder"),
    Quantity("inclination", "θ", "rad", "angle of the axis to the upward vertical"),
    Quantity("friction", "μ", _NUMBER, "coefficient of sliding friction"),
    Quantity("rho", "ρ", _LENGTH, "distance of the centreline from the axis"),
    Quantity("bending_stiffness", "A", (2, 1), "bending stiffness"),
    Quantity("torsional_stiffness", "C", (2, 1), "torsional stiffness"),
    Quantity("beta0", "β₀", "rad", "angle from the axis at the start"),
    Quantity("dbeta0", "β₀′", "rad/length", "rate of the angle at the start"),
    Quantity("alpha0", "α₀", "rad", "azimuth of the start"),
    Quantity("gamma0", "γ₀", "rad", "rotation of the section at the start"),
    Quantity("betaL", "β(L)", "rad", "angle from the axis at the far end"),
    Quantity("azimuth", "Δα", "rad", "azimuth from the start to the far end"),
    Quantity("rotation", "Δγ", "rad", "rotation of the section from the start to the far end"),
    _with_error("M10", "M₁(0)", _MOMENT, "bending moment at the start"),
    _with_error("M1L", "M₁(L)", _MOMENT, "bending moment at the far end"),
    Quantity("radius0", "r(0)", _LENGTH, "distance of the start from the axis"),
    Quantity("radiusL", "r(L)", _LENGTH, "distance of the far end from the axis"),
    Quantity("tilt0", "τ(0)", "rad", "tilt of the tangent out of the wall at the start, outwards"),
    Quantity("tiltL", "τ(L)", "rad", "tilt of the tangent out of the wall at the far end, outwards"),
    Quantity("M20", "M₂(0)", _MOMENT, "bending moment in the surface at the start"),
    Quantity("M2L", "M₂(L)", _MOMENT, "bending moment in the surface at the far end"),
    Quantity("dgamma", "γ₀′", "rad/length", "rate of rotation of the section at the start"),
    # in place of an inclination, of loads and of ends
    Quantity("hole", "hole", "rad", "inclination of a hole that s runs down, 0: vertical, 90deg: horizontal"),
    Quantity("wob", "WOB", _FORCE, "weight on bit, the push at the lower end"),
    Quantity("tension", "T", _FORCE, "force along a rod that is wound as a uniform helix"),
    Quantity("lay", "lay", "rad", "angle of this helix from the axis"),
    Quantity("twist", "twist", "rad/length", "twist of the section of this helix per length, M3/GJ"),
    # along the rod
    Quantity("u", "s/L", _NUMBER, "share of the length"),
    Quantity("s", "s", _LENGTH, "arc length"),
    Quantity("beta", "β", "rad", "angle from the axis to the tangent"),
    Quantity("dbeta", "β′", "rad/length", "rate of the angle (geodesic curvature)"),
    Quantity("alpha", "α", "rad", "azimuth"),
    Quantity("z", "z", _LENGTH, "distance along the axis"),
    Quantity("radius", "r", _LENGTH, "distance of the centreline from the axis"),
    Quantity("gap", "gap", _LENGTH, "distance of the rod from the wall"),
    Quantity("tilt", "τ", "rad", "angle of the tangent out of the wall, outwards"),
    Quantity("gamma", "γ", "rad", "rotation of the section"),
    Quantity("position", "r", _LENGTH, "position of the centreline"),
    Quantity("kappa", "κ", _PER_LENGTH, "curvature"),
    Quantity("F1", "F₁", _FORCE, "internal force along the inward normal"),
    Quantity("F2", "F₂", _FORCE, "internal force in the surface, across the rod"),
    Quantity("F3", "F₃", _FORCE, "internal force along the tangent, tension positive"),
    Quantity("FY", "FY", _FORCE, "circumferential force"),
    Quantity("contact", "f", _LINE_LOAD, "contact force per length, positive outward"),
    Quantity("M1", "M₁", _MOMENT, "bending moment about the inward normal"),
    Quantity("M2", "M₂", _MOMENT, "bending moment about the binormal in the surface"),
    Quantity("M3_along", "M₃(s)", _MOMENT, "twisting moment along the rod"),
    # constants of the rod
    Quantity("FZ", "FZ", _FORCE, "axial force"),
    Quantity("MZ", "MZ", _MOMENT, "axial moment"),
    Quantity("M3", "M₃", _MOMENT, "twisting moment"),
    _with_error("FZ0", "FZ(0)", _FORCE, "axial force at the start"),
    _with_error("MZ0", "MZ(0)", _MOMENT, "axial moment at the start"),
    _with_error("M30", "M₃(0)", _MOMENT, "twisting moment at the start"),
    _with_error("neutral_at", "FZ = 0 at s", _LENGTH, "first s where the axial force is 0"),
    _with_error("surface_torque", "T", _MOMENT, "torque at the upper end that turns the rod"),
    Quantity("reach", "L lock-up", _LENGTH, "length at which friction locks up this rod under its load"),
    Quantity("arriving_max", "max arriving F", _FORCE, "largest compression that arrives over this length"),
    Quantity("h", "h", (-2, 0), "first integral of the angle"),
    # observables
    Quantity("bends", "bends", _NUMBER, "number of bends (interior extrema of beta)", former="turns"),
    _with_error("bend_number", "half waves", _NUMBER, "number of half waves of beta along the rod"),
    Quantity("loops", "full turns of β", _NUMBER, "full turns of beta"),
    _with_error("amplitude", "amplitude of β", "rad", "largest beta minus smallest beta"),
    _with_error("kappa_mean", "mean κ", _PER_LENGTH, "mean curvature"),
    _with_error("kappa_max", "max κ", _PER_LENGTH, "largest curvature"),
    replace(_with_error("turns_around", "turns around", _NUMBER, "turns around the cylinder"), former="wraps"),
    _with_error("height", "z(L)", _LENGTH, "axial distance of the far end"),
    _with_error("pitch", "pitch", _LENGTH, "height of one turn about the axis, in the middle third"),
    _with_error(
        "contact_size_mean", "mean |f|", _LINE_LOAD, "mean size of the contact force per length (push and pull)"
    ),
    _with_error("push_mean", "mean push", _LINE_LOAD, "mean push of the cylinder per length, pulls not counted"),
    _with_error("pull_mean", "mean pull", _LINE_LOAD, "mean pull of the cylinder per length, pushes not counted"),
    _with_error(
        "push_min", "min push", _LINE_LOAD, "smallest push of the cylinder per length, negative where it pulls"
    ),
    _with_error("push_max", "max push", _LINE_LOAD, "largest push of the cylinder per length"),
    _with_error("push_max_at", "max push at s", _LENGTH, "first s of the largest push"),
    _with_error(
        "push_middle", "push in the middle", _LINE_LOAD, "mean push per length in the middle third, pulls not counted"
    ),
    _with_error("attached", "attached share", _NUMBER, "share of the length where the cylinder pushes"),
    _with_error("lift_off_at", "lift-off at s", _LENGTH, "first s where the cylinder pulls (L: nowhere)"),
    _with_error("F3_size_max", "max |F₃|", _FORCE, "largest size of the internal force along the tangent"),
    _with_error("bending_moment_max", "max M", _MOMENT, "largest bending moment"),
    _with_error("bending_stress_max", "max σ", (-2, 1), "largest bending stress, E a kappa"),
    Quantity("overlaps", "overlaps", _NUMBER, "1 where the rod intersects itself, else 0"),
    _with_error("energy", "energy", _MOMENT, "bending and twist energy minus the work of FZ, MZ, M3 and the weight"),
    Quantity("held_energy", "held energy", _MOMENT, "bending and twist energy minus the work of the given loads alone"),
    _with_error("bending_energy", "bending energy", _MOMENT, "bending energy"),
    _with_error("twist_energy", "twist energy", _MOMENT, "twist energy"),
    Quantity("index", "index", _NUMBER, "Morse index (0: stable)"),
    Quantity("held_index", "index", _NUMBER, "Morse index under held ends (0: stable)"),
    _with_error("gap_max", "max gap", _LENGTH, "largest distance of the rod from the wall"),
    _with_error("contact_share", "share on the wall", _NUMBER, "share of the length on the wall"),
    Quantity("contact_count", "contacts", _NUMBER, "number of intervals and points of contact"),
    _with_error("point_force_max", "max point force", _FORCE, "largest force at an edge or a single point of contact"),
    Quantity("sample", "sample", _NUMBER, "sample"),
    Quantity("branch", "branch", _NUMBER, "branch of equilibria (-1: not solved)"),
    # how well it was solved
    Quantity("error", "error", _NUMBER, "estimated error of beta, and of alpha and z/rho over max(1, L/rho)"),
    Quantity("condition", "condition", _NUMBER, "growth of a change of the start along the rod"),
    Quantity("solved", "solved", "text", "whether the case is solved"),
    Quantity("outcome", "outcome", "text", "solved, or why not"),
    Quantity("caution", "caution", "text", "what a real rod could not do, or what was not checked; empty: none"),
)

# Fields of a case that are the value of a quantity at s = 0, which has another name.
AT_START = {"beta": "beta0", "dbeta": "dbeta0", "alpha": "alpha0", "gamma": "gamma0"}

QUANTITIES: dict[str, Quantity] = {row.name: row for row in _ROWS} | {
    f"{row.name}_error": Quantity(
        f"{row.name}_error", f"δ({row.symbol})", row.dimension, f"estimated error of: {row.long_name}"
    )
    for row in _ROWS
    if row.estimated
}


RENAMED: dict[str, str] = {row.former: row.name for row in _ROWS if row.former}  # former name -> name
RENAMED |= {f"{former}_error": f"{name}_error" for former, name in RENAMED.items() if f"{name}_error" in QUANTITIES}
_FORMER = re.compile(rf"\b({'|'.join(RENAMED)})\b")


def current(name: Any) -> Any:
    """The name of a quantity that is given by its former one, with a `RenamedWarning`; any other value as it is.

    >>> current("height")
    'height'
    """
    if not isinstance(name, str) or name not in RENAMED:
        return name
    old, new = (known.removesuffix("_error") for known in (name, RENAMED[name]))
    warn(f"{old!r} is now called {new!r}; the old name is read until 0.5.0", RenamedWarning)
    return RENAMED[name]


def in_current_names(formula: str) -> str:
    """A formula with the names of today in place of former ones, as of `current`."""
    return _FORMER.sub(lambda found: str(current(found[0])), formula)


class ByName(dict[str, Any]):
    """Values of quantities by name; a former name gives the value of today's, with a notice."""

    def __missing__(self, name: str) -> Any:
        if RENAMED.get(name) not in self:
            raise KeyError(name)
        return self[current(name)]


def former(name: str) -> Any:
    """The attribute of a former name, which gives that of today with a notice."""
    return property(lambda holder: getattr(holder, current(name)), doc=f"Former name of `{RENAMED[name]}`.")


def quantity(name: str) -> Quantity:
    """The row of one quantity. Raises `InputError` for an unknown name."""
    if name not in QUANTITIES:
        raise no_such("quantity", name, QUANTITIES)
    return QUANTITIES[name]


def unit_of(name: str, units: Mapping[str, str]) -> str:
    """The unit of a quantity in a system of units. Raises `InputError` if the system lacks a unit.

    >>> unit_of("E", {"length": "cm", "force": "N"})
    'N/cm^2'
    """
    missing = [key for key in ("length", "force") if not units.get(key)]
    if missing:
        raise InputError(f"units need a {' and a '.join(missing)}, got {dict(units)!r}")
    dimension = quantity(name).dimension
    if dimension == "text":
        return ""
    if isinstance(dimension, str):
        return dimension.replace("length", units["length"])
    return unit_text(dimension, units)


def unit_text(dimension: tuple[Fraction | int, Fraction | int], units: Mapping[str, str]) -> str:
    """The unit of exponents of length and force: ``N/cm^2``; ``1`` for a plain number."""
    length, force = dimension
    above = [_power(units[key], n) for key, n in (("force", force), ("length", length)) if n > 0]
    below = [_power(units[key], -n) for key, n in (("force", force), ("length", length)) if n < 0]
    return " ".join(above or ["1"]) + "".join(f"/{unit}" for unit in below)


def _power(unit: str, exponent: Fraction | int) -> str:
    return unit if exponent == 1 else f"{unit}^{exponent}" if exponent == int(exponent) else f"{unit}^({exponent})"
