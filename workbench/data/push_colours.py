"""The colour code of the push along a rod: from light blue (no push) to dark blue, orange for pull.

The one definition for scenes, figures, the report and the live page.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

# share of the largest push -> red, green, blue between 0 and 255; between two rows the colour is interpolated
STOPS: tuple[tuple[float, tuple[int, int, int]], ...] = (
    (0.0, (199, 223, 241)),
    (0.2, (146, 195, 226)),
    (0.4, (88, 161, 207)),
    (0.6, (42, 123, 183)),
    (0.8, (15, 84, 152)),
    (1.0, (7, 44, 105)),
)
# the same for a push and a pull, from the strongest pull to the strongest push: pale at 0, where the tint changes
DIVERGING: tuple[tuple[float, tuple[int, int, int]], ...] = (
    (-1.0, (126, 58, 4)),
    (-0.6, (189, 98, 4)),
    (-0.25, (232, 146, 48)),
    (-1e-6, (250, 214, 170)),
    *((share, (211, 227, 241) if share == 0 else rgb) for share, rgb in STOPS),
)
PULL = (222, 120, 0)  # wherever the cylinder would have to pull


def colours(push: Any, largest: float) -> NDArray[np.uint8]:
    """The colours of a push.

    Parameters
    ----------
    push : array
        Push per length, negative where the cylinder would have to pull, (...) [force/length].
    largest : float
        The push that has the darkest blue [force/length]; a larger one has it too.

    Returns
    -------
    array
        Red, green and blue between 0 and 255, (..., 3).
    """
    push = np.asarray(push, dtype=float)
    share = np.clip(push / largest, 0.0, 1.0) if largest > 0 else np.zeros_like(push)
    at, rows = np.array([one for one, _ in STOPS]), np.array([rgb for _, rgb in STOPS], dtype=float)
    blue = np.stack([np.interp(share, at, row) for row in rows.T], axis=-1)
    return np.where((push < 0)[..., None], np.array(PULL), np.round(blue)).astype(np.uint8)
