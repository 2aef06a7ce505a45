"""What the model leaves out, in one sentence: a help to judge a pipe.

`docs/explanation/what-the-model-leaves-out.md` says how much each of these may change.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

    from solver import Case


NO_LOAD = "the curvature of the hole", "fluid flow", "temperature", "yielding"  # what no number of a case stands for


def sentence(given: Mapping[str, Any], *more: str) -> str:
    """What is left out where `given` holds the values of weight, friction and sliding, each if there is one, and more.

    A picture has room for the first of them.
    """
    parts = [name for name in ("weight", "friction") if not np.any(given.get(name, 0))]
    if "friction" not in parts and given.get("sliding") != "rotating":
        parts.append("the moment of friction about the rod's own axis")
    parts += ["joints", "clearance at the ends", *more]
    return f"The model leaves out {', '.join(parts[:-1])}{',' * (len(parts) > 2)} and {parts[-1]}."


SENTENCE = sentence({})


def note(case: "Case") -> str:
    """The sentence that belongs to a rod inside a cylinder; "" for one outside."""
    if case.cylinder.side != "inside":
        return ""
    wall = case.cylinder
    return sentence({"weight": case.rod.weight, "friction": wall.friction, "sliding": wall.sliding}, *NO_LOAD)


def note_of_dataset(ds: "xr.Dataset") -> str:
    """The same of a stored rod, or of several."""
    if str(ds.attrs["side"]) != "inside":
        return ""
    given = {name: ds[name].values for name in ("weight", "friction") if name in ds}
    return sentence(given | {"sliding": ds.attrs.get("sliding")})
