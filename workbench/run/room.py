"""The disk space that a run needs."""

from pathlib import Path

from solver.problem.errors import InputError

from . import shards
from .plan import Plan, bytes_a_case, bytes_of_file

TOLD = 1e9  # bytes: what needs less is not told


def room(work: Plan, folder: Path, kept: int) -> str:
    """The disk space that the run needs, in words; raises `InputError` where there is less."""
    case = bytes_a_case(work.study)
    final, parts = bytes_of_file(work), max(work.todo - kept, 0) * case
    there = shards.free(folder)
    if final + parts > there:
        needed = f"{_bytes(final)} for the file and {_bytes(parts)} for its parts until it is whole"
        raise InputError(f"the study needs up to {needed}, but {folder.parent} has {_bytes(there)} left")
    new = f", {work.size - work.todo} of them already stored" if work.todo < work.size else ""
    going = f", {kept} kept from an earlier run" if kept else ""
    if work.study.refine is not None:
        grid = f"{work.study.coarse().size} cases of the coarse grid"
        return (
            f"{grid}, at most {work.study.refine.budget} in all{new and f', {work.size} of them already stored'}{going}"
        )
    large = f"; the file needs at most {_bytes(final)}, and the run another {_bytes(parts)} until it ends"
    return f"{work.size} case{'s' * (work.size != 1)}{new}{going}{large if final + parts > TOLD else ''}"


def _bytes(count: int) -> str:
    for unit, size in (("GB", 1e9), ("MB", 1e6)):
        if count >= size:
            return f"{count / size:.3g} {unit}"
    return f"{count / 1e3:.3g} kB"
