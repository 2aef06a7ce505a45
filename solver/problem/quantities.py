"""Every quantity of the workbench: all labels, units and former names come from this table.

The fields of a case are declared in `declared_fields`; each other quantity is a row here. A dimension is a pair of
exponents (length, force); the unit of an angle is ``rad``; a ``text`` or flag has none.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from .declared_fields import ALL_FIELDS, FORCE, LENGTH, LINE_LOAD, MOMENT, NUMBER, RIGIDITY, STRESS, Dimension
from .declared_fields import AT_START as AT_START  # fields that are the value of a quantity at s = 0
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
    dimension: Dimension
    long_name: str
    estimated: bool = False
    former: str = ""


_PER_LENGTH = (-1, 0)


def _with_error(name: str, symbol: str, dimension: Dimension, long_name: str) -> Quantity:
    return Quantity(name, symbol, dimension, long_name, estimated=True)


_ROWS = (
    # of rods and cylinders, beside the fields of a case
    Quantity("rho", "ρ", LENGTH, "distance of the centreline from the axis"),
    Quantity("bending_stiffness", "A", RIGIDITY, "bending stiffness"),
    Quantity("torsional_stiffness", "C", RIGIDITY, "torsional stiffness"),
    # along the rod
    Quantity("u", "s/L", NUMBER, "share of the length"),
    Quantity("s", "s", LENGTH, "arc length"),
    Quantity("beta", "β", "rad", "angle from the axis to the tangent"),
    Quantity("dbeta", "β′", "rad/length", "rate of the angle (geodesic curvature)"),
    Quantity("alpha", "α", "rad", "azimuth"),
    Quantity("z", "z", LENGTH, "distance along the axis"),
    Quantity("radius", "r", LENGTH, "distance of the centreline from the axis"),
    Quantity("gap", "gap", LENGTH, "distance of the rod from the wall"),
    Quantity("tilt", "τ", "rad", "angle of the tangent out of the wall, outwards"),
    Quantity("gamma", "γ", "rad", "rotation of the section"),
    Quantity("position", "r", LENGTH, "position of the centreline"),
    Quantity("kappa", "κ", _PER_LENGTH, "curvature"),
    Quantity("FY", "FY", FORCE, "circumferential force"),
    Quantity("contact", "f", LINE_LOAD, "contact force per length, positive outward"),
    Quantity("M1", "M₁", MOMENT, "bending moment about the inward normal"),
    Quantity("M2", "M₂", MOMENT, "bending moment about the binormal in the surface"),
    Quantity("M3_along", "M₃(s)", MOMENT, "twisting moment along the rod"),
    # constants of the rod
    _with_error("MZ0", "MZ(0)", MOMENT, "axial moment at the start"),
    _with_error("M30", "M₃(0)", MOMENT, "twisting moment at the start"),
    _with_error("neutral_at", "FZ = 0 at s", LENGTH, "first s where the axial force is 0"),
    _with_error("surface_torque", "T", MOMENT, "torque at s = 0 that turns the rod"),
    Quantity("reach", "L lock-up", LENGTH, "length at which friction locks up this rod under its load"),
    Quantity("arriving_max", "max arriving F", FORCE, "largest compression that arrives over this length"),
    Quantity("h", "h", (-2, 0), "first integral of the angle"),
    # observables
    Quantity("bends", "bends", NUMBER, "number of bends (interior extrema of beta)", former="turns"),
    _with_error("bend_number", "half waves", NUMBER, "number of half waves of beta along the rod"),
    Quantity("loops", "full turns of β", NUMBER, "full turns of beta"),
    _with_error("amplitude", "range of β", "rad", "largest beta minus smallest beta"),
    _with_error("kappa_mean", "mean κ", _PER_LENGTH, "mean curvature"),
    _with_error("kappa_max", "max κ", _PER_LENGTH, "largest curvature"),
    replace(_with_error("turns_around", "turns around", NUMBER, "turns around the cylinder"), former="wraps"),
    _with_error("pitch", "pitch", LENGTH, "height per turn about the axis, in the middle third"),
    _with_error(
        "contact_size_mean",
        "mean |f|",
        LINE_LOAD,
        "mean size of the contact force (per length; of push and pull alike)",
    ),
    _with_error("push_mean", "mean push", LINE_LOAD, "mean push of the cylinder per length, pulls not counted"),
    _with_error("pull_mean", "mean pull", LINE_LOAD, "mean pull of the cylinder per length, pushes not counted"),
    _with_error(
        "push_min", "min push", LINE_LOAD, "smallest push of the cylinder per length (below 0 the rod would lift off)"
    ),
    _with_error("push_max", "max push", LINE_LOAD, "largest push of the cylinder per length"),
    _with_error("push_max_at", "max push at s", LENGTH, "first s of the largest push"),
    _with_error(
        "push_middle", "push in the middle", LINE_LOAD, "mean push per length in the middle third, pulls not counted"
    ),
    _with_error("attached", "attached share", NUMBER, "share of the length where the cylinder pushes"),
    _with_error("lift_off_at", "lift-off at s", LENGTH, "first s where the cylinder pulls (L: nowhere)"),
    _with_error("F3_size_max", "max |F₃|", FORCE, "largest size of the internal force along the tangent"),
    _with_error("bending_moment_max", "max M", MOMENT, "largest bending moment"),
    _with_error("bending_stress_max", "max σ", STRESS, "largest bending stress, E a kappa"),
    Quantity("overlaps", "overlaps", NUMBER, "1 where the rod intersects itself, else 0"),
    _with_error("energy", "energy", MOMENT, "bending and twist energy minus the work of FZ, MZ, M3 and the weight"),
    Quantity("held_energy", "held energy", MOMENT, "bending and twist energy minus the work of the given loads alone"),
    _with_error("bending_energy", "bending energy", MOMENT, "bending energy"),
    _with_error("twist_energy", "twist energy", MOMENT, "twist energy"),
    Quantity("index", "index", NUMBER, "Morse index (0: stable)"),
    Quantity("held_index", "index", NUMBER, "Morse index under held ends (0: stable)"),
    _with_error("gap_max", "max gap", LENGTH, "largest distance of the rod from the wall"),
    _with_error("contact_share", "share on the wall", NUMBER, "share of the length on the wall"),
    Quantity("contact_count", "contacts", NUMBER, "number of intervals and points of contact"),
    _with_error("contact_at", "first contact at s", LENGTH, "first s on the wall"),
    _with_error("contact_alpha", "α at first contact", "rad", "azimuth at the first contact"),
    _with_error("contact_M2", "M₂ at first contact", MOMENT, "bending moment M2 at the first contact"),
    _with_error("point_force_max", "max point force", FORCE, "largest force at an edge or a single point of contact"),
    Quantity("sample", "sample", NUMBER, "sample"),
    Quantity("branch", "branch", NUMBER, "branch of equilibria (-1: not solved)"),
    # how well it was solved
    Quantity("error", "error", NUMBER, "estimated error of beta, and of alpha and z/rho over max(1, L/rho)"),
    Quantity("condition", "condition", NUMBER, "growth of a change of the start along the rod"),
    Quantity("solved", "solved", "text", "whether the case is solved"),
    Quantity("outcome", "outcome", "text", "solved, or why not"),
    Quantity("caution", "caution", "text", "what a real rod could not do, or what was not checked; empty: none"),
)

_EVERY = {
    row.quantity: Quantity(row.quantity, row.symbol, row.dimension, row.long_name, row.estimated)
    for row in ALL_FIELDS.values()
    if not row.choices
} | {row.name: row for row in _ROWS}

QUANTITIES: dict[str, Quantity] = {row.name: row for row in _EVERY.values()} | {
    f"{row.name}_error": Quantity(
        f"{row.name}_error", f"δ({row.symbol})", row.dimension, f"estimated error of: {row.long_name}"
    )
    for row in _EVERY.values()
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
    return _FORMER.sub(lambda match: str(current(match[0])), formula)


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
