"""Over the whole range of a float: no exception, no warning, nothing that is not finite in a case called solved.

Quick part: a few thousand seeded cases. `pytest -m slow tests/numerics/test_extremes.py` runs 100,000 of them and
takes some minutes. Six hundred are checked against Taylor series to 25 digits, stored by
benchmarks/make_march_references.py.
"""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver import Case, Cylinder, Ends, InputError, Rod, Solution, Start, solve
from solver.methods import METHODS, available
from solver.problem.case_fields import with_field
from solver.problem.dimensionless import StartProblem
from solver.problem.errors import FAULT
from solver.problem.trajectory import Trajectory
from tests.cases import in_units_of_rho
from tests.extreme_cases import KINDS, draw

REFERENCES = np.load(Path(__file__).parents[1] / "march_references.npz")
TOL = 1e-8
ALONG = ("beta", "dbeta", "alpha", "z", "gamma", "position", "tangent", "kappa", "contact", "F1", "F2", "F3", "h")

# lam, mu, phi, span, beta0, beta_t0: each once brought the method down
ONCE_FATAL = {
    "H only touches zero": (-10.820287450478478, -10.820287450478478, 0.0, 20.0, 0.5, 0.1),
    "at rest where H touches zero": (-10.820287450478478, -10.820287450478478, 0.0, 20.0, 0.0, 0.0),
    "turns at a fold": (85316758.99164146, 85316758.99164146, 4.19e-12, 20244.9, -np.pi, -2.6975905233492718e-06),
    "starts at a fold": (1549106237747.348, 1549106237747.348, -0.16477971541963907, 694.8, 0.0, 2.7e-09),
    "one bit below pi": (1.8e-46, 0.0, -1.3075725558958222, 0.085, 3.1415926535897927, 0.0),
    "the smallest angle": (0.0, 0.0, -31681.26751537264, 11007093.45, -5e-324, 0.0),
    "the smallest load": (5365600742102866.0, -0.006271832964915074, 2.65e-308, 0.0067, -5e-324, 8.6e-08),
}


BOTH = pytest.mark.parametrize("method", [name for name in ("orbit", "swing") if name in available()])


def quietly(case: Any, **more: Any) -> Solution:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return solve(case, **more)


def finite(sol: Solution) -> Any:
    """Whether every number of a case is finite, (*cases)."""
    fine = np.isfinite(sol.error) & (sol.condition >= 1)
    for name in ALONG:
        values = getattr(sol, name).reshape(*np.shape(fine), -1)
        fine &= np.isfinite(values).all(axis=-1)
    return fine


@pytest.mark.parametrize("name", ONCE_FATAL)
def test_orbit_answers_or_says_why_not_next_to_every_degeneracy(name: str) -> None:
    sol = quietly(in_units_of_rho(*ONCE_FATAL[name]))
    assert (sol.solved and finite(sol)) or "failed: " in sol.outcome


def test_a_rod_at_rest_where_G_is_flat_stays() -> None:
    sol = quietly(in_units_of_rho(-3.0, -3.0, 0.0, 20.0, 0.0, 0.0))
    assert sol.solved
    np.testing.assert_array_equal(sol.beta, 0.0)


def test_a_rod_next_to_a_fold_is_solved_and_its_error_is_honest() -> None:
    """Where H and H' vanish together at an end of the axis; against Taylor series to 25 digits."""
    told, off = compared("folds", "orbit")
    assert told.solved.all(), told.outcome
    assert (off <= TOL * told.condition).all()
    assert (told.error >= 0.1 * off - 1e-15).all()  # the last bits of the angle


@BOTH
@pytest.mark.parametrize("side", ("outside", "inside"))
@pytest.mark.parametrize("kind", KINDS)
def test_nearly_every_random_case_that_can_be_is_solved(kind: str, side: str, method: str) -> None:
    with np.errstate(all="ignore"):
        case = draw(250, 1, kind, side)
    sol = quietly(case, stations=17, method=method)
    with np.errstate(all="ignore"):
        assert not (sol.solved & ~finite(sol)).any()
    easy = sol.condition < 1e10
    unsolved = np.count_nonzero(easy & ~sol.solved)
    assert unsolved <= 3, sol.outcome[easy & ~sol.solved]
    assert all(text.startswith("failed: ") for text in sol.outcome[~sol.solved])


# The bar over the whole range: pytest -m slow -s tests/numerics/test_extremes.py.
# Its figures are in docs/reference/methods.md.

BATCH, BATCHES = 1400, 6  # times kinds and sides: 100,800 cases


@pytest.mark.slow
@BOTH
def test_a_hundred_thousand_random_cases_end_well(method: str) -> None:
    """No exception, no warning, nothing non-finite called solved; 99.9 % of those with condition < 1e10 solved."""
    easy = solved = 0
    for kind in KINDS:
        for side in ("outside", "inside"):
            for seed in range(100, 100 + BATCHES):
                with np.errstate(all="ignore"):
                    case = draw(BATCH, seed, kind, side)
                sol = quietly(case, stations=17, method=method)
                with np.errstate(all="ignore"):
                    assert not (sol.solved & ~finite(sol)).any(), (kind, side, seed)
                assert all(text.startswith("failed: ") for text in sol.outcome[~sol.solved])
                can = sol.condition < 1e10
                easy, solved = easy + int(can.sum()), solved + int((can & sol.solved).sum())
    print(f"\n{solved} of {easy} with condition below 1e10 solved: {solved / easy:.5%}")
    assert solved >= 0.999 * easy


@BOTH
def test_no_random_case_called_solved_is_wrong_and_its_error_is_honest(method: str) -> None:
    """Against Taylor series to 25 digits. A tenth of the true error at least, but for the last bit of the angle."""
    ratio, wrong = [], 0
    for kind in KINDS:
        told, off = compared(kind, method)
        assert told.solved.mean() > 0.95, kind
        wrong += int((off > TOL * np.maximum(1, told.condition))[told.solved].sum())
        ratio.append((told.error / np.maximum(off, 1e-15))[told.solved])
    share = np.concatenate(ratio)
    under, over = np.mean(share < 0.1), np.mean(share > 1000)
    print(
        f"\n{share.size} checked, {wrong} wrong; "
        f"error below a tenth of the truth {under:.3%}, above 1000 times {over:.3%}"
    )
    assert wrong == 0
    assert under <= 0.001
    assert over <= 0.05


def compared(kind: str, method: str) -> tuple[Trajectory, Any]:
    """What a method makes of the stored problems of a kind, and its largest error in beta, alpha and z, (n,)."""
    rows = REFERENCES[f"shapes {kind}"]
    problem, true = StartProblem(*rows[:, :6].T), rows[:, 6:].reshape(-1, 3, 4)
    told = METHODS[method]().run(problem, problem.span[:, None] * np.linspace(0, 1, 5), TOL)
    reach = np.maximum(1, problem.span)[:, None]
    parts = zip((told.beta, told.alpha, told.z), (1, reach, reach), strict=True)
    off = [(values[:, 1:] - true[:, k]) / unit for k, (values, unit) in enumerate(parts)]
    return told, np.abs(off).max(axis=(0, 2))


TUBE: dict[str, Any] = {"E": 1e4, "nu": 0.25, "a": 0.25, "L": 5.0}
LEANING: dict[str, Any] = {"R": 0.75, "inclination": 1.0}
WITH_ENDS = {
    "hinged": Case(Rod(**TUBE), Cylinder(0.75), Ends(M10=0.2, betaL=0.3, FZ=-0.5)),
    "held": Case(Rod(**TUBE), Cylinder(0.75), Ends(0.2, 0.3, height=4.0, rotation=0.2)),
    "weight": Case(Rod(**TUBE, weight=0.1), Cylinder(**LEANING), Ends(0.2, 0.3, FZ=-0.5)),
    "hinged, weight": Case(Rod(**TUBE, weight=0.1), Cylinder(**LEANING), Ends(M10=0.2, M1L=0.3, height=4.0)),
    "friction": Case(Rod(**TUBE, weight=0.1), Cylinder(**LEANING, friction=0.3), Start(0.2, 0.3, F3=3.0, M3=0.2)),
}


@pytest.mark.parametrize("name", WITH_ENDS)
def test_a_length_at_the_limits_of_the_floats_has_a_finite_answer_or_a_reason(name: str) -> None:
    case, wrong = WITH_ENDS[name], []
    for field in ("a", "L", "R"):
        for value in (1e200, -1e200, 1e-154):
            try:
                there = with_field(case, field, value)
            except InputError:
                continue
            sol = quietly(there, stations=5)
            if ("failed: " not in sol.outcome and not finite(sol)) or FAULT in sol.outcome:
                wrong.append((field, value, sol.outcome))
    assert not wrong
