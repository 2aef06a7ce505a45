"""The derivatives of what is measured along rods that are no helices."""

from typing import Any

import numpy as np

from ..numerics.arrays import Array
from ..observe import densities
from ..observe.measurement import MIDDLE
from .density_changes import DensityChange
from .extremes import extreme
from .integrals import integral, parts, positive_between
from .lift_off import first_below
from .measured import EXTREMES, INTEGRALS, LIFTS, MIDDLE_PUSH, PEAK, PUSHES
from .motions import Motion
from .peaks import first_peak


def of_orbits(
    motion: Motion, unit: Array, later: Array, sign: Array, wanted: set[str], peak: Array
) -> dict[str, Array]:
    """The derivatives of what is measured, and of half a period, (b, F) each.

    unit: (b, 5, F), of `along.amounts`. later: (b, F), the change of the length in t. sign: (b,), of `Case.outward`.
    peak: (b,), the t of the largest push that is observed; read where it is wanted.
    """
    orbits = motion.orbits
    assert orbits is not None
    a0, e = np.einsum("bf,bfg->bg", orbits.a0, unit), np.einsum("bfk,bfg->bgk", orbits.e, unit)
    varied, places, span = orbits.varied, (orbits.start, orbits.end), motion.problem.span
    found = {"half_period": -np.einsum("bk,bgk->bg", varied.gain[:, :, :4].sum(axis=1), e)}

    def measure(density: Any) -> DensityChange:
        turn = sign if density is densities.outward else np.ones_like(span)
        return DensityChange(motion.problem, varied, span, places, density, turn, a0, e, later)

    for name in wanted:
        if name in EXTREMES:
            density, which = EXTREMES[name]
            found[name] = extreme(measure(density), which)
        elif name in INTEGRALS:
            found[name] = integral(measure(INTEGRALS[name]))
    push = measure(densities.outward)
    if wanted & set(PUSHES):
        made = dict(zip(PUSHES, parts(push), strict=True))
        found |= {name: value for name, value in made.items() if name in wanted}
    if MIDDLE_PUSH in wanted:
        found[MIDDLE_PUSH] = positive_between(push, *MIDDLE)
    if LIFTS in wanted:
        found[LIFTS] = first_below(push)
    if PEAK in wanted:
        found[PEAK] = first_peak(push, peak)
    return found
