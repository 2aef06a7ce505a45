"""From a helix to the bent rods that it becomes when the numbers that its ends hold change."""

import numpy as np

from ..equilibrium.charts import charts, coordinate
from ..equilibrium.orbit_rates import NUMBERS, helix_change
from ..equilibrium.system import FREE, Given, State, answer, correct, parts_of, stepped
from ..levels.line_point import LinePoint, Path
from ..levels.paths import DOWN, UP
from ..mechanics.potential import slope_rate
from ..numerics.arrays import Array
from .held_helices import helices_of, helix_at

_SIZES = (2e-2, 2e-3, 2e-4)  # of the first step, tried in this order: beta_t at an end, changes of angles and loads
_STILL = 1e-9  # of the largest change: a beta_t that the helix does not get
_GOAL = 1e-7  # size of the last correction
_HELICES, _NEAR = 8, 0.5  # steps from helix to helix; largest change of an angle or a load in one
_STATIONS = 4001  # at which the turning points are counted


def off_helix(state: State, wanted: Given) -> tuple[State, float] | None:
    """A bent rod on the line from a helix to the wanted numbers, and the share of the line that it covers.

    None where the change leaves beta_t zero at both ends.
    """
    first = wanted.at(state)
    values, span = wanted.values - first.values, np.array([wanted.span - first.span])
    change = answer(state.rates, first, values[:, None], span)[:, 0]
    parts = parts_of(state.rates, first, values[:, None], span)[:, 0]
    moves = np.abs(change[[NUMBERS.index(name) for name in (*FREE, "dbeta0", "dbetaL")]])
    largest = float(moves.max())
    if not np.isfinite(largest) or not moves[-2:].max() > _STILL * largest:
        return None
    t = np.linspace(0, float(state.problem.span[0]), _STATIONS)
    speeds = helix_change(state.problem, t[None]).rate[0] @ parts
    on_saddle = bool(slope_rate(state.problem, state.problem.beta0)[0] < 0)
    for size in _SIZES:
        share = min(1.0, size / largest)
        ahead = first.towards(wanted, share)
        problem = stepped(state.problem, ahead, change, share)
        place = LinePoint(problem)
        paths = [_bent(place, share * speeds)]
        if on_saddle:
            paths = [_from_saddle(place, paths[0], share * float(speeds[0]), share * float(speeds[-1])), *paths]
        for chart in (chart for path in paths for chart in charts(place, path, wanted.hinged)):
            found = correct(problem, ahead, chart, coordinate(chart), 0.0 if ahead is wanted else _GOAL)
            if not isinstance(found, str):
                return found, share
    return None


def helix_ahead(state: State, wanted: Given) -> State | None:
    """The helix with the wanted numbers on the branch of a helix whose ends are both free to turn, without moments.

    None where it ceases to exist on the way, or one of its loads may have any value.
    """
    resting = {name: wanted.number(name, np.nan) for name in ("dbeta0", "dbetaL")}
    if any(value != 0 for value in resting.values()):
        return None
    first = wanted.at(state)
    for share in np.linspace(0, 1, _HELICES + 1)[1:]:
        beta = float(state.problem.beta0[0])
        ahead = [helix_at(one, beta) for one in helices_of(first.towards(wanted, float(share)))[0]]
        apart = [max(abs(float((getattr(one.problem, name) - getattr(state.problem, name))[0])) for name in FREE)
                 for one in ahead]  # fmt: skip
        if not apart or min(apart) > _NEAR:
            return None
        state = ahead[int(np.argmin(apart))]
    return state


def _bent(place: LinePoint, speeds: Array) -> Path:
    """The path of a rod that bends a little about a helix; speeds: beta_t along it."""
    signs = np.sign(speeds[1:-1])
    turns = int(np.count_nonzero(np.diff(signs[signs != 0])))
    v_0, v_L = float(speeds[0]), float(speeds[-1])
    if abs(v_0) >= abs(v_L):
        path = Path(place.start, 1.0, 2 * float(np.log(abs(v_0))), UP if v_0 > 0 else DOWN, turns)
    else:
        arriving = UP if v_L > 0 else DOWN
        path = Path(place.end, 1.0, 2 * float(np.log(abs(v_L))), arriving if turns % 2 == 0 else -arriving, turns)
    return path


def _from_saddle(place: LinePoint, path: Path, v_0: float, v_L: float) -> Path:
    """The path with its level measured from the saddle that a helix lies on.

    With beta_t = k (a exp(k t) - b exp(-k t)) the gap is -4 k^2 a b.
    """
    if not place.saddles.size:
        return path
    saddle = place.saddles[np.abs(np.sin((place.saddles - place.start) / 2)).argmin()]
    rate = -float(slope_rate(place.problem, np.array([saddle]))[0])
    if rate <= 0:
        return path
    fall = float(np.exp(-np.sqrt(rate) * place.problem.span[0]))
    a = fall * (v_L - v_0 * fall) / (1 - fall * fall)
    gap = -4 * a * (a - v_0)
    return Path(float(saddle), float(np.sign(gap)), float(np.log(abs(gap))), path.leaving, path.turns) if gap else path
