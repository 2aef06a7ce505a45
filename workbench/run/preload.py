"""Imported once by the process from which workers are forked: importing it loads and compiles all that a block needs.

One rod is solved, as some code is loaded or compiled only when it is first used.
"""

import math

import scipy.integrate  # SciPy loads its parts on first use
import scipy.interpolate
import scipy.linalg
import scipy.optimize.elementwise
import scipy.spatial  # noqa: F401

from solver import Case, Cylinder, Rod, Start, solve
from solver.observe.observables import observe
from studies import tenants
from studies.language.printed import as_reading

from . import block  # noqa: F401

observe(solve(Case(Rod(2e4, 0.3, 0.25, 20.0), Cylinder(1.0), Start(math.pi / 3, 2.0, M3=0.5)), stations=101), ["bends"])
if tenants.is_there("studies.paper"):
    as_reading(None)
