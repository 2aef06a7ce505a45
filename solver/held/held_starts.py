"""Equilibria under held ends, from a minimum of the energy or from equilibria under dead loads.

A minimum on a mesh tells the loads and the end angles of an equilibrium, which is taken from those under these dead
loads. Where no minimum is found, as of very long rods, guesses of the unknown loads and end angles give some dead-load
problems; of their equilibria with few turning points those are tried first whose displacements are nearest to the held
ones and whose index under the held ends is small, up to one that leads to a stable equilibrium. If none leads to one,
the stable helices are taken, or what starts next to helices lead to, or any helix. There may be other equilibria.
"""

from itertools import product

import numpy as np

from ..branches.branch_events import Stop
from ..branches.deflation import end_vector, is_known
from ..branches.given_numbers import FREE, Given, OrbitState, problem_of
from ..branches.held_index import index_of
from ..branches.leaps import NEAR, angles_on
from ..numerics.arclength import BRANCH_POINT, FEW_POINTS, FOLD
from ..numerics.arrays import ASIDE, ROUGHLY
from ..orbits.boundary import critical_points
from ..orbits.path_orbits import orbit_of
from ..orbits.potential import TAU
from .energy_minima import EnergyMinimum, taut_pace
from .held_moves import carry, settle
from .held_sweep import dead_states

# starts from which continuation is tried; equilibria after which it ends. x10: only cases that fail take longer; all
# are found before one is taken
_TRIED, _REACHED = 8, 3
# what a negative direction of a start adds to its distance. x10: far starts that are stable come before near ones
_UNSTABLE = 0.3
_MOST_TURNS = 2  # of the starts. x10: more starts, of shapes that are unstable
# least k L/rho of a taut rod: the angle decays before the other end, to exp(-8) of it. x10: taut rods start from loads
# that leave most to continuation
_LAYERS = 8.0
# the most of a stable rod: one more than the displacements that are held, and one at each hinge. x10: only time
_STABLE_TURNS = 6


def outcome_of(stop: Stop) -> str:
    """The outcome of a continuation that stopped."""
    why = f"a {stop.reason} of the problem with held ends" if stop.reason in (FOLD, BRANCH_POINT) else stop.reason
    return (
        f"failed: the branch of the start could not be followed to the held ends: {why} "
        f"after {abs(stop.p):.2%} of the way"
    )


def equilibrium_beside(minimum: EnergyMinimum, helices: list[OrbitState]) -> OrbitState | None:
    """The equilibrium of a minimum on a mesh; None where none is found beside it.

    helices: those that have the held ends.
    """
    given, u = minimum.land.given, minimum.land.mesh.points.ravel()
    beta = minimum.land.angles(minimum.beta).ravel()
    # a minimum whose beta varies less [rad] may be a helix
    if np.ptp(beta) < ROUGHLY:
        turn = TAU if not {"beta0", "betaL"} & {*given.names} else np.inf
        for helix in helices:
            if abs(np.remainder(helix.problem.beta0[0] - beta[0] + NEAR, turn) - NEAR) < ROUGHLY:
                return helix
    dead = dead_states(problem_of(given, minimum.numbers), most_turns=_STABLE_TURNS)
    states = [] if dead is None else dead[0]
    away = [float(np.abs(angles_on(orbit_of(state.problem, state.path), u)[0] - beta).max()) for state in states]
    for i in np.argsort(away)[:2]:
        if away[i] < NEAR:
            state = settle(states[i], given)
            carried = carry(states[i], given, FEW_POINTS) if isinstance(state, str) else state
            if not isinstance(carried, Stop):
                return carried
    return None


def states_from_dead_loads(wanted: Given, helices: list[OrbitState]) -> list[OrbitState] | str:
    """The equilibria reached from the nearest dead-load equilibria; or the outcome that says why there is none."""
    guesses = _guesses(wanted)
    reached, tried, why = _reach(wanted, _starts(wanted, guesses), helices)
    reached = reached or [helix for helix in helices if index_of(helix, wanted) == 0]
    if not reached and (near := _next_to_helices(wanted, guesses)):
        reached, more, _ = _reach(wanted, _starts(wanted, near), helices)
        tried += more
    return reached or helices or f"{why}; {tried} starts were tried; in Python a seed may help"


def _reach(wanted: Given, starts: list[OrbitState], helices: list[OrbitState]) -> tuple[list[OrbitState], int, str]:
    """What the first starts lead to, up to a stable equilibrium; how many were tried; why the first of them failed.

    An orbit whose swings about one of the helices fall to rounding is that helix.
    """
    reached: list[OrbitState] = []
    why, taut = "", _taut_loads(wanted)
    for tried, start in enumerate(starts[:_TRIED], 1):
        state = carry(start, wanted)
        if isinstance(state, Stop):
            why = why or outcome_of(state)
            near = settle(start, wanted) if taut else ""  # where steps are lost in rounding
            if isinstance(near, str):
                continue
            state = near
        state = next((helix for helix in helices if is_known(state, [end_vector(helix)])), state)
        reached.append(state)
        if index_of(state, wanted) == 0 or len(reached) == _REACHED:
            return reached, tried, why
    return reached, len(starts[:_TRIED]), why or "failed: no equilibrium under dead loads was found to start from"


def _starts(wanted: Given, guesses: list[dict[str, float]]) -> list[OrbitState]:
    """Dead-load equilibria, that with the nearest displacements first."""
    ranked: list[tuple[float, OrbitState]] = []
    for numbers in guesses:
        dead = dead_states(problem_of(wanted, numbers), most_turns=_MOST_TURNS)
        for state in [] if dead is None else dead[0]:
            index = float(np.nan_to_num(index_of(state, wanted), nan=1.0))
            ranked.append((_far(state, wanted) + _UNSTABLE * index, state))
    ranked = [pair for pair in ranked if np.isfinite(pair[0])]
    return [state for _, state in sorted(ranked, key=lambda pair: pair[0])]


def _far(state: OrbitState, wanted: Given) -> float:
    """How far the displacements of a state are from the wanted ones."""
    values = wanted.at(state).values
    size = {"z": wanted.span, "alpha": wanted.span, "turn": 1 + wanted.ratio * wanted.span}
    scale = np.array([size.get(name, 1.0) for name in wanted.names])
    return float(np.sqrt((((values - wanted.values) / scale) ** 2).sum()))


def _guesses(wanted: Given) -> list[dict[str, float]]:
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
    guesses = []
    for phi, mu, b0, bL in product(options["phi"], options["mu"], *angles):
        if len(ends) == 0:
            bL = 2 * mean - b0
        lams = list(options["lam"])
        if "lam" not in known:
            lams.append(_helix_moment(mean, mu, phi))
        guesses += [{"phi": phi, "mu": mu, "lam": lam, "beta0": b0, "betaL": bL} for lam in dict.fromkeys(lams)]
    pulled = _taut_loads(wanted)
    taut = [guess | {name: known.get(name, value) for name, value in pulled.items()} for guess in guesses if pulled]
    return list({tuple(guess.values()): guess for guess in guesses + taut}.values())


def _taut_loads(wanted: Given) -> dict[str, float]:
    """The loads of a rod whose ends are nearly as far apart as it is long; none where that says nothing of them."""
    pace, chord = taut_pace(wanted)
    return {"phi": pace**2 * np.cos(chord), "lam": pace**2 * np.sin(chord)} if pace * wanted.span > _LAYERS else {}


def _next_to_helices(wanted: Given, guesses: list[dict[str, float]]) -> list[dict[str, float]]:
    """The guesses with the angle of one free end next to that of a helix, at a maximum of G.

    At a hinge a long rod nearly is that helix: the distance falls exponentially with the length. Continuation from an
    angle that is far from the helix does not resolve it.
    """
    free = [name for name in FREE[:2] if name not in wanted.names]
    beside = []
    for guess in guesses if len(free) == 1 else []:
        (name,) = free
        other = guess["betaL" if name == "beta0" else "beta0"]
        points = critical_points(problem_of(wanted, guess))
        for angle in points.beta[~points.centre & np.isfinite(points.beta)]:
            way = float(np.remainder(angle - other + np.pi, TAU) - np.pi)
            if way and abs(way) < np.pi / 2:
                # an end angle stays away from that of a helix by the share ASIDE of the way to it
                beside.append(guess | {name: other + (1 - ASIDE) * way})
    return list({tuple(guess.values()): guess for guess in beside}.values())


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
