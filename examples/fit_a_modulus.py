"""
Fit a modulus to measured points
================================

Thirty points of a rod are known from a photograph, each with an error of 0.03 rad and 0.03 cm. Which modulus and which
torque has the rod? The points of this script are made from known values, so the answer can be checked.
"""

import numpy as np
from matplotlib.figure import Figure

from solver import Case, Cylinder, Rod, Start, fit, solve


def case(E: float, M3: float) -> Case:
    """The rod of Table 1, given by its modulus and its torque."""
    rod = Rod(E=E, nu=0.25, a=0.25, L=20.0, stiffness="paper")
    return Case(rod, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, M3=M3, F3=10.0))


true = solve(case(10700.0, 18.0), stations=30)
noise = np.random.default_rng(1).normal(0.0, 0.03, (2, 30))
points = {"alpha": true.alpha + noise[0], "z": true.z + noise[1]}
found = fit(case(10500.0, 17.0), {"E": None, "M3": None}, points=points, sigma={"alpha": 0.03, "z": 0.03})
for name, (low, high) in found.intervals.items():
    print(f"{name} = {found.values[name]:.1f}, 95 % interval {low:.1f} to {high:.1f}")

# %%
# The points and the fitted rod on the unrolled cylinder:

figure = Figure(figsize=(4, 5), layout="constrained")
axes = figure.subplots()
fitted = solve(found.case)
axes.plot(fitted.alpha, fitted.z, label="fitted")
axes.plot(points["alpha"], points["z"], "o", ms=4, label="measured")
axes.set(xlabel="azimuth [rad]", ylabel="z [cm]")
axes.legend(frameon=False)
figure.savefig("fit_a_modulus.png", dpi=150)
for name, value in {"E": 10700.0, "M3": 18.0}.items():
    low, high = found.intervals[name]
    assert low < value < high
