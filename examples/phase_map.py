"""
A map over two axes
===================

Young's modulus and the radius of a pipe decide how a rod behaves that is pushed into the pipe: how many bends it has,
and on which share of its length it touches the wall. A study with two axes is drawn as one map for each observable.
Units are cm and N.
"""

import numpy as np

from studies.language.loader import loads
from workbench.figures import canvas, map_figure
from workbench.run import in_memory
from workbench.stored.stored_study import StoredStudy

study = loads("""
title = "Regimes of a rod pushed into a pipe"
observables = ["bends", "attached"]
units = { length = "cm", force = "N" }
axes.E = { from = 5e3, to = 4e4, count = 17, spacing = "geometric" }
axes.R = { from = 0.5, to = 2.0, count = 13, spacing = "geometric" }

[base]
nu = 0.25
a = 0.25
L = 20.0
side = "inside"
beta = "10deg"
dbeta = 0.0
M3 = 0.0
F3 = -10.0
""")
ds = in_memory.run(study)
canvas.save(map_figure.figure(StoredStudy(ds)), "phase_map.png")

# %%
# There are two regimes. In a wide pipe the rod touches the wall on its whole length, in a narrow one it lifts off near
# its bends. The stiffer the rod, the wider is the pipe at which the regimes meet.

whole = ds["attached"].values > 0.9999  # each cell: does the rod touch the wall on its whole length?
border = whole.argmax(axis=1)  # for each modulus, the first radius of the wide regime
print("border from R =", *(f"{float(ds['R'][k]):.2f}" for k in (border[0], border[-1])), "cm")
assert (np.diff(whole.astype(int), axis=1) >= 0).all()
assert (np.diff(border) >= 0).all()
assert border[-1] > border[0]
