"""Numbers that no caller should give the compiled core: it must neither crash nor touch what is not its own.

`.ci/run` runs this file again with a library that checks every access (AddressSanitizer) and every operation of C that
is not defined (UndefinedBehaviorSanitizer).
"""

import numpy as np
import pytest

from solver.core.library import run
from solver.methods import SwingTaylor
from solver.orbits.marched_orbit import LOST, Steps, march, march_with_steps
from solver.problem.dimensionless import StartProblem

ODD = np.array([0, -0.0, 1e300, -1e300, 1e-300, 5e-324, np.inf, -np.inf, np.nan, 1, -1, np.pi, 1e16, 1e-16, 1e6, -1e8])


def odd(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """A quarter of odd numbers, a third of ordinary ones, and others over fifty decades."""
    size = rng.choice([-1.0, 1.0], shape) * np.exp(rng.uniform(-0.5, 0.5, shape) * rng.choice([6, 120], shape))
    return np.where(rng.random(shape) < 0.25, rng.choice(ODD, shape), size)


def read(orbits: np.ndarray, steps: Steps, t: np.ndarray) -> np.ndarray:
    """alpha and z (2, N, n) at t (N, n) of the stored steps, as the search of self-contact reads them."""
    out = np.empty((2, *t.shape))
    for i in range(len(t)):
        run("rod_read", i, orbits, steps.as_room(), t.shape[1], t[i], *out[:, i], 1)
    return out


@pytest.mark.parametrize("seed", range(8))
def test_odd_numbers_end_in_an_answer_or_in_a_lost_orbit(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solver.orbits.marched_orbit._STEPS", (1, 32)[seed % 2])  # too little room is found out
    rng = np.random.default_rng(seed)
    for _ in range(40):
        size, n = rng.integers(0, 40), rng.integers(0, 60)
        problems = odd(rng, size, 6)
        with np.errstate(all="ignore"):
            t = problems[:, 3:4] * np.linspace(0, 1, n)
        t = np.where(rng.random(t.shape) < 0.02, rng.choice(ODD, t.shape), t)
        tol = float(10 ** rng.uniform(-20, 0))
        told = []
        for lanes in (1, 2, 8):
            out, swirl = np.zeros((4, size, n)), np.zeros((size, n))
            orbits = march(problems, tol, t, out, swirl, lanes=lanes)
            again = read(*march_with_steps(problems, tol, t, lanes=lanes), t)
            found = orbits["status"][:, 0] != LOST
            np.testing.assert_array_equal(again[:, found], out[2:, found])
            assert (orbits["error"][found] >= 0).all()
            told.append((orbits.tobytes(), out, swirl))
        for other in told[1:]:
            assert other[0] == told[0][0]
            np.testing.assert_array_equal(other[1], told[0][1])
            np.testing.assert_array_equal(other[2], told[0][2])


def test_a_refused_problem_leaves_its_neighbours_alone() -> None:
    rng = np.random.default_rng(4)
    rows = np.where(rng.random((200, 1)) < 0.3, odd(rng, 200, 6), rng.uniform(0.1, 2, (200, 6)))
    fine = (np.abs(rows) < 3).all(axis=1) & (rows[:, 3] > 0.01)
    together = march(rows, 1e-9, np.empty((200, 0)))
    alone = march(rows[fine], 1e-9, np.empty((int(fine.sum()), 0)))
    assert together[fine].tobytes() == alone.tobytes()


def test_numbers_beyond_the_range_are_told_in_a_sentence() -> None:
    rows = np.array([(1e200, 0, 0, 5.0, 0.3, 0.1), (np.nan, 0, 0, 5.0, 0.3, 0.1), (0.1, 0, 0, 1e-300, 0.3, 0.1)])
    told = SwingTaylor().run(StartProblem(*rows.T), rows[:, 3:4] * np.linspace(0, 1, 5), 1e-9)
    assert not told.solved.any()
    assert all("beyond 1e100" in text for text in told.outcome)
