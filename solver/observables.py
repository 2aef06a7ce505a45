"""Scalar functions of a solution: what a study tabulates. Each returns one number a case, (*cases)."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from .errors import no_such
from .overlap import overlaps
from .solution import Solution


def turns(sol: Solution) -> Any:
    """Interior extrema of beta, as sign changes of beta' between stations."""
    sign = np.sign(sol.dbeta)
    return np.count_nonzero(sign[..., 1:] * sign[..., :-1] < 0, axis=-1)


def amplitude(sol: Solution) -> Any:
    """Largest less smallest beta [rad]."""
    return np.ptp(sol.beta, axis=-1)


def loops(sol: Solution) -> Any:
    """Full turns of beta."""
    return np.floor(np.ptp(sol.beta, axis=-1) / (2 * np.pi))


def kappa_mean(sol: Solution) -> Any:
    """Mean curvature [1/length]."""
    return _mean(sol, sol.kappa)


def kappa_max(sol: Solution) -> Any:
    """Largest curvature [1/length]."""
    return sol.kappa.max(axis=-1)


def wraps(sol: Solution) -> Any:
    """Turns about the axis, alpha(L)/2 pi."""
    return (sol.alpha[..., -1] - sol.alpha[..., 0]) / (2 * np.pi)


def height(sol: Solution) -> Any:
    """z(L) [length]."""
    return sol.z[..., -1]


def contact_mean(sol: Solution) -> Any:
    """Mean of |f| [force/length]."""
    return _mean(sol, np.abs(sol.contact))


def contact_min(sol: Solution) -> Any:
    """Smallest f [force/length], positive outward."""
    return sol.contact.min(axis=-1)


def contact_max(sol: Solution) -> Any:
    """Largest f [force/length], positive outward."""
    return sol.contact.max(axis=-1)


def attached(sol: Solution) -> Any:
    """Share of the length where the cylinder pushes."""
    return _mean(sol, (sol.push >= 0).astype(float))


def energy(sol: Solution) -> Any:
    """Bending energy less the work of the dead loads [force length]."""
    from .statics import energy_density

    return _mean(sol, energy_density(sol._loads[0], sol.h, sol.dbeta)) * (sol.s[..., -1] - sol.s[..., 0])


def _mean(sol: Solution, values: Any) -> Any:
    return np.trapezoid(values, sol.s, axis=-1) / (sol.s[..., -1] - sol.s[..., 0])


OBSERVABLES: dict[str, Callable[[Solution], Any]] = {
    "turns": turns,
    "loops": loops,
    "amplitude": amplitude,
    "kappa_mean": kappa_mean,
    "kappa_max": kappa_max,
    "wraps": wraps,
    "height": height,
    "contact_mean": contact_mean,
    "contact_min": contact_min,
    "contact_max": contact_max,
    "attached": attached,
    "overlaps": overlaps,
    "energy": energy,
}


def observe(sol: Solution, names: Iterable[str]) -> dict[str, Any]:
    """The named observables of a solution, each (*cases); raises `InputError` for an unknown name."""
    found = {}
    for name in names:
        if name not in OBSERVABLES:
            raise no_such("observable", name, OBSERVABLES)
        found[name] = OBSERVABLES[name](sol)
    return found
