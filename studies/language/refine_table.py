"""The table [refine] of a study: what is watched, and how finely its boundary is located."""

from math import prod

import numpy as np
from numpy.typing import NDArray

from solver.observe.observables import OBSERVABLES, is_count
from solver.problem.errors import choices, near

from ..grammar.axes import Misplaced, Values, no_key
from ..grammar.formulas import parse
from ..laws.case_rows import Grid
from ..laws.judgement import Law, by_line
from .refinement import OUTCOME, RefinedLines, Refinement
from .study import Study

LEVEL = "level"  # the coordinate of a refined study: how many halvings made a case
MOST_PLACES = 2**31  # along an axis
APART = 1e-14  # least relative difference of neighbouring values


def check(study: Study) -> None:
    """Raise `Misplaced` unless the table fits the axes and the observables of the study."""
    table = study.refine
    assert table is not None
    if not 1 <= len(study.axes) <= 2:
        has = f"{len(study.axes)}: {choices(study.axes)}" if study.axes else "none"
        raise Misplaced(f"refine works along one axis or in the plane of two axes, and the study has {has}", "refine")
    if study.variation.followed is not None:
        raise Misplaced("a followed axis excludes refine: its cases continue from one another", "refine")
    for name, axis in study.axes.items():
        if axis.size < 2:
            raise Misplaced(f"refine needs at least two values of each axis, and {name} has one", "axes", name)
    size = prod(axis.size for axis in study.axes.values())
    if table.budget < size:
        grid = " x ".join(str(axis.size) for axis in study.axes.values())
        why = f"budget must be at least the {size} cases of the coarse grid ({grid}), got {table.budget}"
        raise Misplaced(why, "refine", "budget")
    for name in table.watch:
        _check_watched(study, name, name in table.steps)
    for claim in table.laws:
        _check_law(study, claim)
    check_equilibrium(study, "refine solves many")
    _check_finest(study)


def _check_law(study: Study, claim: str) -> None:
    """Raise `Misplaced` unless one law has this claim, uses no formula, and has lines beside each other."""
    known = [law.claim for law in study.laws]
    if known.count(claim) != 1:
        why = "two laws have that claim" if claim in known else f"choose from {choices(known) or 'none'}"
        raise Misplaced(f"no law {claim!r}{near(claim, known)}: {why}", "refine", "laws")
    if len(study.axes) < 2:
        why = f"the verdict of {claim} changes from line to line in the plane of two axes, and the study has one axis"
        raise Misplaced(why, "refine", "laws")
    if study.laws[known.index(claim)].formulas:
        raise Misplaced(f"the law {claim} has a formula; watch a law of numbers alone", "refine", "laws")


def _check_watched(study: Study, name: str, has_step: bool) -> None:
    """Raise `Misplaced` unless a watched name is known, and a real number has its step."""
    known = (*OBSERVABLES, *study.expressions, OUTCOME)
    if name not in known:
        raise no_key("observable", name, known, "refine", "watch")
    if name == OUTCOME:
        whole = True
    else:
        whole = parse(study.expressions[name]).whole if name in study.expressions else is_count(name)
    if not (whole or has_step):
        why = f"{name} is a real number: [refine.steps] needs the change of {name} that counts"
        raise Misplaced(why, "refine", "watch")
    if name == OUTCOME and has_step:
        raise Misplaced("the outcome is solved or not, and has no step", "refine", "steps", name)


def _check_finest(study: Study) -> None:
    """Raise `Misplaced` where the finest values of an axis would not be distinct."""
    table = study.refine
    assert table is not None
    key = "points" if table.tolerance is None else "tolerance"
    grid = table.lattice(study.axes)
    for (name, values), places in zip(grid.axes.items(), grid.sizes, strict=True):
        step = np.diff(values).min() / 2.0**grid.depth
        if not (places < MOST_PLACES and step > APART * np.abs(values).max()):
            why = f"the values of {name} would differ by less than their last digits: give a larger step of refinement"
            raise Misplaced(why, "refine", key)


def refinement(study: Study) -> Refinement:
    """The refinement of a study before anything is solved."""
    table = study.refine
    assert table is not None
    steps = [*table.changes.values(), *(np.inf for _ in table.laws)]
    lines = [_lines(study, law, i) for i, law in enumerate(laws_to_watch(study), len(table.watch))]
    return Refinement(table.lattice(study.axes), np.array(steps, dtype=float), table.budget, tuple(lines))


def laws_to_watch(study: Study) -> list[Law]:
    """The laws whose verdict is watched."""
    return [law for claim in (study.refine.laws if study.refine else ()) for law in study.laws if law.claim == claim]


def _lines(study: Study, law: Law, column: int) -> RefinedLines:
    """The lines of a watched law, whose observable is this column of the numbers."""
    along = np.sort(study.axes[law.axis].numbers())
    text = study.expressions.get(law.observable)
    counts = [law.observable] if text is not None and parse(text).whole else []

    def judge(values: Values) -> NDArray[np.str_]:
        grid = Grid({"line": np.arange(len(values)), law.axis: along}, counts=counts)
        return by_line(law.model_copy(update={"at": {}}), values, grid)

    return RefinedLines(list(study.axes).index(law.axis), column, judge)


def check_equilibrium(study: Study, several: str) -> None:
    """Raise `Misplaced` where a study of several cases, as the words say, names the equilibrium of one."""
    if study.equilibrium is not None and study.equilibrium.dbeta0 is not None:
        why = f"dbeta0 and energy name the equilibrium of one case, and {several}: give choose or index"
        raise Misplaced(why, "equilibrium", "dbeta0")
