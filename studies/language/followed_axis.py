"""Which axis of a study may be followed: each case continues the equilibrium of the one before it."""

import numpy as np

from solver import Start
from solver.problem.errors import choices

from ..grammar.axes import CYLINDER, ROD, START, WORDS, Axis, Misplaced
from .study_data import StudyData

OF_ENDS = ("betaL", "FZ", "MZ", "M3")  # of the ends problem that a start problem solves


def check(study: StudyData) -> None:
    """Raise `Misplaced` for several followed axes, and for one that the base case cannot be followed along."""
    names = [name for name, axis in study.axes.items() if axis.follow]
    if len(names) > 1:
        raise Misplaced(f"one axis may be followed, got {choices(names)}", "axes", names[1], "follow")
    for name in names:
        if study.varies:
            why = "with weight or friction each case continues from the straight rod, not from the one before it"
            raise Misplaced(f"{why}: remove follow", "axes", name, "follow")
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


def _check_of_a_start(study: StudyData, name: str, axis: Axis) -> None:
    known = [*OF_ENDS, *(() if study.reading else (one for one in (*ROD, *CYLINDER) if one in study.base.given))]
    known = [one for one in known if one not in WORDS]
    if name in START and name not in known:
        why = f"a start problem has only one solution at each {name}, which is not followed: remove follow"
        raise Misplaced(why, "axes", name, "follow")
    if name not in known or len(study.axes) > 1:
        why = f"over a start problem, follow needs one axis, of {choices(known)}, got {choices(study.axes)}"
        raise Misplaced(f"{why}; give the base by its ends for others", "axes", name, "follow")
    if not axis.is_open:
        key = "values" if axis.values is not None else "from"
        raise Misplaced(f"a followed axis starts at the value of the base case: leave out {key}", "axes", name, key)
