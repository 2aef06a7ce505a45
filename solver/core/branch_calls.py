"""The numbers of an equilibrium with their rates, and steps along a branch, by the compiled core: `orbit_rates.c`,
`branch_steps.c`."""

import ctypes
from collections.abc import Callable, Generator, Sequence
from typing import Any

import numpy as np

from ..numerics.arrays import Array
from .library import CURVES, FLOAT, INT, TIMES, Cutting, cut, fine, on_grid, points, run, structure

LEFT_TO_CALLER, AT_END, IS_CLOSED, ENOUGH = range(4)  # why the steps end
KINDS = ("saddle", "start", "end")
RECORD = np.dtype(
    [(name, "f8") for name in ("p", "pin", "sign", "y")]
    + [(name, "i8") for name in ("leaving", "turns", "index")]
    + [("numbers", "f8", 6)]
)
NO_ORBIT, INTERRUPTED = 100, 101
RAISED, THERE, NOWHERE = range(3)  # what the core is answered
NUMBERS, PARTS = 11, 5  # of an equilibrium; of a change
RATES = NUMBERS * (PARTS + 2) + 1  # doubles of `orbit_numbers`
_MOST = 256  # records of a call; a longer branch takes several. x10: only memory
_UNKNOWNS, _EQUATIONS = PARTS + 2, PARTS + 1
Numbers = Callable[[float], Sequence[float] | None]


_Question = structure("question", "branch_points.h", numbers=FLOAT * (PARTS + 2))
_PROBLEM = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(_Question))
Level = structure("path", "branches.h")
Chart = structure("chart", "branches.h", at=Level)
_ROW = FLOAT * _UNKNOWNS
Point = structure(
    "point", "branch_points.h", w=_ROW, jacobian=FLOAT * (_EQUATIONS * _UNKNOWNS), tangent=_ROW, chart=Chart
)
_Range = structure("range", "branch_points.h")
_Held = structure("held_ends", "branch_points.h", given=INT * PARTS)
_Curve = structure("curve", "branch_steps.c", problem=_PROBLEM)


def orbit_rates(numbers: Array, path: Any, n: int, how: tuple[Cutting, Cutting]) -> tuple[Array, Array, Array, Array]:
    """The values (11,), rows (11, 5), derivatives by the length (11,), and length () of one equilibrium, no helix.

    NaN where no orbit of the path joins the ends.

    Parameters
    ----------
    numbers : lam, mu, phi, span, beta(0), beta(L)
    path : `boundary.Path`
    n, how
        As of `periodic_orbit.orbits_of`; how panels are cut for the length, and for the orbit.
    """
    out = np.full(RATES, np.nan)
    ways = cut(how[0], TIMES), cut(how[1], CURVES)
    fine(run("rod_orbit_rates", np.ascontiguousarray(numbers), _level_of(path), on_grid(), points(n), *ways, out))
    return split(out)


def start_rates(numbers: Array, pinned: Array | None, n: int, how: Cutting) -> tuple[Array, Array, Array, Array] | None:
    """Values, rows, derivatives and length of the orbit of a start problem, at its far end; y has no value and no row.

    Parameters
    ----------
    numbers : lam, mu, phi, span, beta(0), beta_t(0)
    pinned : array (3,), optional
        An angle, the height of the level above G there, and by how much the log of the true gap is smaller; default:
        beta(0), beta_t(0)^2 and 0.
    n, how
        As of `orbit_rates`; how panels of the orbit are cut.
    """
    out = np.full(RATES, np.nan)
    status = run("rod_start_rates", np.ascontiguousarray(numbers), pinned, on_grid(), points(n), cut(how, CURVES), out)
    return split(out) if fine(status) else None


def split(records: Array) -> tuple[Array, Array, Array, Array]:
    """Values (..., 11), rows (..., 11, 5), derivatives by the length (..., 11) and lengths (...) of (..., `RATES`)."""
    values, rows, by_span, length = np.split(records, np.cumsum([NUMBERS, NUMBERS * PARTS, NUMBERS]), axis=-1)
    return values, rows.reshape(*records.shape[:-1], NUMBERS, PARTS), by_span, length[..., 0]


_CHARTS = np.dtype(
    [("kind", "i4"), ("logarithmic", "i4"), *((name, "f8") for name in ("own", "scale", "nudge")), *RECORD.descr[1:6]]
)
_MOST_CHARTS = 22


def charts(numbers: Array, path: Any) -> list[tuple[str, tuple[Any, ...], float, float, bool]]:
    """The coordinates in which an equilibrium can be followed, the best first: the fields of `charts.Chart`.

    numbers: lam, mu, phi, span, beta(0), beta(L). path: `boundary.Path`, of which those of the charts have the first
    five fields.
    """
    out = np.empty(_MOST_CHARTS, _CHARTS)
    count = run("rod_charts_of", numbers, _level_of(path), on_grid(), out)
    rows = out[:count].tolist()
    return [(KINDS[kind], tuple(at), scale, nudge, bool(log)) for kind, log, _, scale, nudge, *at in rows]


def path_at(numbers: Array, chart: Any, x: float) -> tuple[Any, ...] | None:
    """The fields of the path at x in a chart; None where there is none."""
    at = Level()
    joins = run("rod_chart_path", numbers, chart_of(chart), float(x), on_grid(), at)
    return (at.pin, at.sign, at.y, at.leaving, at.turns) if joins else None


def _level_of(path: Any) -> Any:
    return Level(path.pin, path.sign, path.y, path.leaving, path.turns)


def chart_of(chart: Any) -> Any:
    """A `charts.Chart` as the core reads it."""
    return Chart(KINDS.index(chart.kind), chart.logarithmic, 0.0, chart.scale, chart.nudge, _level_of(chart.at))


def _answers(numbers: Numbers, count: int, raised: list[BaseException]) -> Generator[int, Any, None]:
    """What the core is answered each time it asks for so many numbers of the problem; what ends it is kept as raised.

    Where the core calls a function, a signal such as that of Ctrl-C is raised at its first instruction, before any
    `try` of its own; a generator waits for the next question within one.
    """
    answer = NOWHERE
    try:
        while True:
            question = (yield answer).contents
            values = numbers(question.p)
            answer = NOWHERE if values is None else THERE
            if values is not None:
                question.numbers[:count] = values
    except GeneratorExit:
        return
    except BaseException as error:  # it cannot pass through the core
        raised.append(error)
    yield RAISED


class BranchSteps:
    """Steps along branches over one parameter.

    Parameters
    ----------
    numbers : callable
        Of p, None where there is no problem. Under dead loads lam, mu, phi, span, beta(0) and beta(L); with held ends
        the five given numbers, span and A/C.
    scale : float
        Of p.
    n, how
        As of `periodic_orbit.orbits_of`; how panels are cut for the transit times, and for the orbits.
    held : tuple of int, optional
        The places of the given numbers among those of `orbit_rates`, with held ends.
    """

    def __init__(self, numbers: Numbers, scale: float, n: int, how: tuple[Cutting, Cutting], held: Any = None) -> None:
        self._numbers, self._count = numbers, 7 if held else 6
        self._scale, self._held = scale, held
        self._ways = on_grid(), points(n), cut(how[0], TIMES), cut(how[1], CURVES)

    def _run(self, name: str, *arguments: Any, over: Any = None, held: Any = None) -> int:
        """The status of a function of the core on the branch. Raises what the numbers raise."""
        raised: list[BaseException] = []
        answers = _answers(self._numbers, self._count, raised)
        next(answers)
        problem = _PROBLEM(answers.send)
        status: int = run(name, _Curve(problem, over, held, *self._ways), *arguments)
        if raised:
            raise raised[0]
        if status == INTERRUPTED:
            raise KeyboardInterrupt
        return status

    def excess(self, chart: Any, p: float, x: Array) -> Array | None:
        """The length at each x, at most three, less that of the rod at p; None where there is no such orbit."""
        x, off = np.ascontiguousarray(x), np.empty(x.size)
        failed = self._run("rod_branch_excess", chart, float(p), x.size, x, off)
        return off if failed != NO_ORBIT and fine(failed) else None

    def run(
        self, at: Any, step: float, kept: int, first: Any, most: int, halts: Array, rounding: float, loads: float
    ) -> tuple[Any, Array, float, int, int]:
        """At most so many records from a point, which is replaced by the last one.

        Parameters
        ----------
        at, step, kept
            The point, the length of the next step, and for how many steps its coordinate is kept.
        first : array of RECORD
            The begin of the branch.
        halts : array
            Where to halt, rising, from the lower to the upper end of the range.
        rounding : float
            Below which two values of p are one.
        loads : float
            The scale of the loads, with held ends.

        Returns
        -------
        tuple
            The records; with held ends their numbers and rates, (N, `RATES`); step and kept as they are
            then; and why there are no more.
        """
        over = _Range(self._scale, halts[0], halts[-1], rounding, halts.size, halts)
        out = np.empty(min(most, _MOST), RECORD)
        rates = np.empty((out.size if self._held else 0, RATES))
        length, (keep, count, why) = np.array([step]), np.array([[kept], [0], [0]], np.int64)
        held = _Held((INT * PARTS)(*self._held), loads) if self._held else None
        rest = length, keep, first, out.size, out, rates, count, why
        fine(self._run("rod_branch_steps", at, *rest, over=over, held=held))
        return out[: count[0]], rates[: count[0]], float(length[0]), int(keep[0]), int(why[0])
