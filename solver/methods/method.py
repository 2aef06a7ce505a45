"""A method: a frozen value whose fields are its knobs, with class attributes that describe it; and its ladder,
the values of one knob, from cheap to dear, for the comparison of accuracy against cost."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from functools import cache, partial
from importlib.util import find_spec
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from ..held.equilibrium_choice import NEAREST, Choose, select_seed
from ..numerics.arrays import Array
from ..orbits.joined_orbits import join_answers
from ..problem.dimensionless import EndsProblem, StartProblem
from ..problem.errors import InputError, choices
from ..problem.outcomes import verdicts
from ..problem.trajectory import Seed, Trajectory

# Evaluations after which a ladder ends: about 0.4 s on the machine of docs/reference/methods.md. Evaluations, not
# seconds, so that a busy machine runs the same rungs. The first limit is for methods that call Python at each one. x10:
# ladders of four seconds
MOST_CALLED, MOST_COMPILED = 20_000, 1_000_000
# tolerance of a step or of a residual: scipy refuses one below 100 eps. x10: a digit less at the end of ladders
TIGHTEST = 3e-14
# cases: 512 take `orbit` 1.4 times as long; a study's own blocks (`workbench.run.plan`) are no larger. x10: memory
BLOCK = 2048
BLOCK_VALUES = 2**20  # stations of all cases of a block, at most: 8 MB an array. x10: 80 MB
_LOOSE = 0.9  # the tolerance of a rung whose knob is another one: only a rung without a digit fails. x10: none does


@dataclass(frozen=True)
class Ladder:
    """A method, the knob that is varied, its values from cheap to dear, and its look in diagrams.

    colour, marker, line: as Matplotlib reads them; bold: whether the line is drawn thicker. label: default: the name of
    the method. fixed: the other knobs. cold: whether the first call at a value is slow (it compiles) and is not timed.
    most: a rung that would take more evaluations is not run.
    """

    method: str
    knob: str
    values: tuple[float, ...]
    colour: str = "black"
    marker: str = "o"
    line: str = "-"
    bold: bool = False
    label: str = ""
    fixed: Mapping[str, Any] = field(default_factory=dict)
    cold: bool = False
    most: float = MOST_CALLED

    @property
    def name(self) -> str:
        """The label, or else the name of the method."""
        return self.label or self.method

    def options(self, value: float) -> dict[str, Any]:
        """The arguments of `solve` on the rung of that value."""
        tol = {} if self.knob == "tol" else {"tol": _LOOSE}
        return {"method": self.method, **tol, **self.fixed, self.knob: value}


def tens(first: int, last: int, step: int = 1) -> tuple[float, ...]:
    """10^-first, ..., 10^-last."""
    return tuple(10.0**-k for k in range(first, last + 1, step))


def twos(last: int, times: int = 1) -> tuple[int, ...]:
    """times 1, 2, 4, ..., 2^last."""
    return tuple(times * 2**k for k in range(last + 1))


TOLERANCES = (*tens(1, 11, 2), 1e-12, 1e-13)


@dataclass(frozen=True)
class Knob:
    """The values that a knob may have: a flag, a whole number of at least `least`, or a number between 0 and 1."""

    kind: type
    least: int = 0

    def accepts(self, value: Any) -> bool:
        """Whether the knob may have this value."""
        if self.kind is bool:
            return isinstance(value, bool)
        if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
            return False
        if self.kind is int:
            return isinstance(value, (int, np.integer)) and bool(value >= self.least)
        return bool(0 < value < 1)

    @property
    def rule(self) -> str:
        """The rule in words."""
        if self.kind is bool:
            return "True or False"
        return f"a whole number of at least {self.least}" if self.kind is int else "a number between 0 and 1"


def knob(kind: type, least: int = 0, default: Any = None) -> Any:
    """A field of a method: a knob, which may also be None."""
    return field(default=default, metadata={"knob": Knob(kind, least)})


@dataclass(frozen=True)
class Method(ABC):
    """What all methods declare. A method extends `StartMethod` or `EndsMethod` and has a row in `METHODS`.

    name: for `solve(case, method=name)`. summary: one line. problems: the kinds of problem that it solves. order: its
    order of convergence; inf: geometric. knows_orbit: whether its trajectories carry the periodic orbit, so that
    observables are exact between stations. batched: whether many problems cost little more than one, so that a study
    solves large blocks. blockwise: whether it needs more memory than its answer, so that `solve` gives it its problems
    in blocks. requires: a package that must be installed, and whose version decides the last bits; extra: the extra of
    rod-workbench that installs it. ladders: for the comparison of accuracy against cost.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    problems: ClassVar[tuple[str, ...]]
    order: ClassVar[float]
    knows_orbit: ClassVar[bool] = False
    batched: ClassVar[bool] = False
    blockwise: ClassVar[bool] = True
    requires: ClassVar[str] = ""
    extra: ClassVar[str] = ""
    ladders: ClassVar[tuple[Ladder, ...]] = ()

    def __post_init__(self) -> None:
        for knob in fields(self):
            value, rule = getattr(self, knob.name), knob.metadata["knob"]
            if value is not None and not rule.accepts(value):
                raise InputError(f"{knob.name} must be {rule.rule}, got {value!r}")

    @classmethod
    def lacks(cls) -> str:
        """What the method needs and does not find, and what to do; empty where it can run."""
        if not cls.requires or _is_found(cls.requires):
            return ""
        return f"the package {cls.requires}, which is not installed: pip install 'rod-workbench[{cls.extra}]'"

    @classmethod
    def is_installed(cls) -> bool:
        """Whether the method can run here."""
        return not cls.lacks()

    @classmethod
    def with_knobs(cls, knobs: dict[str, Any]) -> Self:
        """The method with these knobs. Raises `InputError` for an unknown knob, a bad value or a missing package."""
        if lacks := cls.lacks():
            raise InputError(f"method {cls.name!r} needs {lacks}")
        known = [knob.name for knob in fields(cls)]
        for name in knobs:
            if name not in known:
                raise InputError(f"no knob {name!r} in method {cls.name!r}; its knobs: {choices(known) or 'none'}")
        return cls(**knobs)


# beta, beta_t, alpha, z and swirl of one case at n stations, (5, n); error, condition number, evaluations, and why it
# failed or an empty text
SingleAnswer = tuple[Array, float, float, int, str]


def one_by_one(
    answer: Callable[[int], SingleAnswer], t: Array, tol: float, selection: NDArray[np.object_] | None = None
) -> Trajectory:
    """The answers to B problems at t (B, n), one after the other."""
    columns, numbers = np.empty((5, *t.shape)), np.empty((2, t.shape[0]))
    work, why = np.zeros(t.shape[0], dtype=np.int64), np.empty(t.shape[0], dtype=object)
    for i in range(t.shape[0]):
        columns[:, i], *numbers[:, i], work[i], why[i] = answer(i)
    return trajectory_of(columns, numbers[0], numbers[1], work, tol, why, selection)


def trajectory_of(
    columns: Array, error: Array, condition: Array, work: Any, tol: float, why: Any = "", selection: Any = None
) -> Trajectory:
    """The answer of a method that knows no orbit; columns: (5, B, n), as of `SingleAnswer`."""
    beta, dbeta, alpha, z, swirl = columns
    rest = *verdicts(beta, error, condition, tol).with_failures(why), error, condition, work, None, selection
    return Trajectory(beta, dbeta, alpha, z, partial(np.asarray, swirl), *rest)


def largest(off: Array, reach: Any) -> Array:
    """The largest of beta, and of alpha and z over max(1, reach), in differences of columns (5, ..., n), (...)."""
    most: Array = np.maximum(off[0], np.maximum(off[2], off[3]) / np.maximum(1, reach)).max(axis=-1, initial=0.0)
    return most


def tighten(
    attempt: Callable[[float], tuple[Array, int, str]],
    rounding: Callable[[int], float],
    reach: float,
    tol: float,
    rtol: float | None,
    tightest: float,
    loosest: float = 1e-2,
) -> tuple[Array, float, int, str]:
    """The columns of one case by a method whose tolerance is one of a step; their error, evaluations, and why there are
    none or an empty text.

    A run at thirty times the tolerance is compared, and unless `rtol` gives the tolerance, it is tightened until the
    two agree. attempt: columns at a tolerance, evaluations and why it failed. rounding: an error to be added, of all
    evaluations.
    """
    accuracy = float(np.clip(0.1 * tol if rtol is None else rtol, tightest, loosest))
    coarse, calls, why = attempt(30 * accuracy)
    while not why:  # a tighter run would take longer still
        fine, more, why = attempt(accuracy)
        calls += more
        error = float(largest(np.abs(fine - coarse), reach))
        if why or not np.isfinite(error):
            return fine, np.inf, calls, why
        error += rounding(calls)
        if rtol is not None or error <= tol or accuracy <= tightest:
            return fine, error, calls, ""
        coarse, accuracy = fine, max(tightest, accuracy / 30)
    return coarse, np.inf, calls, why


class StartMethod(Method):
    """A method for start problems."""

    problems = ("start",)

    @abstractmethod
    def run(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        """The answer at the stations t (B, n) in units of rho, rising from 0, the last at most the span."""

    def run_in_blocks(self, problem: StartProblem, t: Array, tol: float) -> Trajectory:
        """The answer to many problems, solved a block at a time and joined.

        A method that solves all its problems together needs several times the memory of its answer. Here it needs that
        for one block only: the rows of a block are moved into the whole answer before the next block is solved.
        """
        B, size = problem.size, max(1, min(BLOCK, BLOCK_VALUES // t.shape[1]))
        if size >= B or not self.blockwise:
            return self.run(problem, t, tol)
        blocks = (slice(k, k + size) for k in range(0, B, size))
        return join_answers((self.run(problem.take(block), t[block], tol) for block in blocks), t, B / size)


class EndsMethod(Method):
    """A method for ends problems."""

    problems = ("ends",)

    @abstractmethod
    def run(
        self, problem: EndsProblem, t: Array, tol: float, seed: Seed | None = None, choose: Choose = NEAREST
    ) -> Trajectory:
        """The answer at the stations t (B, n), as of a start problem; the equilibrium near `seed`, or by `choose`."""


class SeededMethod(EndsMethod):
    """A method for ends problems that finds the solution near a first guess, one case after the other.

    Without a seed it begins next to the equilibrium that the rule `choose` selects.
    """

    @abstractmethod
    def solve_one(self, problem: EndsProblem, t: Array, tol: float, seed: Seed) -> SingleAnswer:
        """The answer to one case at t (n,)."""

    def run(
        self, problem: EndsProblem, t: Array, tol: float, seed: Seed | None = None, choose: Choose = NEAREST
    ) -> Trajectory:
        seeds, taken, why = (seed, None, [""] * problem.size) if seed is not None else select_seed(problem, choose)

        def answer(i: int) -> SingleAnswer:
            near = seeds.take(slice(i, i + 1))
            if np.isfinite(near.beta).all():
                return self.solve_one(problem.take(slice(i, i + 1)), t[i], tol, near)
            return np.full((5, t.shape[1]), np.nan), np.inf, np.inf, 0, why[i] or "failed: the seed has no shape"

        return one_by_one(answer, t, tol, taken)


@cache
def _is_found(package: str) -> bool:
    return find_spec(package) is not None
