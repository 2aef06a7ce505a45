"""Studies and their laws: the study language (TOML), Table 1 and its readings, verdicts."""

from .law import Law
from .laws import Verdict, judge
from .loader import load, names
from .model import Study
from .readings import READINGS, TABLE_1, Reading

__all__ = ["READINGS", "TABLE_1", "Law", "Reading", "Study", "Verdict", "judge", "load", "names"]
