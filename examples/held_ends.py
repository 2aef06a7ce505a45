"""
Held ends
=========

Two clamped ends of a rod come closer: the height is given, and the axial force is found. Under a dead load the rod
would snap where the force is least; under a held height each shape follows from the one before it. Units are cm and N.
"""

import numpy as np
from matplotlib.figure import Figure

from solver import Case, Cylinder, Ends, Rod, solve

rod, cylinder = Rod(E=1.07e4, nu=0.25, a=0.25, L=5.0), Cylinder(R=0.75)
heights = np.linspace(4.6, 2.6, 11)
shapes = []
for height in heights:
    case = Case(rod, cylinder, Ends(beta0="20deg", betaL="20deg", height=height))
    shapes.append(solve(case, seed=shapes[-1] if shapes else None))
force = np.array([float(one.reactions["FZ"]) for one in shapes])

# %%
# The force falls to its least value and rises again.

figure = Figure(figsize=(8, 3.2), layout="constrained")
left, right = figure.subplots(1, 2)
for one in shapes:
    left.plot(one.alpha * one.case.rho, one.z, color="C0")
left.set(xlabel="unrolled circumference [cm]", ylabel="z [cm]", aspect="equal")
right.plot(heights, force, "o-")
right.set(xlabel="height [cm]", ylabel="axial force FZ [N]")
figure.savefig("held_ends.png", dpi=150)
print(f"least force {force.min():.2f} N at the height {heights[force.argmin()]:.1f} cm")
assert all(one.solved for one in shapes)
np.testing.assert_allclose([one.z[-1] - one.z[0] for one in shapes], heights, rtol=1e-7)
assert 0 < force.argmin() < len(force) - 1
