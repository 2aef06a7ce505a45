"""What workers have read and compiled before they exist: importing this solves one rod, so that the rest is in memory.

The process that workers are copies of (`crew`) imports it, once.
"""

import math

import scipy.integrate  # SciPy reads its parts when they are asked for
import scipy.interpolate
import scipy.linalg
import scipy.optimize.elementwise
import scipy.spatial  # noqa: F401

from solver import Case, Cylinder, Rod, Start, solve
from solver.observe.observables import observe

from . import block  # noqa: F401

observe(solve(Case(Rod(2e4, 0.3, 0.25, 20.0), Cylinder(1.0), Start(math.pi / 3, 2.0, M3=0.5)), stations=101), ["turns"])
