"""Which axis of a study may be followed: each case continues the equilibrium of the one before it."""

from typing import TYPE_CHECKING

import numpy as np

from solver import Start
from solver.problem.errors import choices

from .axes import START, Axis, Misplaced

if TYPE_CHECKING:
    from .model import Study


def check(study: "Study") -> None:
    """Raise `Misplaced` for several followed axes, and for one that the base case cannot be followed along."""
    names = [name for name, axis in study.axes.items() if axis.follow]
    if len(names) > 1:
        raise Misplaced(f"one axis may be followed, got {choices(names)}", "axes", names[1], "follow")
    for name in names:
        if study.kind is Start:
            _check_of_a_start(study, name, study.axes[name])
        else:
            _check_of_ends(name, study.axes[name])


def _check_of_ends(name: str, axis: Axis) -> None:
    if axis.is_open:
        give = f"give {name} from, to and count, or values"
        raise Misplaced(f"a followed axis over an ends problem begins at its first value: {give}", "axes", name)
    if axis.size < 2:
        raise Misplaced(f"a followed axis needs at least 2 values, got {axis.size}", "axes", name)
    steps = np.diff(axis.values) if axis.values is not None else np.ones(1)
    if not ((steps > 0).all() or (steps < 0).all()):
        raise Misplaced("the values of a followed axis must rise or fall", "axes", name, "values")


def _check_of_a_start(study: "Study", name: str, axis: Axis) -> None:
    if name in START and name != "M3":
        why = f"a start problem has only one solution at each {name}, which is not followed: remove follow"
        raise Misplaced(why, "axes", name, "follow")
    if name != "betaL" or len(study.axes) > 1:
        ends = "over an ends problem any axis can be followed: give the base beta0 and betaL"
        why = f"over a start problem, follow needs betaL as the only axis, got {choices(study.axes)}; {ends}"
        raise Misplaced(why, "axes", name, "follow")
    if not axis.is_open:
        key = "values" if axis.values is not None else "from"
        raise Misplaced(f"a followed axis starts at the value of the base case: leave out {key}", "axes", name, key)
