"""From a case whose loads vary along the rod to numbers in units of A and rho."""

import numpy as np

from ..core.varying_loads import SIZE
from ..numerics.arrays import Array
from ..problem.case import Case
from ..problem.reduced import StartProblem, dimensionless_problem, flat, held_problem
from .loaded_rod import ALPHA, BETA, HELD, MU, PHI, SPEED, LoadedRod, Q, rate_of_change, scales


def numbers_of(case: Case) -> Array:
    """The numbers of each rod as `core.varying_loads.march` takes them, (B, 7)."""
    A, rho, wall = np.asarray(case.rod.bending_stiffness), np.asarray(case.rho), case.cylinder
    theta = 0.0 if wall.inclination is None else wall.inclination
    sign, way = wall.sense
    with np.errstate(all="ignore"):  # overflow is reported in the outcome
        omega = (0.0 if case.rod.weight is None else case.rod.weight) * rho**3 / A
        # sines of both halves of the circle, so that a rod that lies feels no weight along it
        along, across = omega * np.sin(np.pi / 2 - theta), omega * np.sin(theta)
        rubbed = sign * (0.0 if wall.friction is None else wall.friction)
        columns = (case.rod.stiffness_ratio, along, across, rubbed, float(way), case.rod.a / rho, case.outward)
        return np.stack([flat(column, case.shape) for column in columns], axis=1)


def starts_of(case: Case) -> tuple[StartProblem, Array, Array, Array]:
    """The start problems of a case, its numbers (B, 7), the states at the start and their scales, (B, 8) each."""
    problem, numbers = dimensionless_problem(case), numbers_of(case)
    assert isinstance(problem, StartProblem)
    y = np.zeros((problem.size, SIZE))
    y[:, BETA], y[:, SPEED], y[:, ALPHA] = problem.beta0, problem.dbeta0, flat(case.given.alpha, case.shape)
    y[:, Q], y[:, PHI], y[:, MU] = problem.lam - problem.mu, problem.phi, problem.mu
    rate = rate_of_change(problem.phi, numbers[:, 1], numbers[:, 2], problem.mu, y[:, Q], problem.span)
    scale = np.stack(scales(rate, np.minimum(1, np.maximum(rate, np.abs(problem.beta0)))), axis=1)
    scale[:, SPEED] = np.maximum(scale[:, SPEED], np.abs(problem.dbeta0))
    return problem, numbers, y, scale


def rods_of(case: Case) -> list[LoadedRod]:
    """The ends problems of a case, one by one."""
    problem, numbers = held_problem(case), numbers_of(case)
    alpha0 = flat(case.given.alpha, case.shape)
    held = frozenset(problem.given) & HELD
    rods = []
    for i in range(problem.size):
        values = dict(zip(("beta0", "betaL", "axial", "round", "twist"), problem.values[i], strict=True))
        near = np.array([values["beta0"], alpha0[i]])
        far = np.array([values["betaL"], values["round"], values["axial"], values["twist"]])
        rods.append(LoadedRod(numbers[i], float(problem.span[i]), held, near, far))
    return rods
