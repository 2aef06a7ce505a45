"""
A drill pipe against Lubinski and Mitchell
==========================================

A long compressed pipe in a borehole buckles into a helix. For the force F and the radial gap r, Lubinski's pitch of the
helix is 2π √(2 EI/F), and Mitchell's push of the wall is F² r/(4 EI). A steel pipe of 200 m, both ends held parallel to
the hole, is solved for seven forces; its middle third is compared with both formulas. Units are m and kN.
"""

from math import pi

import numpy as np
from matplotlib.figure import Figure

from solver import Case, Cylinder, Ends, Rod, observe, solve

pipe = Rod(E=2.06e8, nu=0.3, a=0.0635, inner_radius=0.0543, L=200.0)
hole = Cylinder(R=0.108, side="inside")
EI, r = pipe.bending_stiffness, 0.108 - 0.0635
forces = np.linspace(60.0, 300.0, 7)
pipes = [solve(Case(pipe, hole, Ends(beta0=0.0, betaL=0.0, FZ=-force))) for force in forces]
seen = [observe(one, ["pitch", "push_middle"]) for one in pipes]
pitch = np.array([one["pitch"] for one in seen])
push = np.array([one["push_middle"] for one in seen])
lubinski, mitchell = 2 * pi * np.sqrt(2 * EI / forces), forces**2 * r / (4 * EI)

# %%
# The solved pipes, and the two formulas as lines:

figure = Figure(figsize=(8, 3.2), layout="constrained")
for axes, found, formula, label in zip(
    figure.subplots(1, 2), (pitch, push), (lubinski, mitchell), ("pitch [m]", "push of the wall [kN/m]"), strict=True
):
    axes.plot(forces, formula, color="0.6", label="formula")
    axes.plot(forces, found, "o", label="solved")
    axes.set(xlabel="compression F [kN]", ylabel=label)
    axes.legend(frameon=False)
figure.savefig("drill_pipe.png", dpi=150)
print("largest differences:", abs(pitch / lubinski - 1).max(), abs(push / mitchell - 1).max())
np.testing.assert_allclose(pitch, lubinski, rtol=0.01)
np.testing.assert_allclose(push, mitchell, rtol=0.01)
