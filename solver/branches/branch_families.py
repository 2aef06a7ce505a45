"""The problems of a branch over one field of a case, under dead loads and with held ends."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from ..equilibrium.system import Given
from ..problem.case import Case
from ..problem.case_fields import numbers_over, unchecked_with_field, value_of, with_field
from ..problem.errors import InputError
from ..problem.held_ends import held_numbers_over, held_of, reduce_held
from ..problem.reduced import EndsProblem, reduce
from .branch_states import Bounds
from .equilibrium_curve import Family, scale_of
from .held_curve import HeldFamily

Numbers = Callable[[float], Sequence[float] | None]


def family_of(case: Case, name: str, begun: EndsProblem, bounds: Bounds) -> Family | HeldFamily:
    """The problems over one field; begun: one equilibrium, as a problem under dead loads."""
    return held_family(case, name, begun, bounds) if held_of(case) else dead_family(case, name, bounds)


def dead_family(case: Case, name: str, bounds: Bounds) -> Family:
    """The problems under dead loads over one field; also a little beyond the range, as differences need them."""
    own, reach = value_of(case, name), bounds.high - bounds.low

    def problem(value: float) -> EndsProblem | None:
        found = _case(case, name, bounds, value) if abs(value - own) <= 2 * reach else None
        some = None if found is None else reduce(found)
        return some if isinstance(some, EndsProblem) else None

    def beyond(value: float) -> Sequence[float] | None:
        found = problem(value)
        return None if found is None else [float(number[0]) for number in vars(found).values()]

    return Family(problem, scale_of(problem, own, reach), partial(_numbers, numbers_over(case, name), beyond, bounds))


def held_family(case: Case, name: str, begun: EndsProblem, bounds: Bounds) -> HeldFamily:
    """The problems with held ends over one field; begun as in `family_of`."""

    def given(value: float) -> Given | None:
        found = _case(case, name, bounds, value)
        return None if found is None else Given.of(reduce_held(found))

    def beyond(value: float) -> Sequence[float] | None:
        found = given(value)
        return None if found is None else [*found.values.tolist(), found.span, found.ratio]

    own, reach = value_of(case, name), bounds.high - bounds.low
    nudge = 1e-6 * reach * (1 if own < bounds.high else -1)
    here, there = given(own), given(own + nudge)
    assert here is not None
    assert there is not None
    moved = np.abs(np.append(there.values - here.values, there.span - here.span)) / abs(nudge)
    size = np.append(np.where(np.isin(here.names, ("z", "alpha", "turn")), 1.0, 1 + np.abs(here.values)), 1 + here.span)
    rate = float((moved / size).max())
    numbers = partial(_numbers, held_numbers_over(case, name), beyond, bounds)
    return HeldFamily(given, begun, reach if rate * reach < 1 else 1 / rate, here.names, numbers)


def _case(case: Case, name: str, bounds: Bounds, value: float) -> Case | None:
    """The case at a value of the field; None where there is none."""
    if bounds.low <= value <= bounds.high:  # where the fields are known to be valid
        return unchecked_with_field(case, name, value)
    try:
        return with_field(case, name, value)
    except InputError:
        return None


def _numbers(inside: Numbers, beyond: Numbers, bounds: Bounds, value: float) -> Sequence[float] | None:
    """The numbers of the problem at a value; inside, beyond: those in the range of the field, and out of it."""
    if not bounds.low <= value <= bounds.high:
        return beyond(value)
    try:
        return inside(value)
    except (ZeroDivisionError, OverflowError):  # a stiffness out of the range of floats
        return None
