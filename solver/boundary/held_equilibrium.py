"""One equilibrium of each of B problems with held ends, as a trajectory: from a seed, or from a dead-load equilibrium.

Without a seed the start is an equilibrium under dead loads: guesses of the unknown loads and end angles give some
dead-load problems; of their equilibria with few turning points those are tried first whose displacements are nearest to
the held ones. The start that is taken is the first that leads to a stable equilibrium, or else the first that leads to
any. There may be other equilibria.
"""

from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from ..mechanics.potential import load_size
from ..numerics.arrays import Array
from ..orbit.periodic_orbit import Orbit
from ..orbit.variations import changed
from ..problem.held_ends import HeldProblem
from ..problem.limits import LARGEST, SHORTEST, TOO_LARGE
from ..problem.reduced import EndsProblem
from ..problem.trajectory import PLAIN, Seed, Trajectory, verdicts
from .branch_coordinates import LinePoint, Path, charts, coordinate, path_at, path_of
from .each_equilibrium import path_of_seed, together
from .held_continuation import Stopped, carried, state_of
from .held_index import dead_index, held_index
from .held_system import FREE, Given, State, corrected, parts_of, values_of
from .orbit_rates import orbit_rates, varied_orbits
from .path_orbits import orbit_of
from .search import search
from .stability import jacobi_zeros

_TRIED, _REACHED = 8, 3  # starts from which continuation is tried; equilibria after which it ends
_SLOW = 1e-3  # beta_t at a start
_AT_REST = 1e-11  # beta_t below which a hinge is at rest
_UNSTABLE = 0.3  # what a negative direction of a start adds to its distance
_BESIDE = 1e-4  # a small moment, in units of A/rho
_STEPS = 60  # from each of them
_MOST_TURNS = 2  # of the starts
_STATIONS = 129  # at which the response to the given numbers is read
SEED = "the seed"


@dataclass(frozen=True, eq=False)
class Reached:
    """An equilibrium under held ends, and what its continuation began from, in words."""

    state: State
    begun: str


def from_seed(wanted: Given, problem: EndsProblem, path: Path | None) -> Reached | str:
    """The equilibrium on the branch of a seed, an equilibrium of `problem`; or the outcome that says why not."""
    if path is None:
        return "failed: the seed is not a solution of its own ends problem"
    if path.helix:
        return "failed: the seed is a helix, from which no branch of bent rods is followed; give a bent seed"
    found = carried(state_of(problem, path), wanted)
    return told(found) if isinstance(found, Stopped) else Reached(found, SEED)


def told(found: Stopped) -> str:
    """The outcome of a continuation that stopped."""
    return (
        f"failed: the branch of the start could not be followed to the held ends: {found.reason} "
        f"after {found.share:.2%} of the way"
    )


def nearest_start(wanted: Given, problem: HeldProblem) -> Reached | str:
    """The equilibrium reached from the nearest dead-load equilibria; or the outcome that says why there is none."""
    starts = _starts(wanted, problem)
    reached: list[Reached] = []
    why = "failed: no dead-load equilibrium was found to start from"
    for start in starts[:_TRIED]:
        found = carried(start, wanted, _STEPS)
        if isinstance(found, Stopped):
            why = why if not why.endswith("start from") else told(found)
            continue
        reached.append(Reached(found, _said(start)))
        if index_of(found, wanted) == 0:
            return reached[-1]
        if len(reached) == _REACHED:
            break
    return reached[0] if reached else f"{why}; {min(len(starts), _TRIED)} starts were tried, a seed may help"


def _said(start: State) -> str:
    """The start in words, in units of rho."""
    p = start.problem
    numbers = {"FZ rho^2/A": p.phi, "MZ rho/A": p.lam, "M3 rho/A": p.mu, "beta(0)": p.beta0, "beta(L)": p.betaL}
    index = int(jacobi_zeros(orbit_of(p, start.path))[0])
    return f"the dead-load equilibrium of index {index} with " + ", ".join(
        f"{name} = {float(value[0]):.6g}" for name, value in numbers.items()
    )


def _starts(wanted: Given, problem: HeldProblem) -> list[State]:
    """Dead-load equilibria, that with the nearest displacements first."""
    found: list[tuple[float, State]] = []
    for numbers in _guesses(wanted, problem):
        guess = EndsProblem(**{name: np.array([numbers[name]]) for name in FREE}, span=problem.span)
        every = search(guess, most_turns=_MOST_TURNS)
        if every is None:
            continue
        paths = [path_of(every.path, i) for i in range(every.slope.size)]
        paths = [path for path in paths if not path.helix]
        if not paths:
            continue
        rates = orbit_rates(guess.take(np.zeros(len(paths), dtype=int)), paths)
        dead = np.array([every.index[i] for i in range(every.slope.size) if not every.path.helix[i]])
        index = np.nan_to_num(held_index(rates, problem.ratio.repeat(len(paths)), wanted.names, dead), nan=1.0)
        for k, path in enumerate(paths):
            state = State(guess, path, rates.take(slice(k, k + 1)))
            found.append((_far(state, wanted) + _UNSTABLE * index[k], state))
    found = [one for one in found if np.isfinite(one[0])]
    return [state for _, state in sorted(found, key=lambda one: one[0])]


def _far(state: State, wanted: Given) -> float:
    """How far the displacements of a state are from the wanted ones."""
    values = wanted.at(state).values
    size = {"z": wanted.span, "alpha": wanted.span, "turn": 1 + wanted.ratio * wanted.span}
    scale = np.array([size.get(name, 1.0) for name in wanted.names])
    return float(np.sqrt((((values - wanted.values) / scale) ** 2).sum()))


def _guesses(wanted: Given, problem: HeldProblem) -> list[dict[str, float]]:
    """Values of the loads and the end angles of dead-load problems; what is given is kept."""
    known = dict(zip(wanted.names, wanted.values.tolist(), strict=True))
    span = wanted.span
    mean = _mean_angle(known, span)
    wave = (2 * np.pi / span) ** 2
    options: dict[str, list[float]] = {"phi": [0.0, -1.5 * wave, -4 * wave, 0.5 + wave], "mu": [0.0], "lam": [0.0]}
    if "turn" in known:
        swirl = span * float(np.sin(mean) * np.cos(mean))
        options["mu"] = [0.0, (known["turn"] + swirl) / (wanted.ratio * span)]
    for name in ("phi", "lam", "mu"):
        if name in known:
            options[name] = [known[name]]
    ends = [name for name in ("beta0", "betaL") if name in known]
    angles = [[known[n]] if n in known else [mean + d for d in ((0.3, -0.3) if ends else (0.3,))] for n in FREE[:2]]
    found = []
    for phi, mu, b0, bL in product(options["phi"], options["mu"], *angles):
        if len(ends) == 0:
            bL = 2 * mean - b0
        lams = list(options["lam"])
        if "lam" not in known:
            lams.append(_helix_moment(mean, mu, phi))
        found += [{"phi": phi, "mu": mu, "lam": lam, "beta0": b0, "betaL": bL} for lam in dict.fromkeys(lams)]
    return found


def _mean_angle(known: dict[str, float], span: float) -> float:
    """The angle of a helix with the held height and azimuth, or the mean of the end angles, or 0."""
    if "alpha" in known and "z" in known:
        return float(np.arctan2(known["alpha"], known["z"]))
    if "alpha" in known:
        return float(np.arcsin(np.clip(known["alpha"] / span, -1, 1)))
    ends = [known[name] for name in ("beta0", "betaL") if name in known]
    return float(np.mean(ends)) if ends else 0.0


def _helix_moment(beta: float, mu: float, phi: float) -> float:
    """lam with H(beta) = 0; 0 at a right angle."""
    s, c = np.sin(beta), np.cos(beta)
    return float((mu * np.cos(2 * beta) + (phi + 2 * c * s * s) * s) / c) if abs(c) > 0.05 else 0.0


def index_of(state: State, wanted: Given) -> float:
    """The Morse index under the held ends; NaN where it is not decided.

    A rod with a hinge at both ends rests at both, so between its own two angles beta_t is a direction of no stiffness.
    Its index is then that of two neighbours, with small moments at both ends, if they agree.
    """
    found = _index(state, wanted)
    hinged = [k for k, name in enumerate(wanted.names) if name.startswith("dbeta")]
    if np.isfinite(found) or not hinged:
        return found
    beside = []
    for small in (_BESIDE, -_BESIDE):
        values = wanted.values.copy()
        values[hinged] += small
        near = replace(wanted, values=values)
        moved = carried(state, near)
        beside.append(np.nan if isinstance(moved, Stopped) else _index(moved, near))
    return beside[0] if beside[0] == beside[1] else np.nan


def _index(state: State, wanted: Given) -> float:
    dead = dead_index(state.rates, np.array([state.path.turns]))
    return float(held_index(state.rates, np.array([wanted.ratio]), wanted.names, dead)[0])


def held_trajectory(reached: Reached, wanted: Given, t: Array, tol: float) -> Trajectory:
    """The orbit of one equilibrium under held ends at stations t (1, n); its error is that of the given numbers."""
    state = _without_turns_at_hinges(_from_hinge(reached.state, wanted), wanted)
    orbit = orbit_of(state.problem, state.path)
    dead = dead_index(state.rates, np.array([state.path.turns]))
    if orbit.lengthens is not None and orbit.turns[0] > 0 and not state.path.helix:
        orbit = replace(orbit, lengthens=orbit.turns - dead)  # differences of the length fail at a hinge
    beta, dbeta, alpha, z = orbit.at(t)
    condition = np.array([response_of(state, wanted)])
    values = values_of(_at_length(state, orbit), float(state.problem.span[0]), wanted)
    size = {"z": wanted.span, "alpha": wanted.span, "turn": wanted.span, "dbeta0": _pace(state), "dbetaL": _pace(state)}
    miss = max(
        abs(float(value - given)) / max(size.get(name, 1.0), 1.0)
        for name, value, given in zip(wanted.names, values, wanted.values, strict=True)
    )
    error = (2 * miss + 1e-14) * condition
    calls = np.array([int(orbit.panels.calls.sum())])
    how = np.array([reached.begun], dtype=object)
    verdict = verdicts(beta, error, condition, tol)
    known: dict[str, Any] = {"error": error, "condition": condition, "evaluations": calls, "orbit": orbit, "begun": how}
    known["held_index"] = np.array([index_of(state, wanted)])
    return Trajectory(beta, dbeta, alpha, z, lambda: orbit.swirl(t), *verdict, **known)


def _at_length(state: State, orbit: Orbit) -> Array:
    """The `NUMBERS` of a state as its orbit has them at the length of the rod, (11,)."""
    problem, ends = state.problem, state.problem.span[:, None] * [0, 1]
    beta, v, alpha, z = (value[0] for value in orbit.at(ends))
    loads = problem.lam[0], problem.mu[0], problem.phi[0]
    swirl = orbit.swirl(ends)[0, 1]
    return np.array([problem.beta0[0], beta[1], *v, alpha[1], swirl, z[1], *loads, state.path.y])


def _pace(state: State) -> float:
    """A size of beta_t for the loads of a state."""
    return float(np.sqrt(1 + load_size(state.problem)[0]))


def _from_hinge(state: State, wanted: Given) -> State:
    """The state with its level measured from a start that is nearly at rest: other levels leave half the digits."""
    speed = abs(float(state.rates.value("dbeta0")[0]))
    if "dbeta0" not in wanted.names or state.path.helix or speed > _SLOW * _pace(state):
        return state
    for chart in charts(LinePoint(state.problem), state.path):
        if chart.kind == "start" and not chart.logarithmic:
            found = corrected(state.problem, wanted, chart, coordinate(chart))
            return state if isinstance(found, str) else found
    return state


def _without_turns_at_hinges(state: State, wanted: Given) -> State:
    """The state with turning points that are a hinge, to rounding, not counted as passed by the rod."""
    given = dict(zip(wanted.names, wanted.values.tolist(), strict=True))
    place, path = LinePoint(state.problem), state.path
    for kind, name in (("start", "dbeta0"), ("end", "dbetaL")):
        speed = float(state.rates.value(name)[0])
        if given.get(name) != 0 or abs(speed) > _AT_REST * _pace(state) or path.helix:
            continue
        for chart in charts(place, path):
            if chart.kind == kind and not chart.logarithmic:
                other = path_at(place, chart, -coordinate(chart))
                path = other if other is not None and 0 <= other.turns < path.turns else path
    return replace(state, path=path)


def response_of(state: State, wanted: Given) -> float:
    """The largest |d beta| along the rod by a unit of a given angle, or of a displacement in units of rho, or by a
    change of beta_t at an end of the size that the loads make."""
    problem, path = state.problem, state.path
    with np.errstate(all="ignore"):
        _, varied = varied_orbits(problem, [path], [LinePoint(problem)])
        lengths = [k for k, name in enumerate(wanted.names) if name not in FREE[2:]]
        unit = np.eye(5)[:, lengths] * [_pace(state) if wanted.names[k].startswith("d") else 1.0 for k in lengths]
        parts = parts_of(state.rates, wanted, unit, np.zeros(len(lengths)))
        places = varied.at(problem.span[:, None] * np.linspace(0, 1, _STATIONS))
        moves = changed(varied.start, places, parts[None, 0], parts[None, 1:].swapaxes(1, 2))
        largest = float(np.abs(moves.beta).max())
    return max(1.0, largest) if np.isfinite(largest) else np.inf


def each_held(problem: HeldProblem, t: Array, tol: float, seed: Seed | None) -> tuple[Trajectory, EndsProblem]:
    """The answers to B problems at stations t (B, n), and the problems under dead loads that they solve.

    A problem that is not solved stands there as a plain one.
    """
    found: list[Trajectory | str] = []
    solved = EndsProblem(**{name: np.full(problem.size, PLAIN[name]) for name in (*FREE, "span")})
    for i in range(problem.size):
        one = problem.take(slice(i, i + 1))
        reached = _reached(one, None if seed is None else seed.take(i))
        if isinstance(reached, str):
            found.append(reached)
            continue
        found.append(held_trajectory(reached, Given.of(one), t[i : i + 1], tol))
        for name, value in vars(solved).items():
            value[i] = getattr(reached.state.problem, name)[0]
    return together(found, t), solved


def _reached(one: HeldProblem, seed: Seed | None) -> Reached | str:
    numbers = np.append(one.values[0], [one.span[0], one.ratio[0]])
    if not (np.abs(numbers) < LARGEST).all() or one.span[0] < SHORTEST:
        return TOO_LARGE
    wanted = Given.of(one)
    if seed is None:
        return nearest_start(wanted, one)
    assert seed.problem is not None
    return from_seed(wanted, seed.problem, path_of_seed(seed))
