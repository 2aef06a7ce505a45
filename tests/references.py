"""Reads references.json: the start cases by Taylor series in forty digits (benchmarks/make_references.py)."""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Reference:
    """One case at shares u of its length, all (8,), and the growth of a change of its start."""

    u: np.ndarray
    beta: np.ndarray
    dbeta: np.ndarray
    alpha: np.ndarray
    z: np.ndarray
    swirl: np.ndarray
    condition: float


@cache
def references() -> dict[str, Reference]:
    text = (Path(__file__).parent / "references.json").read_text(encoding="utf-8")
    data = json.loads(text)
    u = np.array(data["u"])
    columns = ("beta", "dbeta", "alpha", "z", "swirl")
    return {
        name: Reference(u, *(np.array(row[c]) for c in columns), condition=row["condition"])
        for name, row in data["cases"].items()
    }
