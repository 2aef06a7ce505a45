"""The recipe of a run: all that its numbers depend on, by which a later run knows whether it continues this one."""

import hashlib
import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import solver
import studies
from solver.methods import METHODS, VARYING, available
from solver.problem.errors import InputError
from studies import Law, Study
from studies.grammar.axes import Dimensions
from studies.language.refine import lattice

from .schema import version_of


def recipe_of(study: Study, dimensions: Dimensions, block: int) -> dict[str, Any]:
    """Everything the numbers depend on, as it comes back from JSON.

    Two runs of one recipe give the same bits on the same kind of machine.
    """
    required = [METHODS[study.method].requires] if study.method in METHODS and METHODS[study.method].requires else []
    laws = {str(i): _law_line(law) for i, law in enumerate(study.laws, 1)}
    data = {
        "units": study.unit_system,
        "reading": study.reading or "",
        "base": study.base.given,
        "equilibrium": study.equilibrium.model_dump(exclude_none=True) if study.equilibrium else {},
        "order": list(dimensions.names),
        "axes": {name: axis_line(values) for name, values in dimensions.fields.items()},
        **({} if study.refine is None else {"refine": _refine_lines(study)}),
        **_follow_line(study),
        "stations": study.stations,
        "outputs": sorted(study.outputs),
        "observables": sorted(study.wanted),
        "expressions": dict(study.expressions),
        "laws": laws,  # their verdicts are stored as well
        "tol": study.tol,
        "method": study.method,
        "block": block,
        "code": code_version(),
        **{package: version_of(package) for package in ("numpy", "scipy", *required)},
    }
    plain: dict[str, Any] = json.loads(json.dumps(data))
    return plain


def differences(was: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """The differences of two recipes in words: ``tol was 1e-08, now 1e-09``."""
    sentences = []
    for key in dict.fromkeys([*was, *now]):
        before, after = was.get(key), now.get(key)
        if isinstance(before, dict) and isinstance(after, dict):
            sentences += [f"{key}.{difference}" for difference in differences(before, after)]
        elif before != after:
            sentences.append(f"{key} was {_tell(before)}, now {_tell(after)}")
    return sentences


@cache
def code_version() -> str:
    """The version of the package and a digest of the sources that make the numbers."""
    mechanics, language = Path(solver.__file__).parent, Path(studies.__file__).parent
    sources = [*mechanics.rglob("*.py"), *mechanics.rglob("*.[ch]"), *language.rglob("*.py")]
    content = b"".join(path.name.encode() + path.read_bytes() for path in sorted(sources))
    return f"{version_of('rod-workbench')}+{_digest(content)}"


def check_worker(study: Study, code: str) -> None:
    """Raise `InputError` where this process would give other numbers: other code, or a method that is missing."""
    if code_version() != code:
        raise InputError(f"a worker has the code {code_version()}, but the run was started with {code}")
    if study.method not in (*available(), *VARYING.values()):
        raise InputError(f"a worker has no method {study.method!r}: install there what is installed here")


def versions_of_code() -> set[str]:
    """The keys of a recipe that are not the study: code, packages, block."""
    return {"code", "numpy", "scipy", "block", *(method.requires for method in METHODS.values())}


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=6).hexdigest()


def axis_line(values: NDArray[np.float64]) -> str:
    """An axis in one line, with a digest of its values."""
    return f"{values.size} values {values[0]:g}..{values[-1]:g} ({_digest(values.tobytes())})"


def _follow_line(study: Study) -> dict[str, Any]:
    """The followed axis; of a start problem its limit and size, as the run finds its values."""
    if study.follow is not None:
        return {"follow": {"axis": study.followed, "to": study.follow.limit, "count": study.follow.size}}
    return {} if study.followed is None else {"follow": study.followed}


def _refine_lines(study: Study) -> dict[str, Any]:
    """The refinement: its keys, the coarse grid, and how often that is halved."""
    assert study.refine is not None
    grid = lattice(study)
    lines = {name: axis_line(values) for name, values in grid.axes.items()}
    return {
        **lines,
        "geometric": sorted(grid.geometric),
        "watch": study.refine.changes,
        "laws": study.refine.laws,
        "halvings": grid.depth,
        "budget": study.refine.budget,
    }


def _law_line(law: Law) -> str:
    """A law in one line."""
    return ", ".join(f"{name} {value}" for name, value in law.model_dump(exclude_defaults=True).items())


def _tell(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(map(str, value)) or "none"
    return "missing" if value is None else str(value)
