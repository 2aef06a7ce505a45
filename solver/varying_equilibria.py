"""The equilibria of one rod with weight that a search finds, as a list that says so."""

import numpy as np

from .equilibrium_list import Equilibria, Equilibrium, in_order
from .held_equilibria import held_energy, stray
from .observe import observe
from .problem.case import Case, Ends
from .problem.errors import InputError
from .solution import Solution


def varying_equilibria(case: Case, tol: float, stations: int) -> Equilibria:
    """The equilibria that a search finds, lowest energy first. Raises `InputError` for what it does not search."""
    from .problem.reduced import flat
    from .shooting.answers import answer_ends, shape_path
    from .shooting.numbers import rods_of
    from .shooting.search import LONGEST, search

    if not isinstance(case.given, Ends):
        raise InputError(f"equilibria needs a Case with Ends, got {type(case.given).__name__}")
    if case.shape:
        raise InputError(f"equilibria takes one case at a time, got a grid of shape {case.shape}")
    _, (rod,) = rods_of(case)
    if rod.rubbed:
        raise InputError("equilibria of a rod with friction are not searched for; solve gives the one without jumps")
    if rod.held & {"height", "rotation"}:
        raise InputError(
            "with weight equilibria needs FZ and M3, got a held height or rotation; solve gives one of them"
        )
    found = search(rod)
    t = flat(case.rod.L / case.rho, case.shape)[:, None] * np.linspace(0, 1, stations)
    listed = []
    for shape, index, how in zip(found.shapes, found.index, found.how, strict=True):
        path = shape_path(shape, index)
        solution = Solution(case, *answer_ends(case, t, tol, [path]), t, "shooting", tol)
        seen = observe(solution, ["turns", "attached"])
        numbers = held_energy(solution), float(solution.dbeta[0]), int(seen["turns"]), float(seen["attached"])
        listed.append(Equilibrium(solution, index, *numbers, stray(solution), path, -1, how))
    scanned = (
        ", and by a scan of the start" if found.scanned else f"; only rods of at most {LONGEST:g} radii are scanned"
    )
    said = [f"not proved complete: searched from the straight rod, along the weakest modes{scanned}"]
    count = sum((-1) ** index for index in found.index)
    ends = rod.held & {"beta0", "betaL"}
    if ends and "azimuth" not in rod.held:
        wrong = "" if count == 1 else ", so some are missing"
        said.append(f"counted with (-1)^index they add up to {count}, by degree to 1{wrong}")
    return Equilibria(in_order(listed), "; ".join(said))
