"""What the solver returns can be pickled, copied and sent to another process, and reads the same afterwards."""

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, Rod, Solution, Start

from solver import equilibria, fit, fold_curves, follow, loops, observe, solve  # isort: skip

ROD, CYLINDER = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75)
HEAVY = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0, weight=1.0)
METHODS = ("orbit", "swing", "rk4", "euler", "verlet", "dop853", "lsoda")


def start(**more: Any) -> Solution:
    return solve(Case(ROD, CYLINDER, Start(beta=[0.5, 0.7], dbeta=0.5, F1=5.0, F3=10.0)), **more)


def ends(**given: float) -> Solution:
    return solve(Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.8, **given)))


def held_from_seed() -> Solution:
    dead = ends(FZ=-8.66)
    return solve(Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.8, height=4.0)), seed=dead)


def read(value: Any) -> list[Any]:
    """Numbers of a value that need all that it keeps."""
    if isinstance(value, Solution):
        seen = observe(value, ["height", "index", "energy"], errors=True)
        lists = [len(value.alternatives)] if value.held and not value.case.shape else []
        along = [value.gamma.tolist(), value.push.tolist(), value.outcome, *seen.values()]
        return [*map(str, along), *lists]
    if isinstance(value, list):
        return [type(value).__name__, *(read(one) for one in value)]
    if hasattr(value, "points"):
        return [value.index.tolist(), repr(value), [read(point.solution) for point in value.points[::4]]]
    if hasattr(value, "curves"):
        return [value.remark, value.indices_at((-40.0, 2.0)).total()]
    solution = getattr(value, "solution", None)
    return [repr(value), *([] if solution is None else read(solution))]


MAKERS = {
    **{name: partial(start, method=name, tol=1e-3) for name in METHODS},
    "collocation": lambda: solve(Case(ROD, CYLINDER, Ends(beta0=0.5, betaL=0.8)), method="collocation"),
    "dead": partial(ends, FZ=-8.66), "held": partial(ends, height=4.0), "seeded": held_from_seed,
    "unsolved": partial(ends, FZ=1e300),
    "weight, start": partial(solve, Case(HEAVY, CYLINDER, Start(beta=[0.5, 0.7], dbeta=0.5, M3=1.0))),
    "weight, ends": partial(solve, Case(HEAVY, CYLINDER, Ends(beta0=0.5, betaL=0.8, height=4.0))),
    "equilibria": lambda: equilibria(ends(FZ=-8.66).case),
    "branch": lambda: follow(ends(FZ=-8.66), FZ=-12.0),
    "weight, branch": lambda: follow(solve(Case(HEAVY, CYLINDER, Ends(beta0=0.5, betaL=0.8, FZ=-8.66))), FZ=-9.0),
    "held branch": lambda: follow(ends(height=4.0), height=3.8),
    "loops": lambda: loops(Rod(E=1.07e4, nu=0.25, a=0.1, L=10.0), Cylinder(R=0.9), turns_around=1, folds=2),
    "fit": lambda: fit(ends(FZ=-8.66).case, {"FZ": (-10.0, -5.0)}, {"height": 3.9}),
    "sensitivity": lambda: ends(FZ=-8.66).sensitivity(["E", "FZ"], ["height"]),
    "folds": lambda: fold_curves(ends().case, FZ=(-60, -20), L=(1.5, 3), lattice=3),
}  # fmt: skip


@cache
def original(kind: str) -> Any:
    return MAKERS[kind]()


@pytest.mark.parametrize(
    "kind",
    [pytest.param(name, marks=pytest.mark.slow) if name in ("euler", "seeded", "folds") else name for name in MAKERS],
)
@pytest.mark.parametrize("again", [lambda x: pickle.loads(pickle.dumps(x)), copy.copy, copy.deepcopy])
def test_a_copy_reads_as_the_original(kind: str, again: Any) -> None:
    value = original(kind)
    copied = again(MAKERS[kind]() if kind in ("dead", "branch") else value)  # also before anything was read
    assert read(copied) == read(value)


def height(FZ: float) -> Solution:
    return ends(FZ=FZ)


def test_solutions_come_back_from_processes() -> None:
    with ProcessPoolExecutor(2) as pool:
        solutions = list(pool.map(height, (-8.66, -4.0)))
    np.testing.assert_array_equal([s.z[-1] for s in solutions], [height(FZ).z[-1] for FZ in (-8.66, -4.0)])
    assert read(solutions[0]) == read(height(-8.66))


@pytest.mark.slow
def test_solutions_come_back_from_joblib_and_from_dask() -> None:
    dask = pytest.importorskip("dask")
    for solution in dask.compute(*[dask.delayed(height)(FZ) for FZ in (-8.66, -4.0)], scheduler="processes"):
        assert solution.solved
    joblib = pytest.importorskip("joblib")
    for solution in joblib.Parallel(n_jobs=2)(joblib.delayed(height)(FZ) for FZ in (-8.66, -4.0)):
        assert solution.solved
