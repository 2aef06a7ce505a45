"""A rod that may leave the cylinder, in words: where it lies on the wall, and what letting it go did."""

import math
from collections.abc import Mapping, Sequence
from decimal import ROUND_UP, Context
from typing import TYPE_CHECKING, Any

import numpy as np

from solver.observe.free_numbers import errors_of_contacts
from solver.observe.observables import observe
from studies.laws.law_kinds import with_error

from .unit_habits import intervals, plain, within

if TYPE_CHECKING:
    from solver import Solution

MOST = 6  # intervals of contact that are named one by one
ERROR = "±"  # between a number and its error
ELASTIC = ("bending_energy", "twist_energy")


def sentences(sol: "Solution", units: dict[str, str]) -> list[str]:
    """Where a rod lies on the wall, and the forces at the edges; none of a rod that the cylinder holds on."""
    if not (sol.case.leaves and sol.solved):
        return []
    length, force = units["length"], units["force"]
    numbers = {name: float(value) for name, value in observe(sol, ["gap_max", "contact_share"], errors=True).items()}
    held = hinges_on_wall(sol, f"{force} {length}")
    gap = f"up to {amount(numbers['gap_max'], numbers['gap_max_error'])} {length} off the wall"
    gap = gap.removeprefix("up to ") if gap.startswith("up to less") else gap
    if not sol.contacts:
        return [f"the rod touches the cylinder nowhere between its ends: {gap}", *held]
    share, where = numbers["contact_share"], places_of_contact(sol, length)
    percent = amount(100 * share, 100 * numbers["contact_share_error"])
    touches = f"lies on {percent} % of its length on the wall," if share else "touches the wall"
    said = f"the rod {touches} {where}" + f"; it is {gap}" * (numbers["gap_max"] > 0)
    return [said, *forces_in_words(sol, units), *held]


def hinges_on_wall(sol: "Solution", unit: str) -> list[str]:
    """Of each hinge that its given M2 presses into the wall, the moment of the rod there: the wall takes the rest."""
    rod, said = sol.trajectory.free.answers[0].shapes[-1].rod, list[str]()
    for k, (where, field) in enumerate((("start", "M20"), ("far end", "M2L"))):
        given = getattr(sol.case.given, field)
        if given is not None and not rod.free[4 * k + 2]:
            moment = f"M2 of the rod is {plain(float(sol.M2[-k]), 3)} {unit} there, not {plain(float(given), 3)}"
            said.append(f"the wall holds the hinge at the {where} along it: {moment}, as the wall takes the rest")
    return said


def places_of_contact(sol: "Solution", length: str) -> str:
    """Where a rod lies on the wall, if it does: ``at s = 0 to 317.1 mm``."""
    each = [(_place(sol, low), _place(sol, high)) for low, high in sol.contacts]
    if len(each) > MOST:
        return f"in {len(each)} intervals or points from s = {each[0][0]} to {each[-1][1]} {length}"
    return intervals(each, length)


def forces_in_words(sol: "Solution", units: Mapping[str, str]) -> list[str]:
    """The point forces of the wall in a sentence, of more than `MOST` those that are larger than their errors, and how
    many are not; none without any."""
    errors, each = _errors_of_forces(sol), point_forces(sol)
    rows, few = zip(each, sol.point_forces, errors, strict=True), len(each) <= MOST
    known = [words for words, (_, size), error in rows if few or size > error]
    said = [", ".join(f"{size} {units['force']} at {s}" for s, size in known) + f" {units['length']}"] * bool(known)
    others = len(each) - len(known)
    said += [f"{others} {'more ' * bool(known)}no larger than {'its error' if others == 1 else 'their errors'}"]
    return [f"point forces of the wall: {'; '.join(said[: None if others else -1])}"] * bool(each)


def point_forces(sol: "Solution") -> list[tuple[str, str]]:
    """Where each point force of the wall acts, and its size, in the digits that their errors allow."""
    said = amounts([force for _, force in sol.point_forces], _errors_of_forces(sol))
    return [(_place(sol, s), words) for (s, _), words in zip(sol.point_forces, said, strict=True)]


def _errors_of_forces(sol: "Solution") -> list[float]:
    """The estimated error of each point force of the wall [force]."""
    unit = float(sol.case.rod.bending_stiffness) / float(sol.case.rho) ** 2
    return [error_beside(sol, s, 1) * unit for s, _ in sol.point_forces]


def _place(sol: "Solution", s: float) -> str:
    """Where a contact begins or ends: an end of the rod, or in the digits that the error allows."""
    shortest = min((high - low for low, high in sol.contacts if high > low), default=math.inf)
    return _known_to(s, error_beside(sol, s, 0) * float(sol.case.rho) * (0 < s < float(sol.case.rod.L)), shortest)


def amount(value: float, error: float, digits: int = 4) -> str:
    """A number that is never negative as `_known_to`, or, where its error is larger than itself, ``less than 1.6``."""
    if value < error < math.inf:
        bound = Context(prec=2, rounding=ROUND_UP).create_decimal(repr(float(value + error)))
        return f"less than {plain(float(bound))}"
    return _known_to(value, error, value, digits)


def amounts(values: Sequence[float], errors: Sequence[float]) -> list[str]:
    """Numbers of one kind, each as `amount`; where one needs its error, all that are larger than theirs have it."""
    pairs = [*zip(values, errors, strict=True)]
    each = [amount(value, error) for value, error in pairs]
    if not any(ERROR in words for words in each):
        return each
    return [
        words if value < error else with_error(value, error) for words, (value, error) in zip(each, pairs, strict=True)
    ]


def _known_to(value: float, error: float, size: float, digits: int = 4) -> str:
    """A number as `within`; with its error, ``60 ± 24``, where that rounding might change a size by its own amount.

    size: of the number itself, or of a stretch that begins or ends there.
    """
    return with_error(value, error) if size < 10 * error < math.inf else within(value, error, digits)


def error_beside(sol: "Solution", s: float, kind: int, k: int = 0) -> float:
    """The estimated error of where a contact begins or ends that does so nearest to s, in units of rho.

    kind: 1 instead of 0 for that of the point force there, in units of A and rho. k: the place of the case in a grid.
    """
    errors = errors_of_contacts(sol.trajectory.free.answers[k].shapes)[kind]
    contacts = sol.contacts.ravel()[k] if sol.case.shape else sol.contacts
    return float(errors.ravel()[np.abs(np.ravel(contacts) - s).argmin()])


def length_error(sol: "Solution") -> float:
    """The estimated error of the length on the wall [length]."""
    return float(observe(sol, ["contact_share"], errors=True)["contact_share_error"]) * float(sol.case.rod.L)


def release(before: "Solution", after: "Solution") -> dict[str, Any]:
    """The elastic energy of a rod before and after it was let go [force length]; nothing where one is not solved."""
    if not (before.solved and after.solved):
        return {}
    energies = (sum(float(value) for value in observe(sol, ELASTIC).values()) for sol in (before, after))
    return dict(zip(("before", "after"), energies, strict=True))


def release_sentence(energies: dict[str, float], units: dict[str, str]) -> str:
    """By how much the elastic energy changes, in a sentence. energies: of `release`.

    It may rise: at a minimum, its sum with the energy of the weight and of kept loads is least.
    """
    unit = f"{units['force']} {units['length']}"
    lost = 1 - energies["after"] / energies["before"] if energies["before"] else 0.0
    digits = min(max(2 - math.floor(math.log10(abs(lost))), 4), 12) if lost else 4  # which show that they differ
    change = f"{'falls' if lost >= 0 else 'rises'} by {100 * abs(lost):.3g} %"
    return (
        f"let go, with both ends as they were: its elastic energy {change}, "
        f"from {plain(energies['before'], digits)} to {plain(energies['after'], digits)} {unit}"
        f"{'; what is least is its sum with that of its weight and of kept loads' * (lost < 0)}"
    )
