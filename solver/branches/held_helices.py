"""The rods with held ends that are helices from end to end, which no path of levels reaches."""

from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts are imported when used

from ..equilibrium.orbit_rates import orbit_rates
from ..equilibrium.system import Given, State
from ..levels.line_point import LinePoint
from ..mechanics.potential import TAU, load_size, slope
from ..problem.reduced import EndsProblem

_EQUAL = 1e-11  # relative, of what a helix has and what is given
_SCAN = 721  # angles between which those of helices are bracketed


@dataclass(frozen=True)
class Helix:
    """A helix by its angle and loads; None for a load that can have any value."""

    beta: float
    lam: float | None
    mu: float
    phi: float | None


def helices_of(given: Given) -> tuple[list[State], bool]:
    """The equilibria that are helices, and whether there is one that is an equilibrium under any load (not listed)."""
    known = dict(zip(given.names, given.values.tolist(), strict=True))
    some = [helix for beta in _angles(known, given) if (helix := _helix(beta, known, given)) is not None]
    fixed = [helix for helix in some if helix.lam is not None and helix.phi is not None]
    states = [state for helix in fixed if (state := _state(helix, given)) is not None]
    return states, len(fixed) < len(some)


def helix_at(helix: State, beta: float) -> State:
    """A helix with the whole turns of its angle that are nearest to an angle."""
    turns = TAU * np.round((beta - helix.problem.beta0) / TAU)
    problem = replace(helix.problem, beta0=helix.problem.beta0 + turns, betaL=helix.problem.betaL + turns)
    return replace(helix, problem=problem)


def _angles(known: dict[str, float], given: Given) -> list[float]:
    """The angles that helices may have."""
    if any(known.get(name, 0.0) != 0 for name in ("dbeta0", "dbetaL")):
        return []
    ends = [known[name] for name in ("beta0", "betaL") if name in known]
    if ends:
        return ends[:1] if ends[0] == ends[-1] else []
    for name, inverse, other in (("z", np.arccos, np.negative), ("alpha", np.arcsin, lambda b: np.pi - b)):
        if name in known:
            beta = float(inverse(np.clip(known[name] / given.span, -1, 1)))
            return sorted({beta, float(other(beta))})

    def pull(beta: float) -> float:
        return _slope(beta, known["lam"], _twist(beta, known, given), known["phi"])

    grid = np.linspace(-np.pi, np.pi, _SCAN) + 1e-3
    values = [pull(float(beta)) for beta in grid]
    return [
        float(scipy.optimize.brentq(pull, grid[i], grid[i + 1], xtol=1e-15))
        for i in range(_SCAN - 1)
        if values[i] * values[i + 1] < 0
    ]


def _twist(beta: float, known: dict[str, float], given: Given) -> float:
    if "mu" in known:
        return known["mu"]
    return (known["turn"] / given.span + float(np.sin(beta) * np.cos(beta))) / given.ratio


def _slope(beta: float, lam: float, mu: float, phi: float) -> float:
    problem = EndsProblem(*(np.array([value]) for value in (lam, mu, phi, 1.0, beta, beta)))
    return float(slope(problem, problem.beta0)[0])


def _helix(beta: float, known: dict[str, float], given: Given) -> Helix | None:
    """The helix of an angle with the loads that it needs, None where it has other displacements than the held ones."""
    s, c = float(np.sin(beta)), float(np.cos(beta))
    for name, value in (("z", c), ("alpha", s)):
        if name in known and abs(known[name] - given.span * value) > _EQUAL * given.span:
            return None
    mu = _twist(beta, known, given)
    lam, phi = known.get("lam"), known.get("phi")
    rest = _slope(beta, lam or 0.0, mu, phi or 0.0)  # H is this plus lam c less phi s of the unknown ones
    small = _EQUAL * (1 + abs(lam or 0.0) + abs(mu) + abs(phi or 0.0))
    if lam is None and phi is not None and abs(c) > _EQUAL:
        return Helix(beta, -rest / c, mu, phi)
    if phi is None and lam is not None and abs(s) > _EQUAL:
        return Helix(beta, lam, mu, rest / s)
    if lam is None and phi is None:
        return Helix(beta, None, mu, None)
    return Helix(beta, lam, mu, phi) if abs(rest) <= small else None


def _state(helix: Helix, given: Given) -> State | None:
    numbers = {"lam": helix.lam, "mu": helix.mu, "phi": helix.phi, "beta0": helix.beta, "betaL": helix.beta}
    problem = EndsProblem(**{name: np.array([value]) for name, value in numbers.items()}, span=np.array([given.span]))
    path = LinePoint(problem).helix
    if path is None or not np.isfinite(load_size(problem)[0]):
        return None
    return State(problem, path, orbit_rates(problem, [path]))
