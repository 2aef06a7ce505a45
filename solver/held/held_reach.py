"""Which equilibrium under held ends a rule or a seed means.

Stable before unstable, then the least held energy among what is found in a bounded time: the minima below simple
shapes, or where none is found what the nearest equilibria under dead loads lead to. Where a dead force pushes, rods
that it turns round come last: they have the least energy, as under dead loads, and a user does not mean them. For an
index above 0 the search of the list is made.
"""

from dataclasses import dataclass

import numpy as np

from ..branches.branch_events import Stop
from ..branches.given_numbers import Given, OrbitState
from ..branches.held_index import held_energy, index_of
from ..branches.helices import helices_of
from ..numerics.arrays import NEGLIGIBLE
from .energy_minima import energy_minima, is_turned_round, refinement
from .equilibrium_choice import LOWEST, Choose, HeldSelection, none_of_index, select
from .held_alternatives import said_of_seed
from .held_moves import angles_along, carry, settle
from .held_search import image_of, mirrors_of, search_equilibria
from .held_starts import equilibrium_beside, outcome_of, states_from_dead_loads


@dataclass(frozen=True, eq=False)
class Reached:
    """An equilibrium under held ends.

    begun: how it was found, in words. seed: the one that it continues. selection: how it was selected. None where there
    is none. is_minimum: whether a mesh shows that it is stable, which counts where its orbit does not decide the index.
    """

    state: OrbitState
    begun: str | None = None
    seed: OrbitState | None = None
    selection: HeldSelection | None = None
    is_minimum: bool = False

    def index(self, wanted: Given) -> float:
        """The Morse index under the held ends; NaN where it is not decided."""
        index = index_of(self.state, wanted)
        return 0.0 if self.is_minimum and np.isnan(index) else index


def by_seed(wanted: Given, seed: OrbitState | None) -> Reached | str:
    """The equilibrium on the branch of a seed; or the outcome that says why there is none."""
    if seed is None:
        return "failed: the seed is not a solution of its own ends problem"
    state = carry(seed, wanted)
    return outcome_of(state) if isinstance(state, Stop) else Reached(state, said_of_seed(seed, state, wanted), seed)


def by_rule(wanted: Given, choose: Choose) -> Reached | str:
    """The equilibrium that the rule takes; or the outcome that says why there is none."""
    if isinstance(choose, int) and choose > 0:
        return _choice(wanted, search_equilibria(wanted).states, choose)
    helices = sorted(helices_of(wanted)[0], key=lambda helix: held_energy(helix, wanted))
    lowest = _lowest(wanted, helices, choose)
    if lowest is not None:
        return lowest
    states = states_from_dead_loads(wanted, helices)
    return states if isinstance(states, str) else _choice(wanted, states, choose)


def _lowest(wanted: Given, helices: list[OrbitState], choose: Choose) -> Reached | None:
    """The equilibrium at the minimum that the rule takes; None where none of the minima tells a stable one."""
    minima = energy_minima(wanted, [float(helix.problem.beta0[0]) for helix in helices])
    count, waiting = len(minima), minima
    while waiting:
        turned, none = np.array([is_turned_round(wanted, minimum.beta) for minimum in waiting]), np.zeros(len(waiting))
        i = select(choose, none, np.array([minimum.energy for minimum in waiting]), turned.astype(float), none)
        assert i is not None
        first = waiting.pop(i)
        if not first.fine:
            waiting += [] if (finer := refinement(first)) is None else [finer]
            continue
        state = equilibrium_beside(first, helices)
        if state is not None and not index_of(state, wanted) > 0:
            aside = int(np.count_nonzero(turned)) if choose != LOWEST and not turned[i] else 0
            how = HeldSelection(count, count, choose, False, 0.0, aside)
            return Reached(_image_rising_most(state, wanted), None, None, how, True)
    return None


def _image_rising_most(state: OrbitState, wanted: Given) -> OrbitState:
    """Of an equilibrium and its mirror images with the same ends, that with the largest beta_t(0)."""
    best = state
    for mirror in mirrors_of(wanted):
        image = image_of(state, mirror, wanted)
        settled = image if image.path.helix else settle(image, wanted)
        if not isinstance(settled, str) and _dbeta0(settled) > _dbeta0(best) + NEGLIGIBLE * (1 + abs(_dbeta0(best))):
            best = settled
    return best


def _dbeta0(state: OrbitState) -> float:
    """beta_t(0)."""
    return float(state.rates.value("dbeta0")[0])


def _choice(wanted: Given, states: list[OrbitState], choose: Choose) -> Reached | str:
    """The equilibrium that the rule takes of those found."""
    index = np.array([index_of(state, wanted) for state in states])
    turned = np.array([is_turned_round(wanted, angles_along(state)) for state in states])
    energy = np.array([held_energy(state, wanted) for state in states])
    i = select(choose, index, energy, turned.astype(float), np.array([_dbeta0(state) for state in states]))
    if i is None:
        return none_of_index(choose, len(states), index)
    stable = int(np.count_nonzero(index == 0))
    aside = int(np.count_nonzero(turned)) if choose != LOWEST and not turned[i] else 0
    return Reached(states[i], selection=HeldSelection(len(states), stable, choose, False, float(index[i]), aside))
