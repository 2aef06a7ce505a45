"""What the benchmarks share: a named case, and two things timed in turn."""

import os
import resource
import statistics
import time
from collections.abc import Callable
from math import pi
from typing import Any

from solver import Case, Cylinder, Rod, Start


def table1(L: float = 20.0, E: Any = 1.07e4) -> Case:
    """Table 1 read force-first, in tension, with the paper's stiffness."""
    rod = Rod(E=E, nu=0.25, a=0.25, L=L, stiffness="paper")
    return Case(rod, Cylinder(R=0.75), Start(beta=pi / 6, dbeta=0.5, F1=5.0, F3=10.0))


def compare_times(
    first: Callable[[], object],
    second: Callable[[], object],
    rounds: int,
    calls: tuple[int, int] = (1, 1),
    clock: Callable[[], float] = time.perf_counter,
) -> tuple[float, float, float]:
    """Median seconds of both, run in turn, and the median of their ratios first/second.

    calls: how many of each in a row, whose mean counts: a single call of a tenth of a millisecond finds the caches full
    of what ran before it. clock: that of the processor on a busy machine, where that on the wall says less about calls
    of a millisecond.
    """
    first(), second()
    times = []
    for _ in range(rounds):
        times.append((_seconds(first, calls[0], clock), _seconds(second, calls[1], clock)))
    return (
        statistics.median(a for a, _ in times),
        statistics.median(b for _, b in times),
        statistics.median(a / b for a, b in times),
    )


def _seconds(work: Callable[[], object], calls: int, clock: Callable[[], float]) -> float:
    start = clock()
    for _ in range(calls):
        work()
    return (clock() - start) / calls


def seconds_of_processor(work: Callable[[], object]) -> float:
    """Processor time of this process and of the children that it waited for."""
    before = _processor()
    work()
    return _processor() - before


def _processor() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def peak_gigabytes() -> float:
    """The largest memory of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
