"""The mirror images of an equilibrium that have the same held ends.

beta -> -beta changes the signs of lam and mu, beta -> pi - beta those of phi and mu, and the rod may be run through
from its far end. Each of the seven images solves a problem with other given numbers; where these are the same numbers,
it is another equilibrium of the same problem.
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from ..equilibrium.given_numbers import Given, OrbitState
from ..equilibrium.orbit_rates import orbit_rates, start_rates
from ..equilibrium.system import corner_state
from ..levels.line_point import LinePoint, Path
from ..levels.transit_times import wrap
from ..mechanics.potential import TAU
from ..orbit.periodic_orbit import TIGHT, solve_orbit
from ..problem.reduced import EndsProblem

_ODD = ({"alpha", "turn", "lam", "mu"}, {"z", "turn", "phi", "mu"})  # what beta -> -beta and beta -> pi - beta negate
_REVERSED = {"beta0": "betaL", "betaL": "beta0", "dbeta0": "dbetaL", "dbetaL": "dbeta0"}
_EQUAL = 1e-12


@dataclass(frozen=True)
class Mirror:
    """Whether beta becomes -beta, whether then pi - beta, whether the rod is run through from its far end; then whole
    turns are added to beta."""

    negated: bool
    turned: bool
    backward: bool
    whole_turns: int = 0

    @property
    def direction(self) -> int:
        """The sign by which beta, but for a constant, is multiplied."""
        return -1 if self.negated != self.turned else 1

    def angle(self, beta: float) -> float:
        """The image of an angle."""
        beta = -beta if self.negated else beta
        return (np.pi - beta if self.turned else beta) + TAU * self.whole_turns

    def number(self, name: str, value: float) -> tuple[str, float]:
        """The image of one of the numbers: its name and value."""
        to = _REVERSED.get(name, name) if self.backward else name
        if name in ("beta0", "betaL"):
            return to, self.angle(value)
        if name in ("dbeta0", "dbetaL"):
            return to, self.direction * (-value if self.backward else value)
        odd = sum(on and name in signs for on, signs in zip((self.negated, self.turned), _ODD, strict=True))
        return to, -value if odd == 1 else value


def mirrors_of(given: Given) -> list[Mirror]:
    """The images that have the given numbers of a problem."""
    known = dict(zip(given.names, given.values.tolist(), strict=True))
    mirrors = []
    for negated, turned, backward in product((False, True), repeat=3):
        plain = Mirror(negated, turned, backward)
        image = dict(plain.number(name, value) for name, value in known.items())
        if plain == Mirror(False, False, False) or image.keys() != known.keys():
            continue
        turns = [(known[name] - image[name]) / TAU for name in ("beta0", "betaL") if name in known]
        mirror = replace(plain, whole_turns=round(turns[0])) if turns else plain
        image = dict(mirror.number(name, value) for name, value in known.items())
        if all(abs(image[name] - value) <= _EQUAL * (1 + abs(value)) for name, value in known.items()):
            mirrors.append(mirror)
    return mirrors


def half_period_later(state: OrbitState, given: Given) -> OrbitState | None:
    """The rod that begins at the other turning point of the same orbit; None unless both ends rest at turning points.

    Over whole periods all that is held is the same.
    """
    resting = all(given.number(name, np.nan) == 0 for name in ("dbeta0", "dbetaL"))
    if not resting or state.path.helix or state.path.turns % 2 == 0:
        return None
    problem = state.problem.with_start(np.zeros(1))
    orbit = solve_orbit(problem, TIGHT)
    other = float(orbit.at(orbit.ahead[:, None])[0][0, 0])
    rates = start_rates(replace(problem, beta0=np.array([other])))
    return corner_state(rates, 0.0) if np.isfinite(rates.rows[0, :-1]).all() else None


def image_of(state: OrbitState, mirror: Mirror, given: Given) -> OrbitState:
    """The image of a state; what is given is exactly as given."""
    old = state.problem
    known = dict(zip(given.names, given.values.tolist(), strict=True))
    numbers = dict(mirror.number(name, float(getattr(old, name)[0])) for name in ("beta0", "betaL", "lam", "mu", "phi"))
    numbers |= {name: known[name] for name in numbers if name in known}
    problem = EndsProblem(**{name: np.array([value]) for name, value in numbers.items()}, span=old.span)
    path = _path(state.path, LinePoint(old), LinePoint(problem), mirror)
    return OrbitState(problem, path, orbit_rates(problem, [path]))


def _path(path: Path, old: LinePoint, new: LinePoint, mirror: Mirror) -> Path:
    """The image of a path, its level measured from the image of the same angle."""
    if path.helix:
        return new.helix or path
    ends = (new.end, new.start) if mirror.backward else (new.start, new.end)
    if path.pin in (old.start, old.end) and path.pin not in old.saddles:
        pin = ends[0] if path.pin == old.start else ends[1]
    else:
        apart = np.abs(np.sin((new.saddles - wrap(mirror.angle(path.pin))) / 2))
        pin = float(new.saddles[int(np.argmin(apart))])
    leaving = mirror.direction * (-path.arriving if mirror.backward else path.leaving)
    return replace(path, pin=pin, leaving=leaving)
