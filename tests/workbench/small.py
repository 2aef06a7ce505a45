"""Small studies that solve in no time."""

from typing import Any

import numpy as np
import xarray as xr

from studies import Study
from studies.language.loader import loads

TEXT = """
title = "two moduli and three radii"
reading = "force-first/tension/paper"
observables = ["turns", "wraps"]
outputs = ["beta", "alpha", "z", "F1"]
stations = 21

[units]
length = "cm"
force = "N"

[axes.E]
values = [1e4, 2e4]

[axes.R]
values = [0.5, 0.75, 1.0]

[[laws]]
claim = "(2)"
observable = "kappa_max"
axis = "R"
direction = "falls"
also = ["wraps"]
source = "a sentence of the paper"
"""


HEAD = 'title = "one"\nreading = "force-first/tension/paper"\n[units]\nlength = "cm"\nforce = "N"\n'


def grid() -> Study:
    return loads(TEXT, default_name="small")


def study(axes: str = "", head: str = "", name: str = "small") -> Study:
    """A study of Table 1 at 21 stations, with other axes and further keys."""
    units = '[units]\nlength = "cm"\nforce = "N"\n'
    start = 'title = "small"\nreading = "force-first/tension/paper"\nstations = 21\n'
    return loads(f"{start}{head}\n{units}{axes}", default_name=name)


def with_outcomes(ds: xr.Dataset, words: Any) -> xr.Dataset:
    """The dataset with other outcomes, of the shape of its cases; those that begin with `solved` are solved."""
    texts = np.array(words, dtype=object).reshape(ds["outcome"].shape)
    solved = np.char.startswith(texts.astype(str), "solved")
    return ds.assign(outcome=ds["outcome"].copy(data=texts), solved=ds["solved"].copy(data=solved))
