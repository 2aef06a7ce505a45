"""The tables by which a notebook shows a case, a solution and a list of equilibria."""

from dataclasses import fields
from html import escape
from typing import Any

import numpy as np

from solver import Case, Solution
from solver.equilibria import Equilibria
from solver.equilibrium_list import stability
from solver.observe.observables import observe
from solver.problem.quantities import quantity, unit_of

from .words import cautions, labels

NUMBERS = ("turns", "wraps", "height", "kappa_max", "push_min", "push_max")  # of a solution's table
WORDS = {"length": "length", "force": "force"}  # units of a solution, which knows none
HEADINGS = ("", "stability", "energy [force length]", "bends", "beta'(0) [rad/length]", "pushed share")


def of_solution(sol: Solution) -> str:
    """Outcome, accuracy and a few observables."""
    each = np.asarray(sol.solved)
    rows = [("solved", f"{int(each.sum())} of {each.size}")] if each.size > 1 else [("outcome", str(sol.outcome))]
    rows += [("method", sol.method), ("estimated error", f"{np.max(sol.error):.1e}")]
    rows += [("condition number", f"{np.max(sol.condition):.3g}")]
    if each.any():
        values = observe(sol, list(NUMBERS))
        rows += [(_words(name), _span(name, np.asarray(values[name], dtype=float)[each])) for name in NUMBERS]
        rows += [("caution", caution)] if (caution := cautions.said(cautions.of_cases(sol))) else []
    shape = f" of {each.size} cases" if each.size > 1 else ""
    return _table(f"Solution{shape}, {sol.t.shape[-1]} stations", rows)


def of_case(case: Case) -> str:
    """The fields of its parts."""
    rows = []
    for part in (case.rod, case.cylinder, case.given):
        name = type(part).__name__
        for field in fields(part):
            value = getattr(part, field.name)
            if value is not None and not (field.name == "stiffness" and case.rod.EI is not None):
                rows.append((f"{name}.{field.name}", _field(value)))
    grid = f" of shape {case.shape}" if case.shape else ""
    return _table(f"{'Ends' if case.kind == 'ends' else 'Start'} problem{grid}", rows)


def of_equilibria(found: Equilibria) -> str:
    """A row for each equilibrium."""
    held = "held " if found and found[0].solution.held else ""
    head = "".join(f"<th>{escape(f'{held}{name}' if name.startswith('energy') else name)}</th>" for name in HEADINGS)
    rows = []
    for i, equilibrium in enumerate(found, 1):
        numbers = (
            stability(equilibrium.index),
            f"{equilibrium.energy:.6g}",
            str(equilibrium.turns),
            f"{equilibrium.dbeta0:.6g}",
            f"{equilibrium.attached:.0%}",
        )
        cells = "".join(f"<td>{labels.minus_signs(escape(number))}</td>" for number in numbers)
        rows.append(f"<tr><th>{i}</th>{cells}</tr>")
    remark = found.remark or "the list passes the test of completeness"
    caption = f"{len(found)} {'equilibrium' if len(found) == 1 else 'equilibria'}: {remark}"
    return f"<table><caption>{escape(caption)}</caption><tr>{head}</tr>{''.join(rows)}</table>"


def of_laws(caption: str, rows: list[tuple[str, str]]) -> str:
    """A law in words and its verdict in each row."""
    return _table(caption, rows)


def _table(caption: str, rows: list[tuple[str, str]]) -> str:
    left = 'style="text-align: left"'  # Jupyter's own style sets numbers and sentences flush right
    lines = "".join(f"<tr><th>{escape(words)}</th><td {left}>{escape(value)}</td></tr>" for words, value in rows)
    return f"<table><caption>{escape(caption)}</caption>{labels.typeset(lines)}</table>"


def _field(value: Any) -> str:
    """A number, a word, or the span of an array."""
    if isinstance(value, str):
        return value
    low, high = (f"{float(end):.6g}" for end in (np.min(value), np.max(value)))
    return low if np.ndim(value) == 0 else f"{np.size(value)} values from {low} to {high}"


def _words(name: str) -> str:
    return quantity(name).long_name.partition(" (")[0].partition(",")[0]


def _span(name: str, values: Any) -> str:
    """A value, or the smallest and the largest, with the unit in words."""
    low, high = (labels.number(float(value)) for value in (values.min(), values.max()))
    unit = labels.unit(unit_of(name, WORDS))
    return f"{low if low == high else f'{low} to {high}'}{f' [{unit}]' if unit else ''}"
