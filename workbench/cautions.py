"""What a real rod could not do: shapes that solve the equations, told so that nobody takes them for more."""

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from solver import Solution
from solver.observables import observe

if TYPE_CHECKING:  # a worker has no use for it
    import xarray as xr

# what is stored of a case -> what is said of one rod, and of several
TOLD = {
    "too tight": (
        "is bent tighter than its own radius (kappa a > 1)",
        "are bent tighter than their own radius (kappa a > 1)",
    ),
    "overlaps": ("passes through itself", "pass through themselves"),
    "pulled": ("would lift off where the cylinder has to pull", "would lift off where the cylinder has to pull"),
}
SLIGHT, ROUNDING = 1e-6, 1e-13  # of the largest push along the rod, and of A/rho^3: a smaller pull is none


def of_cases(sol: Solution, observed: Mapping[str, Any], look: bool = True, contact: bool = True) -> Any:
    """For each case the keys of `TOLD` that fit it, commas between, (*cases) of str; judged on the stations.

    observed: observables that are known already, by name. Without `look` nothing more is computed than these, and
    `contact` says whether that is known along the rod.
    """
    none = np.zeros(sol.case.shape, dtype=bool)
    tight = meets = pulled = none
    if "kappa_max" in observed:
        tight = np.asarray(observed["kappa_max"] * sol.case.rod.a > 1)
    elif look:
        tight = sol.kappa.max(axis=-1) * sol.case.rod.a > 1
    if "overlaps" in observed or look:
        known = observed if "overlaps" in observed else observe(sol, ["overlaps"])
        meets = np.asarray(known["overlaps"]) == 1
    if contact or look:
        least = SLIGHT * np.abs(sol.push).max(axis=-1) + ROUNDING * sol.case.rod.bending_stiffness / sol.case.rho**3
        pulled = sol.push.min(axis=-1) < -least
    text = np.full(sol.case.shape, "", dtype="U32")
    for key, here in zip(TOLD, (tight, meets, pulled), strict=True):
        here = np.asarray(here) & sol.solved
        text = np.where(here, np.where(text == "", key, np.char.add(np.char.add(text, ", "), key)), text)
    return text


def sentence(ds: "xr.Dataset") -> str:
    """One sentence on the cases that a real rod could not follow; empty where there are none, or none stored."""
    return said(ds["caution"].values) if "caution" in ds else ""


def said(found: Any) -> str:
    """One sentence on the answer of `of_cases`; empty where there is nothing to say."""
    return told(Counter(np.atleast_1d(found).astype(str).ravel().tolist()))


def told(texts: Mapping[str, int]) -> str:
    """The same of how often each text of `of_cases` stands."""
    cases = sum(texts.values())
    counts = {key: sum(count for text, count in texts.items() if key in text) for key in TOLD}
    if not any(counts.values()):
        return ""
    if cases == 1:
        facts = [TOLD[key][0] for key, count in counts.items() if count]
        return f"The rod {_listed(facts)}: no real rod that only rests on the cylinder takes this shape."
    facts = [f"{count} {TOLD[key][min(count - 1, 1)]}" for key, count in counts.items() if count]
    return f"Of {cases} rods {_listed(facts)}: no real rod that only rests on the cylinder takes such shapes."


def _listed(facts: list[str]) -> str:
    return facts[0] if len(facts) == 1 else f"{', '.join(facts[:-1])} and {facts[-1]}"
