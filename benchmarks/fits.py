"""Whether the intervals of fits hold, and what a fit costs.

Run from the checkout: `.venv/bin/python -m benchmarks.fits` (some minutes; `--repetitions N`). From 50 points of a
known rod with noise, E and M3 are fitted many times; counted is how often the true value lies in its 95 % interval.
Costs are seconds of the processor after all imports. Nothing here is asserted: machines differ.
"""

import argparse
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from solver import Case, Cylinder, Rod, Start, fit, solve

POINTS = 50
NOISE = 0.03  # rad of alpha, cm of z
TRUE = {"E": 1.07e4, "M3": 18.0}
GUESS = {"E": 1e4, "M3": 17.0}


def rod(E: float, M3: float) -> Case:
    """Table 1 in tension with the paper's stiffness, its twist by M3."""
    return Case(
        Rod(E=E, nu=0.25, a=0.25, L=20.0, stiffness="paper"),
        Cylinder(R=0.75),
        Start(beta="30deg", dbeta=0.5, F3=10.0, M3=M3),
    )


def noisy_points(rng: np.random.Generator, with_s: bool) -> dict[str, Any]:
    """Points of the true rod with normal noise."""
    s = np.linspace(20.0 / POINTS, 20.0, POINTS)
    sol = solve(rod(**TRUE), tol=1e-12, stations=s)
    alpha, z = (values + NOISE * rng.standard_normal(POINTS) for values in (sol.alpha, sol.z))
    return {"alpha": alpha, "z": z} | ({"s": s} if with_s else {})


def count_covered(repetitions: int, with_s: bool, sigma: bool) -> dict[str, int]:
    """How often each true value lies in its interval; each repetition has noise of its own."""
    held = dict.fromkeys(TRUE, 0)
    known = {"alpha": NOISE, "z": NOISE} if sigma else None
    for seed in range(repetitions):
        points = noisy_points(np.random.default_rng(seed), with_s)
        found = fit(rod(**GUESS), list(TRUE), points=points, sigma=known, starts=0)
        for name, value in TRUE.items():
            low, high = found.intervals[name]
            held[name] += found.solved and low <= value <= high
    return held


def costs(rounds: int = 15) -> dict[str, tuple[float, float]]:
    """Seconds of the processor of a fit of two fields: the median and the least of some rounds."""
    points = {with_s: noisy_points(np.random.default_rng(0), with_s) for with_s in (True, False)}
    case = rod(**GUESS)

    def of(**options: Any) -> Callable[[], object]:
        return lambda: fit(case, list(TRUE), **options)

    rows = {
        "50 points with s, from the case alone": of(points=points[True], starts=0),
        "50 points with s, and 32 Sobol' points": of(points=points[True]),
        "50 points without s, from the case alone": of(points=points[False], starts=0),
        "50 points without s, and 32 Sobol' points": of(points=points[False]),
        "height and wraps, from the case alone": of(targets={"height": 8.0, "turns_around": 0.2}, starts=0),
        "height and push_max, from the case alone": of(targets={"height": 7.9, "push_max": 150.0}, starts=0),
    }
    found = {}
    for name, work in rows.items():
        work()
        spent = [_seconds(work) for _ in range(rounds)]
        found[name] = statistics.median(spent), min(spent)
    return found


def _seconds(work: Callable[[], object]) -> float:
    """Of the processor; `os.times` counts hundredths, which is too coarse here."""
    begun = time.process_time()
    work()
    return time.process_time() - begun


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    options.add_argument("--repetitions", type=int, default=400)
    options.add_argument("--costs", action="store_true", help="the costs alone")
    options.add_argument("--rounds", type=int, default=15)
    given = options.parse_args()
    for with_s, sigma in ((True, False), (True, True), (False, False), (False, True)) if not given.costs else ():
        held = count_covered(given.repetitions, with_s, sigma)
        kind = f"{'with' if with_s else 'without'} s, sigma {'given' if sigma else 'estimated'}"
        for name, count in held.items():
            share = count / given.repetitions
            error = (share * (1 - share) / given.repetitions) ** 0.5
            print(f"{kind:<32} {name:<3} {100 * share:6.2f} +- {100 * error:.2f} %", flush=True)
    for name, (median, least) in costs(given.rounds).items():
        print(f"{name:<46} {1e3 * median:7.0f} ms, at least {1e3 * least:.0f} ms", flush=True)


if __name__ == "__main__":
    main()
