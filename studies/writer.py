"""From a study back to TOML: what was said, and nothing that was left out."""

from collections.abc import Mapping
from typing import Any

import tomli_w
from numpy.typing import NDArray

from .model import Study


def dumps(study: Study, values: Mapping[str, NDArray[Any]] | None = None) -> str:
    """A TOML text that is read as the same study; values: (n,) in rad, in place of what axes say.

    Comments of the text that the study came from are not in it.
    """
    said = study.model_dump(by_alias=True, exclude_unset=True, exclude_none=True)
    for name, row in (values or {}).items():
        said["axes"][name] = {"values": [float(value) for value in row]}
    return tomli_w.dumps(said)
