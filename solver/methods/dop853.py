"""`dop853`: scipy's adaptive Runge-Kutta method of order 8, the reference among the marches."""

from .adaptive import make_run
from .base import Knob, Method

DOP853 = Method(
    "dop853",
    make_run("DOP853"),
    ("start",),
    8,
    "adaptive Runge-Kutta of order 8 (scipy), the reference",
    {"rtol": Knob(float)},
)
