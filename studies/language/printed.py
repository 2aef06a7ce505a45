"""The key `reading` of a study: the tenant `studies.paper` makes a case of the values that a paper prints.

Nothing else of the language knows the paper.
"""

from typing import TYPE_CHECKING

from .. import tenants

if TYPE_CHECKING:
    from ..paper.readings import Reading


def as_reading(text: str | None, default: "Reading | None" = None) -> "Reading":
    """The reading of a text such as ``force-first/tension/paper``; None, or a missing word: that of the default.

    Raises `InputError` for an unknown word, and where the package of the paper was deleted.
    """
    readings = tenants.module_of("studies.paper.readings")
    reading: Reading = readings.parse(text, default or readings.DEFAULT)
    return reading


def table_of(text: str | None) -> dict[str, float]:
    """The values that a study with this reading has where it gives none, in cm, N and rad; none without a reading."""
    return dict(as_reading(text).table) if text else {}
