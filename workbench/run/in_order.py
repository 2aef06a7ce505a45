"""Rods along one axis in order, kept as soon as they are solved; those on the wall a few at a time.

A rod off the wall is continued from the one before, which takes a half to a fifth of the time of a search.
"""

from collections.abc import Callable
from pathlib import Path

import xarray as xr

from solver import Case, Solution, solve
from studies import Study

from ..stored.case_solving import rule_of, solve_one
from . import dataset_assembly, shards
from .block import block_of, columns
from .plan import plan
from .shards import encode

TOGETHER = 8  # rods on the wall: an interruption loses as many; x10: it loses a film of rods that are slow to solve


def run_in_order(study: Study, folder: Path, step: Callable[[str, int, int], None]) -> xr.Dataset:
    """Solve the cases of a study with one axis of several values, and return its dataset.

    folder: keeps the solved cases, from an earlier call too; those of another study are discarded. It stays until
    `shards.clear`. step: called with the value of the axis, and how many of how many cases are done, before each part.

    Raises
    ------
    InputError
        Where another run is at it, or where a kept case is damaged.
    KeyboardInterrupt
        It says how many are kept.
    """
    work = plan(study)
    (name,) = (name for name, values in work.dimensions.fields.items() if values.size > 1)
    with shards.lock(folder):
        parts = shards.begin(folder, work.recipe, restart=not shards.is_left_over(folder, work.recipe))
        try:
            for first, stop in shards.gaps_between(shards.shard_ranges(folder, work.size), 0, work.size):
                before: Solution | None = None
                for part in work.chunk(first, stop).blocks(1 if study.leaves else TOGETHER):
                    step(f"solving {name} = {part.values[name][0]:.4g}", part.start, work.size)
                    if study.leaves:
                        case, why = study.case_to_solve(part.values)
                        sol = _solution_after(study, case, before)
                        solved = columns(study, sol, part.values, why)
                        before = sol if sol.solved.all() else None
                    else:
                        solved = block_of(study, part)
                    parts.store(part.start, part.stop, encode(solved))
        except KeyboardInterrupt:
            kept = sum(stop - first for first, stop in shards.shard_ranges(folder, work.size))
            kept_in = f"{kept} of {work.size} rods are kept in {folder}"
            raise KeyboardInterrupt(f"interrupted; {kept_in}; run the same command again to continue") from None
        return dataset_assembly.make_as_planned(work, parts.read_cases(0, work.size))


def _solution_after(study: Study, case: Case, before: Solution | None) -> Solution:
    """The rod of a case, from that of the case before where there is one that leads to it; a rod that is let go begins
    on the cylinder."""
    if before is not None and not study.let_go:
        rule = rule_of(study.equilibrium)
        sol = solve(case, study.tol, study.method, study.stations, before, rule)
        if sol.solved.all():
            return sol
    return solve_one(case, study.equilibrium, study.tol, study.method, study.stations, study.let_go)
