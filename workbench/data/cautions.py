"""Cautions: shapes that solve the equations but are not physically realisable.

Like the observables they are judged on the whole rod, whatever its stations and whatever is stored.
"""

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from solver import Solution
from solver.observe.observables import error_name, observe

if TYPE_CHECKING:  # workers do not need it
    import xarray as xr

UNKNOWN = "not checked: "
# key stored of a case -> words for one rod, and for several
TOLD = {
    "too tight": (
        "is bent tighter than its own radius (kappa a > 1)",
        "are bent tighter than their own radius (kappa a > 1)",
    ),
    "overlaps": ("passes through itself", "pass through themselves"),
    "pulled": ("would lift off where the cylinder has to pull", "would lift off where the cylinder has to pull"),
}
UNTOLD = (f"{UNKNOWN}curvature", f"{UNKNOWN}self-contact", f"{UNKNOWN}lift-off")  # keys where it is unknown
SLIGHT, ROUNDING = 1e-6, 1e-13  # of the largest push along the rod, and of A/rho^3: a smaller pull is none
JUDGED = ("kappa_max", "overlaps", "push_min", "push_max")  # the observables that a caution is made of


def of_cases(sol: Solution, observed: Mapping[str, Any] | None = None) -> Any:
    """For each case the keys of `TOLD` and `UNTOLD` that fit it, commas between, (*cases) of str.

    "" means that the rod was checked and is free of all three, or that the case is not solved. "not checked" means that
    the method knows no orbit and its stations are too few, or that two stretches of the rod are so close over such a
    length that the search for self-contact was abandoned. observed: observables already known, with their errors, by
    name.
    """
    known = dict(observed or {})
    needed = [*JUDGED, *(error for name in JUDGED if (error := error_name(name)))]
    missing = dict.fromkeys(name.removesuffix("_error") for name in needed if name not in known)
    known = {**observe(sol, missing, errors=True), **known}
    tight, free = _tight(sol, known)
    meets = np.asarray(known["overlaps"], dtype=float)
    pulled, held = _pulled(sol, known)
    facts = (
        *zip(TOLD, (tight, meets == 1, pulled), strict=True),
        *zip(UNTOLD, (~(tight | free), ~np.isfinite(meets), ~(pulled | held)), strict=True),
    )
    text = np.full(sol.case.shape, "", dtype="U120")
    for key, here in facts:
        here = np.asarray(here) & sol.solved
        text = np.where(here, np.where(text == "", key, np.char.add(np.char.add(text, ", "), key)), text)
    return text


def _tight(sol: Solution, known: Mapping[str, Any]) -> tuple[Any, Any]:
    """Whether kappa a > 1 somewhere, and whether it surely is nowhere, (*cases)."""
    told = np.isfinite(known["kappa_max_error"])
    most = np.asarray(known["kappa_max"]) if told.all() else np.where(told, known["kappa_max"], sol.kappa.max(axis=-1))
    bend = most * sol.case.rod.a
    return bend > 1, (bend <= 1) & told


def _pulled(sol: Solution, known: Mapping[str, Any]) -> tuple[Any, Any]:
    """Whether the cylinder would have to pull somewhere, and whether it surely does nowhere, (*cases)."""
    told = np.isfinite(known["push_min_error"])
    low, high = np.asarray(known["push_min"]), np.asarray(known["push_max"])
    if not told.all():  # the stations are all there is
        low, high = np.where(told, low, sol.push.min(axis=-1)), np.where(told, high, sol.push.max(axis=-1))
    largest = np.maximum(np.abs(low), np.abs(high))
    with np.errstate(all="ignore"):  # on a very large cylinder rho^3 overflows
        unit = sol.case.rod.bending_stiffness / np.asarray(sol.case.rho, dtype=float) ** 3
        least = SLIGHT * largest + ROUNDING * unit
    known = np.maximum(largest, unit) > np.finfo(float).tiny  # else the push has underflowed, and its sign is lost
    return (low < -least) & known, (low >= -least) & told & known


def keys(text: str) -> list[str]:
    """The keys of `TOLD` and `UNTOLD` in the answer of `of_cases` for one case."""
    return [key for key in text.split(", ") if key]


def holding(found: Any, key: str) -> Any:
    """Whether a key is among those of each case in the answer of `of_cases`, (*cases) of bool."""
    texts = np.asarray(found)
    each = texts.astype(str).ravel().tolist()
    there = {text: key in keys(text) for text in set(each)}
    return np.array([there[text] for text in each], dtype=bool).reshape(texts.shape)


def phrase(key: str) -> str:
    """What a key says of one rod: "passes through itself"."""
    return TOLD[key][0] if key in TOLD else f"was not checked for {key.removeprefix(UNKNOWN)}"


def sentence(ds: "xr.Dataset") -> str:
    """One sentence on the cases that are not physically realisable; empty where there are none, or none stored."""
    return said(ds["caution"].values) if "caution" in ds else ""


def said(found: Any) -> str:
    """One sentence on the answer of `of_cases`; empty where there is nothing to say."""
    return told(Counter(np.atleast_1d(found).astype(str).ravel().tolist()))


def told(texts: Mapping[str, int]) -> str:
    """The same of how often each text of `of_cases` stands."""
    cases = sum(texts.values())
    counts = {key: sum(count for text, count in texts.items() if key in keys(text)) for key in (*TOLD, *UNTOLD)}
    return " ".join(part for part in (_impossible(cases, counts), _unknown(cases, counts)) if part)


def _impossible(cases: int, counts: Mapping[str, int]) -> str:
    found = {key: counts[key] for key in TOLD if counts[key]}
    if not found:
        return ""
    if cases == 1:
        facts = [TOLD[key][0] for key in found]
        return f"The rod {_listed(facts)}: this shape is not physically realisable."
    facts = [f"{count} {TOLD[key][min(count - 1, 1)]}" for key, count in found.items()]
    return f"Of {cases} rods {_listed(facts)}: such shapes are not physically realisable."


def _unknown(cases: int, counts: Mapping[str, int]) -> str:
    found = {key.removeprefix(UNKNOWN): counts[key] for key in UNTOLD if counts[key]}
    if not found:
        return ""
    if cases == 1:
        return f"The rod was not checked for {_listed(list(found))}."
    return f"Not checked: {_listed([f'{count} of {cases} for {what}' for what, count in found.items()])}."


def _listed(facts: list[str]) -> str:
    return facts[0] if len(facts) == 1 else f"{', '.join(facts[:-1])} and {facts[-1]}"
