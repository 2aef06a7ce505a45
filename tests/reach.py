"""Which method is tried on which case by default: all pairs are tried, but those that take long only with -m slow."""

from typing import Any

import pytest

from solver.methods import available

# tried on everything, and asked for so much; whoever comes later is asked for as many digits as its order and one
TOLERANCES = {
    "orbit": (1e-6, 1e-12), "swing": (1e-6, 1e-12), "dop853": (1e-9,), "verlet": (1e-4,),
    "shooting": (1e-8,), "difference": (1e-6,),
}  # fmt: skip
EASY = ("helix at a centre, inside", "inside, twisted", "nearly straight")


def core(kind: str) -> list[str]:
    """The methods of one kind of problem that every law is held against by default."""
    able = available()
    return [name for name in TOLERANCES if name in able and kind in able[name].problems]


MANY_STEPS = {("dop853", "elliptic k=0.25 L=300"), ("verlet", "just passing 135 degrees")}


def matrix(kind: str, names: list[str]) -> list[Any]:
    """(case, method, tol) for every case and every method of this kind."""
    rows = []
    for method in available().values():
        if kind in method.problems:
            for tol in TOLERANCES.get(method.name, (max(10 ** -(1 + method.order), 1e-8),)):
                for name in names:
                    long = (method.name not in TOLERANCES and name not in EASY) or (method.name, name) in MANY_STEPS
                    rows.append(pytest.param(name, method.name, tol, marks=[pytest.mark.slow] if long else []))
    return rows
