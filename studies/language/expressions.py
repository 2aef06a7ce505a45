"""The expressions of a study: observables given by formulas, the names that formulas may use, and their values."""

import re
from collections.abc import Mapping
from fractions import Fraction
from keyword import iskeyword
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver import InputError, Solution
from solver.observe.observables import OBSERVABLES
from solver.problem.declared_fields import FIELDS
from solver.problem.dimensionless import flat
from solver.problem.quantities import QUANTITIES, RENAMED, unit_text

from ..grammar.axes import WORDS, Misplaced, quantity_of
from ..grammar.formulas import (
    CONSTANTS,
    FUNCTIONS,
    IN,
    NAMED,
    PLAIN,
    Dimension,
    Formula,
    dimension,
    evaluate,
    is_zero,
    parse,
    size_of,
    unit_words,
)
from ..laws.judgement import Law
from .study import Study

MOST_EXPRESSIONS = 100
MOST_NAME = 40  # characters
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
RESERVED = (  # names in files
    "xyz", "director", "sample", "level", "outcome", "pair", "fold", "fold_dbeta0", "fold_energy", "member", "side",
)  # fmt: skip

# Numbers of each case beside the fields of the study: how each is taken from a solution.
LOADS = ("FZ", "MZ", "M3")
OF_CASE = ("rho", "bending_stiffness", "torsional_stiffness", *LOADS, "error", "condition")


def dimension_of(name: str) -> Dimension:
    """The dimension of a quantity or of a field of a case; an angle and a count are plain numbers."""
    exponents = quantity_of(name).dimension
    if isinstance(exponents, str):
        return (Fraction(-1), Fraction(0)) if exponents == "rad/length" else PLAIN
    return Fraction(exponents[0]), Fraction(exponents[1])


def names(study: Study) -> dict[str, Dimension]:
    """The names that the laws of a study may use, with their dimensions: units, numbers of each case, observables.

    The fields of the case are those that `[base]`, `[axes]`, Table 1 of a reading, or a default give.
    """
    known = unit_names(study.unit_system)
    for name in (*fields_with_values(study), *OF_CASE, *OBSERVABLES):
        known[name] = dimension_of(name)
    for name, text in study.expressions.items():
        known[name] = own_dimension(text, known, study.unit_system)
    return known


def own_dimension(text: str, known: Mapping[str, Dimension], units: Mapping[str, str]) -> Dimension:
    """The dimension of an expression in the formulas that use it; one with a unit is a plain number, counted in it.

    Raises `InputError` for a unit of another dimension than that of the formula.
    """
    formula = parse(text)
    dim = dimension(formula, known, units)
    if not formula.unit:
        return dim
    unit_dim = size_of(formula.unit, units)[1]
    if dim != unit_dim and not is_zero(formula):
        expression = text.partition(IN)[0]
        raise InputError(f"{expression!r} is {unit_words(dim, units)}, which has no value in {formula.unit}")
    return PLAIN


def unit_names(units: Mapping[str, str]) -> dict[str, Dimension]:
    """The units of a study as names, each the number 1: ``cm`` and ``N``, so that ``10*cm`` is a length."""
    return {
        "inch" if units["length"] == "in" else units["length"]: (Fraction(1), Fraction(0)),
        units["force"]: (Fraction(0), Fraction(1)),
    }


def check(study: Study) -> None:
    """Raise `Misplaced` unless every expression has a free name, a valid formula, names above it and fitting units."""
    if len(study.expressions) > MOST_EXPRESSIONS:
        raise Misplaced(
            f"{len(study.expressions)} expressions, more than the limit of {MOST_EXPRESSIONS}", "expressions"
        )
    taken = {*QUANTITIES, *RENAMED, *FIELDS, *FUNCTIONS, *CONSTANTS, *RESERVED, *unit_names(study.unit_system)}
    for name in study.expressions:
        if not NAME.fullmatch(name) or len(name) > MOST_NAME or iskeyword(name):
            rule = f"must be at most {MOST_NAME} letters, digits and _ that begin with a letter"
            raise Misplaced(f"the name of an expression {rule}, got {name[:60]!r}", "expressions", name)
        if name in taken or name.endswith(("_error", "_along")):
            raise Misplaced(f"the name {name!r} is taken; choose another for the expression", "expressions", name)
    known = names(study.model_copy(update={"expressions": {}}))
    for name, text in study.expressions.items():
        try:
            below = [other for other in parse(text).names if other in study.expressions and other not in known]
            if below:
                raise InputError(f"{below[0]!r} is not above this expression, which can use only those above it")
            known[name] = own_dimension(text, known, study.unit_system)
            claim = name.rpartition("_")[2]
            if claim in NAMED and known[name] != PLAIN and size_of(claim, study.unit_system) != (1.0, known[name]):
                actual = unit_words(known[name], study.unit_system)
                raise InputError(f'{name} names {claim}, but is {actual}: give {{ formula = "...", unit = "..." }}')
        except InputError as error:
            raise Misplaced(str(error), "expressions", name) from None


def check_law(study: Study, number: int, law: Law) -> None:
    """Raise `Misplaced` unless the formulas of a law use known names and have the unit of what they stand for.

    Beside the names of `names` they may use the estimated errors of what the study stores.
    """
    known, units = names(study), study.unit_system
    known |= {f"{name}_error": known[name] for name in study.wanted if f"{name}_error" in study.columns}
    for key, formula in law.formulas.items():
        owner = law.axis if key == "x" else law.observable
        try:
            if formula.unit:
                raise InputError(f"{formula.text!r} has a unit, as only an expression may have")
            dim, owner_dim = dimension(formula, known, units), known[owner]
            if dim != owner_dim and not is_zero(formula):
                why = f"{formula.text!r} is {unit_words(dim, units)}, but {owner} is {unit_words(owner_dim, units)}"
                raise InputError(why)
        except InputError as error:
            raise Misplaced(str(error), "laws", number, key) from None


def unit(study: Study, name: str) -> str:
    """The unit of an expression: its own, or that of its formula in the units of the study."""
    if text := parse(study.expressions[name]).unit:
        return text
    return unit_text(names(study)[name], study.unit_system)


def values_of(
    study: Study, sol: Solution, observed: Mapping[str, NDArray[Any]], given: Mapping[str, Any]
) -> tuple[dict[str, NDArray[Any]], list[tuple[str, NDArray[np.bool_]]]]:
    """The expressions of a study of one solution with their errors, (cases,) each; why values are missing, and where.

    observed: the values and errors of `Study.observed`, (cases,) each. given: those of the fields that vary, as the
    study gives them.
    """
    formulas = {name: parse(text) for name, text in study.expressions.items()}
    used = dict.fromkeys(name for formula in formulas.values() for name in formula.names)
    others = [name for name in used if name not in observed and name not in formulas]
    known = {**observed, **{name: _number(study, sol, name, given) for name in others}}
    computed: dict[str, NDArray[Any]] = {}
    missing = []
    for name, formula in formulas.items():
        numbers, reasons = evaluate(formula, known)
        values, why = np.broadcast_to(numbers, sol.case.size), np.broadcast_to(reasons, sol.case.size)
        sentences = [reason for reason in dict.fromkeys(why.tolist()) if reason]
        missing += [(f"{name} is not defined: {reason}", why == reason) for reason in sentences]
        size = size_of(formula.unit, study.unit_system)[0] if formula.unit else 1.0
        if not formula.whole:
            computed[f"{name}_error"] = _error(formula, known, values) / size
        computed[name] = values / size
        known |= computed
    return computed, missing


def _error(formula: Formula, known: Mapping[str, Any], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The sum over the names of the largest change of a formula when that name changes by its error."""
    total = np.zeros(values.shape)
    for name in formula.names:
        error = known.get(f"{name}_error")
        if error is None:
            continue
        changed = [evaluate(formula, {**known, name: known[name] + sign * error})[0] for sign in (-1, 1)]
        total = total + np.maximum(*(np.abs(value - values) for value in changed))
    return total + 8 * 2.0**-52 * np.abs(values)


def _number(study: Study, sol: Solution, name: str, given: Mapping[str, Any]) -> Any:
    """A number of each case by its name, (cases,) or one for all."""
    if name in unit_names(study.unit_system):
        return 1.0
    case = sol.case
    if name in ("error", "condition", *LOADS):
        return np.reshape(getattr(sol, name), -1).astype(float)
    if name in OF_CASE:
        return flat(getattr(case if name == "rho" else case.rod, name), case.shape)
    if not study.reading or name == study.variation.followed:
        for part in (case.rod, case.cylinder, case.given):
            if getattr(part, name, None) is not None:
                return flat(getattr(part, name), case.shape)
    if name in given:
        return np.reshape(given[name], -1)
    return float(study.constants[name])


def fields_with_values(study: Study) -> list[str]:
    """The numeric fields of the case that have a value in every case: given, on an axis, or by default."""
    fixed = study.constants
    varied = [name for name in study.variation.fields if name not in study.fields]
    known = [name for name in study.fields if name in fixed or name in study.variation.fields]
    excluded = ("dbeta",) if study.variation.from_base else ()  # a followed equilibrium has its own
    return [name for name in (*known, *varied) if name not in (*WORDS, *excluded)]
