"""Studies as text, small ones that solve in no time, and the shipped ones solved once."""

import json
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

from studies import Study, load
from studies.grammar.axes import Axis
from studies.language.loader import loads
from workbench.run import in_memory

ROD = {"E": 1.07e4, "nu": 0.25, "a": 0.25, "L": 20.0, "R": 0.75}  # of Table 1, with its cylinder
SHORT = {**ROD, "L": 5.0}
HEAD = 'title = "one"\nreading = "force-first/tension/paper"\n[units]\nlength = "cm"\nforce = "N"\n'


def lines(keys: Mapping[str, Any]) -> str:
    """Keys and values in TOML; what is None is left out."""
    return "".join(f"{key} = {_value(value)}\n" for key, value in keys.items() if value is not None)


def _value(value: Any) -> str:
    if not isinstance(value, Mapping):
        return json.dumps(value)
    return "{ " + ", ".join(f"{key} = {_value(of)}" for key, of in value.items()) + " }"


def axis(name: str, values: Any, **keys: Any) -> str:
    """An axis of a list of values, or of (first, last, count)."""
    spread = (
        dict(zip(("from", "to", "count"), values, strict=True)) if isinstance(values, tuple) else {"values": values}
    )
    return f"[axes.{name}]\n{lines(spread | keys)}"


def law(observable: str, axis: str, direction: str | None = None, **keys: Any) -> str:
    """A law of an observable along an axis."""
    said = {"claim": "(1)", "observable": observable, "axis": axis, "direction": direction, "source": "s"}
    return f"[[laws]]\n{lines(said | keys)}"


def text(base: Mapping[str, Any], tables: str = "", units: str = "cm N", **keys: Any) -> str:
    """A study: its keys, its base case but for the fields that are axes of the tables, and these tables."""
    length, force = units.split()
    fields = lines({name: value for name, value in base.items() if f"[axes.{name}]" not in tables})
    head = lines({"title": "a study", **keys, "units": {"length": length, "force": force}})
    return f"{head}{fields and '[base]'}\n{fields}{tables}"


TEXT = text(
    {},
    axis("E", [1e4, 2e4])
    + axis("R", [0.5, 0.75, 1.0])
    + law("kappa_max", "R", "falls", claim="(2)", also=["turns_around"], source="a sentence of the paper"),
    title="two moduli and three radii",
    reading="force-first/tension/paper",
    observables=["bends", "turns_around"],
    outputs=["beta", "alpha", "z", "F1"],
    stations=21,
)


THREE = (
    axis("E", (5e3, 4e4, 5), spacing="geometric")
    + axis("R", [1.0, 0.5, 0.75])
    + axis("F1", (1.0, 9.0, 9))
    + law("bends", "E", "falls", at={"R": 0.75, "F1": 5.0})
)


def grid() -> Study:
    return loads(TEXT, default_name="small")


def six() -> xr.Dataset:
    """The six cases of `grid`; what is changed in them is changed for this test alone."""
    return _solve_six().copy(deep=True)


@cache
def _solve_six() -> xr.Dataset:
    return in_memory.run(grid())


def study(axes: str = "", head: str = "", name: str = "small") -> Study:
    """A study of Table 1 at 21 stations, with other axes and further keys."""
    start = HEAD.replace("one", "small").replace("[units]", f"stations = 21\n{head}\n[units]")
    return loads(start + axes, default_name=name)


def study_dataset(name: str) -> xr.Dataset:
    """A shipped study, a refined one on its coarse grid; what is changed in it is changed for this test alone.

    Of a study whose rods leave the cylinder the first, the middle and the last rod: each costs a second.
    """
    return _solve_shipped(name, whole=False).copy(deep=True)


@cache
def _solve_shipped(name: str, whole: bool) -> xr.Dataset:
    study = load(name)
    if study.leaves:
        pytest.importorskip("unopy", reason="the extra contact is not installed")
        if not whole:
            study = study.model_copy(update={"axes": {axis: _three(values) for axis, values in study.axes.items()}})
    return in_memory.run(study.coarse())


def whole_study_dataset(name: str) -> xr.Dataset:
    """A shipped study with all of its cases."""
    return _solve_shipped(name, whole=True).copy(deep=True)


def _three(axis: Axis) -> Axis:
    """The first, the middle and the last value of an axis."""
    if axis.values is None:
        return axis.model_copy(update={"count": 3})
    return axis.model_copy(update={"values": [axis.values[i] for i in (0, len(axis.values) // 2, -1)]})


def with_outcomes(ds: xr.Dataset, words: Any) -> xr.Dataset:
    """The dataset with other outcomes, of the shape of its cases; those that begin with `solved` are solved."""
    texts = np.array(words, dtype=object).reshape(ds["outcome"].shape)
    solved = np.char.startswith(texts.astype(str), "solved")
    return ds.assign(outcome=ds["outcome"].copy(data=texts), solved=ds["solved"].copy(data=solved))
