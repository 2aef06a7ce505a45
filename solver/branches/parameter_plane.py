"""The plane of two fields of an ends problem: its points, and the dimensionless problems there."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from ..numerics.arrays import ASIDE, Array
from ..problem.case import Case, Ends, refuse_leaving
from ..problem.case_fields import check_fields, with_fields
from ..problem.dimensionless import ACTING, EndsProblem, field_rates, fields_held, reduce
from ..problem.errors import InputError, choices
from ..problem.field_values import read_range

Numbers = TypeVar("Numbers")  # a dataclass


@dataclass(frozen=True, eq=False)
class ParameterPlane:
    """A rectangle of two fields of one ends problem.

    case: the other fields. names: the two fields. low, high: (2,), their ranges. Points are given by shares (..., 2) of
    the two ranges, 0 to 1.
    """

    case: Case
    names: tuple[str, str]
    low: Array
    high: Array
    closed: bool = False  # whether values beyond the ranges are invalid, so that their ends stand for them

    def values(self, shares: Array) -> Array:
        """The values of the fields at shares (..., 2), (..., 2)."""
        shares = np.asarray(shares, dtype=float)
        shares = np.clip(shares, 0, 1) if self.closed else shares
        return np.asarray(self.low + (self.high - self.low) * shares)

    def shares(self, values: Array) -> Array:
        """The shares of values (..., 2), (..., 2)."""
        return np.asarray((np.asarray(values, dtype=float) - self.low) / (self.high - self.low))

    def case_at(self, shares: Array) -> Case:
        """The case at one point (2,), or the cases at several (N, 2)."""
        return with_fields(self.case, dict(zip(self.names, np.moveaxis(self.values(shares), -1, 0), strict=True)))

    @property
    def varies(self) -> bool:
        """Whether loads vary along the rod somewhere in the plane."""
        return self.case_at(np.ones(2)).varies

    @property
    def on_nodes(self) -> bool:
        """Whether its equilibria are shapes on nodes somewhere in the plane, and no orbits."""
        return self.varies or self.case.has_hinge

    def problems(self, shares: Array) -> EndsProblem:
        """The problems at shares (N, 2), as one of size N."""
        problem = reduce(self.case_at(np.atleast_2d(shares)))
        assert isinstance(problem, EndsProblem)
        return problem


def reflect(
    at: Callable[[Any], Numbers], z: Any, names: tuple[str, ...], low: float = 0.0, high: float = 1.0
) -> Numbers:
    """What a function gives at z, one number or two from low to high, beyond this border too, where no case may have
    such values.

    names: of its numbers, which go on there as they are at the border; its span, which is positive, by its ratio.
    Differences and steps reach there.
    """
    border = np.clip(z, low, high)
    if np.all(z == border):
        return at(z)
    ends: list[Any] = [at(border), at(np.clip(2 * border - z, low, high))]
    on_border, inside = ends
    beyond = {name: 2 * getattr(on_border, name) - getattr(inside, name) for name in names}
    changed: Numbers = replace(on_border, span=on_border.span**2 / inside.span, **beyond)
    return changed


def parameter_plane(case: Case, ranges: dict[str, Any]) -> ParameterPlane:
    """The plane of two fields. ranges: field -> (from, to); an angle may be text.

    Raises
    ------
    InputError
        For a start problem, a grid of cases, not two fields, an unknown field, one on which
        no equilibrium depends, and a range that is not two finite numbers, the first lower, or that holds invalid
        values.
    """
    refuse_leaving(case.cylinder, "a search for fold curves")
    if not isinstance(case.given, Ends):
        raise InputError(f"fold curves need a Case with Ends, got {type(case.given).__name__}")
    if case.shape:
        raise InputError(f"fold curves need one case, got a grid of shape {case.shape}")
    if len(ranges) != 2:
        raise InputError(f"fold curves need two fields with their ranges, got {choices(ranges) or 'none'}")
    first, second = check_fields(case, ranges)
    ends = np.array([read_range(*each) for each in zip((first, second), ranges.values(), strict=True)])
    plane = ParameterPlane(case, (first, second), ends[:, 0], ends[:, 1])
    # equilibria may be computed as far beyond a range as the share ASIDE of it
    corners = np.array([[u, w] for u in (-ASIDE, 0.5, 1 + ASIDE) for w in (-ASIDE, 0.5, 1 + ASIDE)])
    try:
        plane.case_at(corners)
    except InputError:
        plane = replace(plane, closed=True)
    if plane.varies:
        if plane.case_at(np.ones(2)).cylinder.friction:
            raise InputError(
                "fold curves over the whole rectangle need a rod without friction, which leaves no index; with it "
                "follow an equilibrium to a fold, and trace_fold in Python traces its curve"
            )
        return plane
    try:
        rates = field_rates(plane.case_at(corners), plane.names)
    except InputError as refusal:
        raise InputError(f"no fold curves over {first} and {second}: {refusal}") from None
    moved = rates.table[: len(ACTING)]
    if fields_held(case):
        assert rates.given is not None
        turned = rates.of("ratio") * ("rotation" in fields_held(case))
        moved = np.concatenate([np.moveaxis(rates.given, 1, 0), np.stack([rates.of("span"), turned])])
    for k, name in enumerate((first, second)):
        if not moved[:, :, k].any():
            raise InputError(f"no equilibrium depends on {name}; choose another field")
    return plane
