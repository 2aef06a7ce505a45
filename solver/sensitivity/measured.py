"""What is measured along the rod for the observables, by name, where its derivative is known."""

from ..observe import densities
from .extremes import LARGEST, LARGEST_SIZE, SMALLEST

EXTREMES = {
    "low": (densities.angle, SMALLEST),
    "high": (densities.angle, LARGEST),
    "tightest": (densities.curvature, LARGEST),
    "least": (densities.outward, SMALLEST),
    "most": (densities.outward, LARGEST),
    "tension": (densities.tension, LARGEST_SIZE),
}
INTEGRALS = {"curvature": densities.curvature, "bending": densities.bending, "potential": densities.potential}
PUSHES = ("pushed", "pulled", "share")
MIDDLE_PUSH, LIFTS, PEAK = "middle push", "lifts", "peak"
MIDDLE_GAINS = ("middle turned", "middle risen")
MEASURED = (*EXTREMES, *INTEGRALS, *PUSHES, MIDDLE_PUSH, LIFTS, PEAK, *MIDDLE_GAINS)
