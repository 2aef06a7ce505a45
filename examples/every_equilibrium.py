"""
Every equilibrium between two ends
==================================

Under given loads and between given end angles a rod has several equilibria. ``equilibria`` finds all of them, lowest
energy first; those of Morse index 0 are stable. Counted with the sign (-1)^index they add up to one, as they must.
"""

from matplotlib.figure import Figure

from solver import Case, Cylinder, Ends, Rod, equilibria

rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=12.0)
found = equilibria(Case(rod, Cylinder(R=0.75), Ends(beta0="30deg", betaL="30deg", FZ=-20.0)))
print(found)

# %%
# The developed curves side by side, lowest energy first; the number below each is its Morse index.

figure = Figure(figsize=(9, 3.6), layout="constrained")
axes = figure.subplots()
left = 0.0
for one in found:
    across = one.solution.alpha * one.solution.case.rho  # on the unrolled cylinder
    across += left - across.min()
    stable = one.index == 0
    axes.plot(across, one.solution.z, color="0.1" if stable else "0.5", lw=2.5 if stable else 1.2)
    axes.text((across.min() + across.max()) / 2, -11.5, one.index, ha="center")
    left = across.max() + 1.2
axes.set(xlabel="unrolled circumference [cm]", ylabel="z [cm]", aspect="equal", ylim=(-12.5, 12.5))
axes.set_title("Stable equilibria are thick", loc="left", fontsize="medium")
figure.savefig("every_equilibrium.png", dpi=150)
assert found.complete
assert sum((-1) ** one.index for one in found) == 1
assert found[0].index == 0
