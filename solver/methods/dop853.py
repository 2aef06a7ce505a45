"""`dop853`: scipy's adaptive Runge-Kutta method of order 8, the reference among the marches."""

from dataclasses import dataclass

from .adaptive import ScipyAdaptive
from .base import MOST_CALLED, Ladder, tens


@dataclass(frozen=True)
class DOP853(ScipyAdaptive):
    """Adaptive Runge-Kutta. rtol: the tolerance of a step; default: sought so that `tol` is met."""

    name = "dop853"
    summary = "adaptive Runge-Kutta of order 8 (scipy), the reference"
    order = 8
    integrator = "DOP853"
    ladders = (Ladder("dop853", "rtol", (*tens(2, 12, 2), 1e-13), "#d96a00", "D", most=3 * MOST_CALLED),)
