"""The same equilibrium with one of its ends held in another way: a displacement in place of its load, or back."""

from dataclasses import replace

import numpy as np

from ..levels.line_point import Path
from ..problem.case import PAIRS, Case
from ..problem.reduced import EndsProblem
from .orbit_rates import NUMBERS, orbit_rates

PARTNER = {name: other for pair in PAIRS for name, other in (pair, pair[::-1])}


def exchange(case: Case, problem: EndsProblem, path: Path, name: str) -> Case:
    """The case with one more field of `Ends` given, at its value in an equilibrium, and its partner left open.

    problem, path: the equilibrium under its dead loads.
    """
    rho, A = float(case.rho), float(case.rod.bending_stiffness)
    rates = orbit_rates(problem, [path])
    number, length = dict(zip(NUMBERS, rates.values[0].tolist(), strict=True)), float(rates.length[0])
    reach = float(case.rod.L)
    values = {
        "beta0": float(problem.beta0[0]),
        "betaL": float(problem.betaL[0]),
        "M10": number["dbeta0"] * A / rho,
        "M1L": number["dbetaL"] * A / rho,
        "FZ": float(problem.phi[0]) * A / rho / rho,
        "MZ": float(problem.lam[0]) * A / rho,
        "M3": float(problem.mu[0]) * A / rho,
        "height": float(np.clip(number["z"] * rho, -reach, reach)),
        "azimuth": float(np.clip(number["alpha"], -reach / rho, reach / rho)),
        "rotation": float(case.rod.stiffness_ratio) * number["mu"] * length - number["swirl"],
    }
    return replace(case, given=replace(case.given, **{PARTNER[name]: None, name: values[name]}))
