"""A rod that may leave the cylinder, in words: where it lies on the wall, and what letting it go did."""

import math
from typing import TYPE_CHECKING, Any

from solver.observe.observables import observe

from .habits import plain

if TYPE_CHECKING:
    from solver import Solution

MOST = 6  # intervals of contact that are named one by one
ELASTIC = ("bending_energy", "twist_energy")


def sentences(sol: "Solution", units: dict[str, str]) -> list[str]:
    """Where a rod lies on the wall, and the forces at the edges; none of a rod that the cylinder holds on."""
    if not (sol.case.leaves and sol.solved):
        return []
    length, force = units["length"], units["force"]
    numbers = {name: float(value) for name, value in observe(sol, ["gap_max", "contact_share"]).items()}
    gap = f"up to {plain(numbers['gap_max'])} {length} off the wall"
    if not sol.contacts:
        return [f"the rod touches the cylinder nowhere between its ends: {gap}"]
    share, where = numbers["contact_share"], places_of_contact(sol, length)
    touches = f"lies on {100 * share:.3g} % of its length on the wall," if share else "touches the wall"
    said = [f"the rod {touches} {where}; it is {gap}"]
    if sol.point_forces and len(sol.contacts) <= MOST:
        each = ", ".join(f"{plain(value)} {force} at {plain(s)}" for s, value in sol.point_forces)
        said.append(f"point forces of the wall: {each} {length}")
    return said


def places_of_contact(sol: "Solution", length: str) -> str:
    """Where a rod lies on the wall, if it does: ``at s = 0 to 317.1 mm``."""
    if len(sol.contacts) > MOST:
        first, last = sol.contacts[0][0], sol.contacts[-1][1]
        return f"in {len(sol.contacts)} intervals or points from s = {plain(first)} to {plain(last)} {length}"
    return "at s = " + ", ".join(_interval(low, high) for low, high in sol.contacts) + f" {length}"


def _interval(low: float, high: float) -> str:
    return plain(low) if low == high else f"{plain(low)} to {plain(high)}"


def release(before: "Solution", after: "Solution") -> dict[str, Any]:
    """The elastic energy of a rod before and after it was let go [force length]; nothing where one is not solved."""
    if not (before.solved and after.solved):
        return {}
    energies = (sum(float(value) for value in observe(sol, ELASTIC).values()) for sol in (before, after))
    return dict(zip(("before", "after"), energies, strict=True))


def release_sentence(energies: dict[str, float], units: dict[str, str]) -> str:
    """By how much the elastic energy changes, in a sentence. energies: of `release`.

    It may rise: what falls is its sum with the energy of the weight and of loads that are kept.
    """
    unit = f"{units['force']} {units['length']}"
    lost = 1 - energies["after"] / energies["before"] if energies["before"] else 0.0
    digits = min(max(2 - math.floor(math.log10(abs(lost))), 4), 12) if lost else 4  # which show that they differ
    change = f"{'falls' if lost >= 0 else 'rises'} by {100 * abs(lost):.3g} %"
    return (
        f"let go, with both ends as they were: its elastic energy {change}, "
        f"from {plain(energies['before'], digits)} to {plain(energies['after'], digits)} {unit}"
        f"{'; with that of its weight and of kept loads it falls' * (lost < 0)}"
    )
