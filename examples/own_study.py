"""
A study of your own
===================

A study says which fields of the case vary, what is observed, and which law must hold. As a file it is run by
``workbench run FILE``; here it is a text in a script. Seven forces push a rod into a pipe. Units are cm and N.
"""

import workbench.accessor  # noqa: F401  (gives a dataset its `rod`)
from studies.language.loader import loads
from workbench.run import in_memory

study = loads("""
title = "A rod pushed into a pipe"
observables = ["bends", "push_mean"]
units = { length = "cm", force = "N" }
axes.F3 = { from = -15.0, to = -3.0, count = 7 }

[base]
E = 5e3
nu = 0.25
a = 0.25
L = 30.0
R = 1.5
side = "inside"
beta = "10deg"
dbeta = 0.2
M3 = 0.0

[[laws]]
claim = "bends"
observable = "bends"
axis = "F3"
direction = "falls"
source = "The less a rod is pushed, the fewer bends it has. F3 is negative: compression."
""")
ds = in_memory.run(study)
ds.rod.plot().save("own_study.png")
(law,) = ds.rod.verdicts
print(law.claim, law.verdict, law.measured)

# %%
# The law is true: the number of bends falls, or stays, from each force to the next weaker one, and falls on the whole.

assert law.verdict == "true"
assert bool((ds["solved"] == 1).all())
