"""The command check: judge the laws of a stored study."""

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .options import File, Json
from .study_result import print_result

if TYPE_CHECKING:
    import xarray as xr


def check(file: File, json: Json = False) -> int:
    """Judge the laws of a stored study.

    Exit status 1 if a case is unsolved, or if a law fails, is not decided or is qualified.
    """
    from solver.problem import angles
    from studies.language.loader import notices

    from ..store import file_checks, reading

    with reading.open_study(file, whole=True) as ds, file_checks.refusing(file):
        found = _verdicts_of(ds, file)
        text = str(ds.attrs.get("study", ""))
    for sentence in notices(text, f"{file.name}, its study"):
        angles.warn(sentence)
    return print_result(found, json)


def _verdicts_of(ds: "xr.Dataset", path: Path) -> dict[str, Any]:
    """The counts and verdicts of a dataset, computed from its numbers."""
    import numpy as np

    from ..store import law_verdicts, schema
    from ..words import branch_numbers
    from ..words.outcomes import group

    outcomes, caution = ([str(text) for text in np.ravel(ds[name].values)] for name in ("outcome", "caution"))
    counts = branch_numbers.counts(ds["branch"].values) if "branch" in ds else None
    return {
        "title": ds.attrs["title"],
        "study": ds.attrs["study_name"],
        "equilibria": str(ds.attrs.get("equilibria", "")),
        "branches": branch_numbers.sentence(counts) if counts else "",
        **{name: str(ds.attrs[name]) for name in schema.SAMPLING if name in ds.attrs},
        "reading": ds.attrs["reading"],
        "file": str(path),
        "unsolved": law_verdicts.unsolved(ds),
        "outcomes": group(Counter(outcomes)),
        "cautions": Counter(caution),
        "laws": law_verdicts.verdicts(ds),
    }
