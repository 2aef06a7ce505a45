"""What is studied, and which laws must hold: studies as TOML, Table 1 and its readings, verdicts."""

from .laws import Law, Verdict, judge
from .loader import load, names
from .model import Study
from .readings import READINGS, TABLE_1, Reading

__all__ = ["READINGS", "TABLE_1", "Law", "Reading", "Study", "Verdict", "judge", "load", "names"]
