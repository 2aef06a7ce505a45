"""A rod that may leave the cylinder, in words: where it lies on the wall, and what letting it go did."""

from typing import TYPE_CHECKING, Any

from solver.observe.observables import observe

if TYPE_CHECKING:
    from solver import Solution

MOST = 6  # intervals of contact that are named one by one
ELASTIC = ("bending_energy", "twist_energy")


def sentences(sol: "Solution", units: dict[str, str]) -> list[str]:
    """Where a rod lies on the wall, and the forces at the edges; none of a rod that the cylinder holds on."""
    if not (sol.case.leaves and sol.solved):
        return []
    length, force = units["length"], units["force"]
    gap = f"up to {sol.gap.max():.4g} {length} off the wall"
    if not sol.contacts:
        return [f"the rod touches the cylinder nowhere between its ends: {gap}"]
    share = float(observe(sol, ["contact_share"])["contact_share"])
    if len(sol.contacts) > MOST:
        first, last = sol.contacts[0][0], sol.contacts[-1][1]
        where = f"in {len(sol.contacts)} intervals or points from s = {first:.4g} to {last:.4g} {length}"
    else:
        where = "at s = " + ", ".join(_interval(low, high) for low, high in sol.contacts) + f" {length}"
    touches = f"lies on {100 * share:.3g} % of its length on the wall," if share else "touches the wall"
    said = [f"the rod {touches} {where}; it is {gap}"]
    if sol.point_forces and len(sol.contacts) <= MOST:
        each = ", ".join(f"{value:.4g} {force} at {s:.4g}" for s, value in sol.point_forces)
        said.append(f"point forces of the wall: {each} {length}")
    return said


def _interval(low: float, high: float) -> str:
    return f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"


def release(before: "Solution", after: "Solution") -> dict[str, Any]:
    """The elastic energy of a rod before and after it was let go [force length]; nothing where one is not solved."""
    if not (before.solved and after.solved):
        return {}
    energies = (sum(float(value) for value in observe(sol, ELASTIC).values()) for sol in (before, after))
    return dict(zip(("before", "after"), energies, strict=True))


def release_sentence(energies: dict[str, float], units: dict[str, str]) -> str:
    """By how much the elastic energy falls, in a sentence. energies: of `release`."""
    unit = f"{units['force']} {units['length']}"
    lost = 1 - energies["after"] / energies["before"] if energies["before"] else 0.0
    return (
        f"let go, with both ends as they were: its elastic energy falls by {100 * lost:.3g} %, "
        f"from {energies['before']:.6g} to {energies['after']:.6g} {unit}"
    )
