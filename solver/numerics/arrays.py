"""Array types, and the rounding of their numbers."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]  # of floats, unless the text says otherwise
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]

EPS = 2.0**-52
