"""What a run is, before it starts: its cases in order, their blocks, what identifies it, and how much room it takes."""

import hashlib
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import solver
import studies
from solver import Case, Ends, InputError
from solver.problem.tolerance import checked_tolerance
from studies import Study
from studies.axes import Axis
from studies.laws import Law

from . import sweep, sweep_order
from .block_solver import LOADS, WIDTH, Chunk

FORMAT = 1  # of the file: a reader refuses one with a higher number

Coordinates = Mapping[str, NDArray[np.float64]]

# Cases a block: enough for NumPy to be busy, few enough to stay in the cache; few where each is solved by itself.
BLOCK, BLOCK_ALONE = 512, 32
BLOCK_VALUES = 2**18  # stations of all cases of a block, at most: some MB an array
MOST_BLOCKS, MOST_BYTES = 8, 32 * 2**20  # of a chunk: what a death costs, and what a process holds of it
TEXT_BYTES = 200  # of outcome and caution in the file: their places, and texts with a remark
SPARE = 4 * 2**20  # bytes for coordinates, attributes, half-filled packets and the lists of an HDF5 file


@dataclass(frozen=True, eq=False)
class Plan:
    """A study about to be run: tolerance and method decided, the values of its axes, and which cases are left to do.

    new: flat places in the grid of the cases to be solved, rising; None for all.
    """

    study: Study
    coordinates: Coordinates
    new: NDArray[np.int64] | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(values.size for values in self.coordinates.values())

    @property
    def size(self) -> int:
        """Cases of the grid."""
        return math.prod(self.shape)

    @property
    def todo(self) -> int:
        """Cases to be solved."""
        return self.size if self.new is None else self.new.size

    @cached_property
    def block(self) -> int:
        """Cases solved together; the study alone decides it."""
        if self.study.sweeps:
            return sweep_order.block_size(self.shape, BLOCK_VALUES // self.study.stations)
        most = BLOCK if self.batched else BLOCK_ALONE
        return max(1, min(most, BLOCK_VALUES // self.study.stations))

    @property
    def batched(self) -> bool:
        """Whether the method solves a large block at once."""
        from solver.methods import METHODS

        return METHODS[self.study.method].batched

    @cached_property
    def light(self) -> Study:
        """The study as a worker needs it: without the values of its axes, which come with each chunk."""
        axes = {name: Axis.model_validate({"values": [float(values[0])]}) for name, values in self.coordinates.items()}
        update = {"axes": axes, "laws": [], "observables": self.study.wanted}
        light = self.study.model_copy(update=update)
        light._text, light._part_of = "", None
        return light

    def chunk(self, start: int, stop: int) -> Chunk:
        """The chunk of those cases of the ones to be solved."""
        flat = np.arange(start, stop) if self.new is None else self.new[start:stop]
        if not self.shape:
            return Chunk(start, stop, {})
        places = np.unravel_index(flat, self.shape)
        axes = zip(self.coordinates.items(), places, strict=True)
        values = {name: values[at] for (name, values), at in axes}
        states = self._states(start, stop, values) if self.study.sweeps else {}
        return Chunk(start, stop, values, 0, self.shape, states)

    def _states(self, start: int, stop: int, values: Coordinates) -> dict[int, sweep.State]:
        whole: sweep.Spine | None = self.study.whole
        if whole is None:
            return self.spine.handed(start, stop)
        rows = (dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True))
        return {start + i: whole.nearest(row) for i, row in enumerate(rows)}

    @cached_property
    def spine(self) -> sweep.Spine:
        """The cases of a sweep from which its blocks begin."""
        return sweep.Spine(self.study, self.coordinates, self.block)

    def chunks(self, missing: Iterable[tuple[int, int]], most: int) -> Iterator[Chunk]:
        """The missing stretches in chunks of at most so many cases, each of whole blocks."""
        for start, stop in missing:
            for a in range(start, stop, most):
                yield self.chunk(a, min(a + most, stop))

    def chunk_size(self, workers: int = 1) -> int:
        """Cases a chunk: a few seconds' work, and enough chunks for all workers to be busy."""
        fair = -(-self.todo // self.block) // (4 * workers)
        held = MOST_BYTES // (self.block * bytes_a_case(self.study))
        return self.block * max(1, min(MOST_BLOCKS, fair, held))


def plan(study: Study, tol: float | None = None, method: str | None = None) -> Plan:
    """The plan of a study, with another tolerance or method if given; "auto" becomes the automatic method.

    Raises `InputError` for a tolerance or method that `solve` refuses.
    """
    from solver.methods.automatic import chosen_method

    coordinates = study.coordinates()
    first = study.case_of({name: values[0] for name, values in coordinates.items()})
    if study.follow is not None:  # the equilibrium is followed by its ends, also where the study gives its start
        first = Case(first.rod, first.cylinder, Ends(0.0, 0.0))
    tol = checked_tolerance(study.tol if tol is None else tol)
    name = chosen_method(first.kind, study.method if method is None else method).name
    return Plan(study.model_copy(update={"tol": tol, "method": name}), coordinates)


def first_of(plan: Plan) -> str:
    """How the equilibrium of the first case of a sweep was taken, in one sentence; empty for other studies."""
    if not plan.study.sweeps:
        return ""
    spine = plan.study.whole or plan.spine
    first, cell = spine.first().solution, spine.grid.first
    row = zip(spine.coordinates.items(), cell, strict=True)
    at = ", ".join(sweep.told(name, float(values[i])) for (name, values), i in row)
    which = plan.study.equilibrium
    how = first.selection or (f"taken: the one next to beta'(0) = {which.dbeta0:g}" if which else first.outcome)
    return f"the first case, {at}: {how}"


def bytes_a_case(study: Study) -> int:
    """What a case takes in memory and, at most, in the file."""
    along = sum(WIDTH.get(name, 1) for name in study.outputs) * study.stations
    return 8 * (along + len(study.recorded) + 2 + len(LOADS)) + TEXT_BYTES


def bytes_of_file(plan: Plan) -> int:
    """What the finished file takes at most."""
    return int(1.02 * plan.size * bytes_a_case(plan.study)) + SPARE


def recipe(plan: Plan) -> dict[str, Any]:
    """What the numbers depend on: two runs of the same recipe give the same bits on the same kind of machine."""
    study = plan.study
    return {
        "units": study.unit_system,
        "reading": study.reading or "",
        "base": study.base.given,
        "equilibrium": study.equilibrium.model_dump(exclude_none=True) if study.equilibrium else {},
        "order": list(plan.coordinates),
        "axes": {name: axis_line(values) for name, values in plan.coordinates.items()},
        **({} if study.follow is None else {"follow": {"to": study.follow.limit, "count": study.follow.size}}),
        "stations": study.stations,
        "outputs": sorted(study.outputs),
        "observables": sorted(study.wanted),
        "laws": {str(i): _law_line(law) for i, law in enumerate(study.laws, 1)},  # their verdicts are stored as well
        "tol": study.tol,
        "method": study.method,
        "block": plan.block,
        "code": code_version(),
        **{package: _version(package) for package in ("numpy", "scipy", *_required(study.method))},
    }


def differences(was: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """What two recipes differ in, in words: ``tol was 1e-08, now 1e-09``."""
    told = []
    for key in dict.fromkeys([*was, *now]):
        before, after = was.get(key), now.get(key)
        if isinstance(before, dict) and isinstance(after, dict):
            told += [f"{key}.{one}" for one in differences(before, after)]
        elif before != after:
            told.append(f"{key} was {_told(before)}, now {_told(after)}")
    return told


@cache
def code_version() -> str:
    """The version of the package and a digest of the sources that make the numbers."""
    sources = [*Path(solver.__file__).parent.rglob("*.py"), *Path(studies.__file__).parent.glob("*.py")]
    content = b"".join(path.name.encode() + path.read_bytes() for path in sorted(sources))
    return f"{_version('rod-workbench')}+{_digest(content)}"


def check_worker(study: Study, code: str) -> None:
    """Raise `InputError` where this process would not give the same numbers: other code, or a method it lacks."""
    from solver.methods import available

    if code_version() != code:
        raise InputError(f"a worker has the code {code_version()}, but the run was started with {code}")
    if study.method not in available():
        raise InputError(f"a worker has no method {study.method!r}: install there what is installed here")


def _required(method: str) -> list[str]:
    """The package whose version decides the last bits of a method, if there is one."""
    from solver.methods import METHODS

    return [package] if (package := METHODS[method].requires) else []


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=6).hexdigest()


def axis_line(values: NDArray[np.float64]) -> str:
    """An axis in one line: equal lines, equal values."""
    return f"{values.size} values {values[0]:g}..{values[-1]:g} ({_digest(values.tobytes())})"


def _law_line(law: Law) -> str:
    """All that a law says, in one line."""
    return ", ".join(f"{name} {value}" for name, value in law.model_dump(exclude_defaults=True).items())


def _told(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(map(str, value)) or "none"
    return "not there" if value is None else str(value)
