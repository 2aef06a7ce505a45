"""Rods that are helices from end to end, which no path of levels reaches: those with held ends, and the bent rods that
they become when the numbers that the ends hold change."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..numerics.arrays import DOUBTFUL, NEGLIGIBLE, Array
from ..numerics.roots import sign_changes
from ..orbits.boundary import DOWN, UP, Boundary, Path, boundary_of, helix_path, nearest_angle, wrap
from ..orbits.potential import Loads, load_size, slope, slope_rate
from ..orbits.variations import HelixVariations
from .given_numbers import FREE, LOADS, Given, OrbitState, answer, parts_of, problem_after, problem_of
from .leaps import Guess
from .orbit_rates import NUMBERS, orbit_rates

# rad: how far from a triple root of H bisection may end, the cube root of rounding and a margin. x10: another helix so
# near a quarter turn is lost
_MULTIPLE = 1e-4
_SCAN = 721  # angles between which those of helices are bracketed: H has few roots. x10: only time


@dataclass(frozen=True)
class _Helix:
    """A helix by its angle and loads; None for a load that can have any value."""

    beta: float
    lam: float | None
    mu: float
    phi: float | None


def helices_of(given: Given) -> tuple[list[OrbitState], bool]:
    """The equilibria that are helices, and whether there is one that is an equilibrium under any load (not listed)."""
    known = dict(zip(given.names, given.values.tolist(), strict=True))
    candidates = [helix for beta in _angles(known, given) if (helix := _helix(beta, known, given)) is not None]
    fixed = [helix for helix in candidates if helix.lam is not None and helix.phi is not None]
    states = [state for helix in fixed if (state := _state(helix, given)) is not None]
    return states, len(fixed) < len(candidates)


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

    def pull(beta: Any) -> Any:
        return slope(Loads(known["lam"], _twist(beta, known, given), known["phi"]), beta)

    def quarter_near(beta: float) -> float:
        """The whole quarter turn beside a root, where it is a root as good: a multiple root has few digits."""
        quarter = np.pi / 2 * round(beta / (np.pi / 2))
        return quarter if abs(quarter - beta) < _MULTIPLE and abs(pull(quarter)) <= abs(pull(beta)) else beta

    grid = np.linspace(-np.pi, np.pi, _SCAN) + 1e-3
    return [quarter_near(beta) for beta in sign_changes(pull, grid, pull(grid)).tolist()]


def _twist(beta: Any, known: dict[str, float], given: Given) -> Any:
    return known["mu"] if "mu" in known else (known["turn"] / given.span + np.sin(beta) * np.cos(beta)) / given.ratio


def _helix(beta: float, known: dict[str, float], given: Given) -> _Helix | None:
    """The helix of an angle with the loads that it needs, None where it has other displacements than the held ones."""
    s, c = float(np.sin(beta)), float(np.cos(beta))
    for name, value in (("z", c), ("alpha", s)):
        if name in known and abs(known[name] - given.span * value) > DOUBTFUL * given.span:
            return None
    mu = float(_twist(beta, known, given))
    lam, phi = known.get("lam"), known.get("phi")
    rest = float(slope(Loads(lam or 0.0, mu, phi or 0.0), beta))  # H is this plus lam c less phi s of the unknown ones
    small = DOUBTFUL * (1 + abs(lam or 0.0) + abs(mu) + abs(phi or 0.0))
    if lam is None and phi is not None and abs(c) > DOUBTFUL:
        return _Helix(beta, -rest / c, mu, phi)
    if phi is None and lam is not None and abs(s) > DOUBTFUL:
        return _Helix(beta, lam, mu, rest / s)
    if lam is None and phi is None:
        return _Helix(beta, None, mu, None)
    return _Helix(beta, lam, mu, phi) if abs(rest) <= small else None


def _state(helix: _Helix, given: Given) -> OrbitState | None:
    loads = {name: load for name in LOADS if (load := getattr(helix, name)) is not None}
    problem = problem_of(given, {**loads, "beta0": helix.beta, "betaL": helix.beta})
    if not np.isfinite(load_size(problem)[0]):
        return None
    path = boundary_of(problem).helix or helix_path(wrap(helix.beta))  # its H has another rounding
    return OrbitState(problem, path, orbit_rates(problem, [path]))


# of the first step, tried in this order: beta_t at an end, changes of angles and loads. x10: not in proportion any
# more, so that a guess leads elsewhere
_SIZES = (2e-2, 2e-3, 2e-4)
_STATIONS = 4001  # at which the turning points are counted. x10: only time; a tenth misses some of long rods


def off_helix(state: OrbitState, wanted: Given) -> Iterator[Guess]:
    """Guesses of the bent rods on the line from a helix to the wanted numbers, and the shares of the line that they
    cover; none where the change leaves beta_t zero at both ends."""
    first = wanted.at(state)
    values, span = wanted.values - first.values, np.array([wanted.span - first.span])
    change = answer(state.rates, first, values[:, None], span)[:, 0]
    parts = parts_of(state.rates, first, values[:, None], span)[:, 0]
    moves = np.abs(change[[NUMBERS.index(name) for name in (*FREE, "dbeta0", "dbetaL")]])
    largest = float(moves.max())
    # where beta_t at both ends changes by a smaller share of the largest change, the rod stays a helix
    if not np.isfinite(largest) or not moves[-2:].max() > NEGLIGIBLE * largest:
        return
    t = np.linspace(0, float(state.problem.span[0]), _STATIONS)
    speeds = HelixVariations(state.problem, held=True).units(t[None]).rate[0] @ parts
    on_saddle = bool(slope_rate(state.problem, state.problem.beta0)[0] < 0)
    for size in _SIZES:
        share = min(1.0, size / largest)
        problem = problem_after(state.problem, first.towards(wanted, share), change, share)
        boundary = boundary_of(problem)
        path = _bent(boundary, share * speeds)
        if on_saddle:
            yield problem, _from_saddle(boundary, path, share * float(speeds[0]), share * float(speeds[-1])), share
        yield problem, path, share


def _bent(boundary: Boundary, speeds: Array) -> Path:
    """The path of a rod that bends a little about a helix; speeds: beta_t along it."""
    signs = np.sign(speeds[1:-1])
    turns = int(np.count_nonzero(np.diff(signs[signs != 0])))
    dbeta0, dbetaL = float(speeds[0]), float(speeds[-1])
    if abs(dbeta0) >= abs(dbetaL):
        path = Path(boundary.start, 1.0, 2 * float(np.log(abs(dbeta0))), UP if dbeta0 > 0 else DOWN, turns)
    else:
        arriving = UP if dbetaL > 0 else DOWN
        path = Path(boundary.end, 1.0, 2 * float(np.log(abs(dbetaL))), arriving if turns % 2 == 0 else -arriving, turns)
    return path


def _from_saddle(boundary: Boundary, path: Path, dbeta0: float, dbetaL: float) -> Path:
    """The path with its level measured from the saddle that a helix lies on.

    With beta_t = k (a exp(k t) - b exp(-k t)) the gap is -4 k^2 a b.
    """
    if not boundary.saddles.size:
        return path
    saddle, _ = nearest_angle(boundary.saddles, boundary.start)
    rate = -float(slope_rate(boundary.problem, np.array([saddle]))[0])
    if rate <= 0:
        return path
    fall = float(np.exp(-np.sqrt(rate) * boundary.problem.span[0]))
    a = fall * (dbetaL - dbeta0 * fall) / (1 - fall * fall)
    gap = -4 * a * (a - dbeta0)
    return Path(saddle, float(np.sign(gap)), float(np.log(abs(gap))), path.leaving, path.turns) if gap else path
