"""
Fig. 7 in ten lines
===================

The five panels of Fig. 7 of the paper vary Young's modulus, the radius of the cylinder, the start angle, the end angle
and the forces. This script runs the five shipped studies, judges their laws and draws the first panel.
"""

import workbench.accessor  # noqa: F401  (gives a dataset its `rod`)
from studies import load, names
from workbench.run import in_memory

panels = {name: in_memory.run(load(name)) for name in names() if name.startswith("fig7")}
for name, ds in panels.items():
    print(name, *(f"{law['observable']}: {law['verdict']}" for law in ds.rod.verdicts), sep="; ")
panels["fig7_1_modulus"].rod.plot().save("figure_7.png")

# %%
# The softest rod has 8 bends and the stiffest 5: the number of bends falls as the modulus rises.

assert panels["fig7_1_modulus"]["bends"].values.tolist() == [8, 7, 6, 6, 6, 5, 5, 5, 5]
