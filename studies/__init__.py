"""Studies and their laws: the study language (TOML), Table 1 and its readings, verdicts."""

from .language.loader import load, loads, names
from .language.study import Study
from .laws.line_verdicts import Verdict, judge
from .laws.verdicts import Law
from .paper.readings import READINGS, TABLE_1, Reading

__version__ = "0.2.0"
__all__ = ["READINGS", "TABLE_1", "Law", "Reading", "Study", "Verdict", "judge", "load", "loads", "names"]


def __dir__() -> list[str]:
    """The public names: what completion shows."""
    return [*__all__, "__version__"]
