"""Write the formulas of the solver as JavaScript, for pages: workbench/web/live/page/formulas.mjs.

The functions that the solver runs are run on terms in place of numbers, which write down what is computed of them; its
tables of fields stand before them. Run from the root: python -m benchmarks.make_page_formulas
"""

import json
from dataclasses import fields
from types import SimpleNamespace
from typing import Any

import numpy as np

from solver import Cylinder, Rod, Start
from solver.observe.measurement import MeasuredNumbers
from solver.observe.observables import OBSERVABLES
from solver.orbits.potential import Loads, potential
from solver.problem.case import DIRECT, ELASTIC, GIVEN, SIDES, SLIDING, STIFFNESS, TWISTS, Case
from solver.problem.declared_fields import ANGLES, PAIRS, RANGES
from solver.problem.dimensionless import dimensionless_problem
from solver.problem.units import FORCES, LENGTHS, unit_size
from workbench.web.live.live_document import PAGE
from workbench.words.caution_words import LINEAR
from workbench.words.unit_habits import HABITS

FILE = PAGE / "formulas.mjs"
HEAD = """// Tables and formulas of the solver, written by benchmarks/make_page_formulas.py: change them there.
// v: fields of a case by name; A, C, rho, and the loads FZ, MZ and M3; the numbers of its problem; what is measured.

"""
WRITTEN = {
    "add": "({} + {})", "subtract": "({} - {})", "multiply": "({} * {})", "divide": "({} / {})", "power": "{} ** {}",
    "negative": "(-{})", "sin": "Math.sin({})", "cos": "Math.cos({})",
}  # fmt: skip


class Term(np.lib.mixins.NDArrayOperatorsMixin):
    """A number that is known by its text in JavaScript alone."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any) -> "Term":
        return Term(WRITTEN[ufunc.__name__].format(*map(text_of, inputs)))


def text_of(value: Any) -> str:
    """A term or a number as JavaScript."""
    if isinstance(value, np.ndarray):
        (value,) = value.reshape(-1)
    return value.text if isinstance(value, Term) else repr(float(value)).removesuffix(".0")


class Terms:
    """Something of which each attribute that it lacks is the term of its name."""

    def __init__(self, **known: Any) -> None:
        vars(self).update(known)

    def __getattr__(self, name: str) -> Term:
        return Term(f"v.{name}")


def part(kind: type, **known: Any) -> Any:
    """A part of a case that is not validated: its fields are terms but for those that are known."""
    new = object.__new__(kind)
    terms = {field.name: Term(f"v.{field.name}") for field in fields(kind)}  # type: ignore[arg-type]
    vars(new).update(terms | known)
    return new


def rods(**known: Any) -> dict[str, Rod]:
    """A rod of each section, by the word of the section."""
    elastic = {word: part(Rod, EI=None, GJ=None, stiffness=word, **known) for word in STIFFNESS}
    return elastic | {GIVEN: part(Rod, **known)}


def case_of(side: str = "outside", **given: Any) -> Case:
    """A start problem whose radius rho and stiffness A are terms."""
    rod = part(Rod, bending_stiffness=Term("v.A"), stiffness_ratio=Term("(v.A / v.C)"), weight=None)
    case: Case = part(Case, rod=rod, cylinder=part(Cylinder, side=side, friction=None), given=part(Start, **given))
    return case


def loads(twist: str) -> dict[str, Any]:
    """FZ, MZ and M3 of a start problem that is given one of `TWISTS`."""
    case = case_of(**{name: None for name in TWISTS if name != twist})
    vars(case)["rho"] = Term("v.rho")
    return dict(zip(("FZ", "MZ", "M3"), case.loads, strict=True))


def numbers() -> dict[str, Any]:
    """The numbers of the dimensionless problem."""
    case = case_of()
    vars(case).update(rho=Term("v.rho"), loads=(Term("v.FZ"), Term("v.MZ"), Term("v.M3")), shape=())
    return dict(vars(dimensionless_problem(case, object)))


class Measured(Terms):
    """What an observable reads of a rod under dead loads, in terms of the numbers that pages measure."""

    def __init__(self) -> None:
        case = SimpleNamespace(cylinder=part(Cylinder, friction=None))
        sol = SimpleNamespace(case=case, trajectory=SimpleNamespace(orbit=None), problem=SimpleNamespace(span=1.0))
        known = {"length": Term("v.span"), "ratio": Term("(v.A / v.C)"), "gain": (Term("v.turned"), Term("v.risen"))}
        super().__init__(sol=sol, error=0.0, loads=(Term("v.FZ"), Term("v.MZ"), Term("v.M3")), **known)
        units = (name for name in vars(MeasuredNumbers) if name.startswith("unit_"))
        vars(self).update({name: getattr(MeasuredNumbers, name).func(self) for name in units})

    def value(self, name: str) -> Term:
        return Term(f"v.{name}")

    def error_of(self, name: str) -> float:
        return 0.0

    def middle(self, name: str) -> tuple[Term, float]:
        return Term(f"v.middle_{name}"), 0.0

    def scale(self, name: str, factor: Any) -> tuple[Any, Any]:
        return Term(f"v.{name}") * factor, 0.0


OBSERVED = (
    "FZ", "MZ", "M3", "amplitude", "turns_around", "height", "kappa_mean", "kappa_max", "contact_size_mean",
    "push_mean", "pull_mean", "push_min", "push_max", "push_max_at", "push_middle", "attached", "lift_off_at",
    "F3_size_max", "bending_moment_max", "bending_stress_max", "energy", "bending_energy", "twist_energy",
)  # fmt: skip


def formula(value: Any, indent: str = "") -> str:
    """A function in JavaScript of a term, or of a table of terms."""
    if isinstance(value, dict):
        rows = (f"{indent}  {name}: {_bare(term)},\n" for name, term in value.items())
        return f"(v) => ({{\n{''.join(rows)}{indent}}})"
    return f"(v) => {_bare(value)}"


def _bare(value: Any) -> str:
    """A term as text, without the brackets around all of it."""
    text = text_of(value)
    return text[1:-1] if text.startswith("(") and text.endswith(")") and _closes_last(text) else text


def _closes_last(text: str) -> bool:
    """Whether the first bracket of a text is closed by its last."""
    depths = np.cumsum([(sign == "(") - (sign == ")") for sign in text])
    return bool((depths[:-1] > 0).all())


def tables() -> dict[str, dict[str, Any]]:
    """The tables of the file: names and terms, or tables of terms."""
    measured: Any = Measured()
    return {
        "RHO": {side: case_of(side).rho for side in SIDES},
        "BENDING": {word: rod.bending_stiffness for word, rod in rods().items()},
        "TORSION": {word: rod.torsional_stiffness for word, rod in rods(bending_stiffness=Term("v.A")).items()},
        "LOADS": {twist: loads(twist) for twist in TWISTS},
        "OBSERVED": {name: OBSERVABLES[name].compute(measured)[0] for name in OBSERVED},
    }


def plain_tables() -> dict[str, Any]:
    """The tables of the fields of cases: names, partners, and where their values must be."""
    ranges = {
        name: {"low": row.low, "closed": row.closed} | ({"high": row.high} if np.isfinite(row.high) else {})
        for name, row in RANGES.items()
    }
    sides = {side: int(sign) for side, sign in SIDES.items()}
    words = {"TWISTS": TWISTS, "DIRECT": DIRECT, "ELASTIC": ELASTIC, "ANGLES": ANGLES, "SLIDING": [*SLIDING]}
    units = {"LENGTHS": LENGTHS, "FORCES": FORCES, "LINEAR": [*LINEAR.items()]}
    units |= {"HABITS": [[*habit, unit_size(habit[-1])[0]] for habit in HABITS]}
    return words | {"SIDES": sides, "HELD": dict(PAIRS), "RANGES": ranges} | units


def text() -> str:
    """The file."""
    parts = [f"export const {name} = {json.dumps(table)};\n" for name, table in plain_tables().items()]
    for name, rows in tables().items():
        lines = "".join(f"  {key}: {formula(value, '  ')},\n" for key, value in rows.items())
        parts.append(f"export const {name} = {{\n{lines}}};\n")
    own: Any = Terms()
    parts.append(f"export const problemOf = {formula(numbers())};\n")
    well = potential(Loads(own.lam, own.mu, own.phi), Term("beta"))
    parts.append(f"export const potential = (v, beta) => {_bare(well)};\n")
    return HEAD + "\n".join(parts)


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
