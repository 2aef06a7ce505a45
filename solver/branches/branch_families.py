"""The problems of a branch over one field of a case, under dead loads and with held ends."""

from collections.abc import Sequence
from functools import partial

from ..core.branches import Numbers
from ..equilibrium.system import Given
from ..problem.case import Case
from ..problem.case_fields import numbers_over, unchecked_with_field, value_of, with_field
from ..problem.errors import InputError
from ..problem.held_ends import held_numbers_over, held_of, reduce_held
from ..problem.reduced import EndsProblem, reduce
from .branch_states import Bounds
from .family import Family, problem_of, scale_of


def family_of(case: Case, name: str, begun: EndsProblem, bounds: Bounds) -> Family:
    """The problems over one field; also a little beyond the range, as differences need them.

    begun: one equilibrium, as a problem under dead loads.
    """
    is_held, own, reach = bool(held_of(case)), value_of(case, name), bounds.high - bounds.low

    def given(value: float) -> Given | None:
        found = _case(case, name, bounds, value) if abs(value - own) <= 2 * reach else None
        if found is None or is_held:
            return None if found is None else Given.of(reduce_held(found))
        problem = reduce(found)
        return Given.dead(problem) if isinstance(problem, EndsProblem) else None

    def beyond(value: float) -> Sequence[float] | None:
        found = given(value)
        if found is None or is_held:
            return None if found is None else [*found.values.tolist(), found.span, found.ratio]
        return [float(number[0]) for number in vars(problem_of(found, {})).values()]

    inside = (held_numbers_over if is_held else numbers_over)(case, name)
    here = given(own)
    assert here is not None
    numbers = partial(_numbers, inside, beyond, bounds)
    return Family(given, begun, scale_of(given, own, reach), here.names, numbers)


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
