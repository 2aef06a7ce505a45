"""The derivatives of what is measured along rods that are no helices."""

from collections.abc import Mapping
from functools import cache

import numpy as np

from ..numerics.arrays import Array
from ..observe.measurement import MIDDLE
from .density_changes import DensityChange
from .extremes import (
    EXTREMES,
    INTEGRALS,
    LIFTS,
    MIDDLE_PUSH,
    PEAK,
    PUSHES,
    extreme,
    first_below,
    first_peak,
)
from .integrals import cut_at_zeros, integral, parts, positive_between
from .motions import Motion


def of_orbits(
    motion: Motion, unit: Array, later: Array, sign: Array, wanted: set[str], seen: Mapping[str, Array]
) -> dict[str, Array]:
    """The derivatives of what is measured, and of half a period, (b, F) each.

    unit: (b, 5, F), of `solution_derivatives.amounts`. later: (b, F), the change of the length in t. sign: (b,), of
    `Case.outward`. seen: (b,) each, the t of the largest push and of lift-off that are observed.
    """
    varied, span = motion.varied, motion.problem.span
    assert varied is not None
    a0, e, places = unit[:, 0], unit[:, 1:].swapaxes(1, 2), (varied.start, motion.end)
    found = {"half_period": -np.einsum("bk,bgk->bg", varied.gain[:, :, :4].sum(axis=1), e)}

    @cache
    def measure(density: str) -> DensityChange:
        return DensityChange(motion, varied, span, places, density, sign, a0, e, later)

    for name in wanted:
        if name in EXTREMES:
            density, which = EXTREMES[name]
            found[name] = extreme(measure(density), which)
        elif name in INTEGRALS:
            found[name] = integral(measure(name))
    push = measure("outward")
    if wanted & {*PUSHES, MIDDLE_PUSH}:
        cut = cut_at_zeros(push)
        found |= {name: value for name, value in zip(PUSHES, parts(cut), strict=True) if name in wanted}
        if MIDDLE_PUSH in wanted:
            found[MIDDLE_PUSH] = positive_between(cut, *MIDDLE)
    if LIFTS in wanted:
        found[LIFTS] = first_below(push, seen[LIFTS])
    if PEAK in wanted:
        found[PEAK] = first_peak(push, seen[PEAK])
    return found
