"""Studies and their laws: the study language (TOML), Table 1 and its readings, verdicts."""

from typing import Any

from . import tenants
from .language.loader import load, loads, names
from .language.study import Study
from .laws.judgement import Law
from .laws.line_verdicts import Verdict, judge

__version__ = "0.3.0"
__all__ = ["READINGS", "TABLE_1", "Law", "Reading", "Study", "Verdict", "judge", "load", "loads", "names"]


def __getattr__(name: str) -> Any:
    """What the tenant `studies.paper` gives."""
    if name not in ("READINGS", "TABLE_1", "Reading") or not tenants.is_there("studies.paper"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(tenants.module_of("studies.paper.readings"), name)


def __dir__() -> list[str]:
    """The public names: what completion shows."""
    return [*__all__, "__version__"]
