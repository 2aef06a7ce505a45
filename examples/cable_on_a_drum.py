"""
A cable on a drum
=================

A wire rope of 20 mm lies in five turns on a drum of 360 mm. Both its ends are held in the direction of the lay, 89
degrees from the axis, and the loads are those of a winding under a tension T of 10 kN. Does it stay a regular winding?
And does it press on the drum like a rope without stiffness, with T sin²β/ρ per length? Units are mm and N.
"""

from math import radians, sin

import numpy as np

from solver import Case, Cylinder, Ends, Rod, observe, solve

rope = Rod(EI=3.927e7, GJ=3.021e7, a=10.0, L=5970.0)  # the wires slide: EI is a fortieth of that of a solid bar
lay = radians(89.0)
ends = Ends(beta0=lay, betaL=lay, FZ=174.52, MZ=2106363.0, M3=3607.0)
sol = solve(Case(rope, Cylinder(R=180.0), ends))
sol.scene(length="mm", force="N").save("cable_on_a_drum.html")
print(sol.selection)

# sphinx_gallery_thumbnail_path = "_static/thumbnails/cable_on_a_drum.png"

# %%
# The winding is stable (Morse index 0) and regular. Its pitch is larger than the diameter of the rope, so the turns lie
# beside one another, and the drum carries the push of a rope without stiffness.

seen = observe(sol, ["turns_around", "pitch", "push_middle", "index", "overlaps"])
for name, value in seen.items():
    print(f"{name}: {float(value):.4f}")
np.testing.assert_allclose(seen["turns_around"], 5.0, atol=1e-3)
np.testing.assert_allclose(seen["push_middle"], 1e4 * sin(lay) ** 2 / 190.0, rtol=1e-5)
assert seen["index"] == 0
assert seen["pitch"] > 2 * 10.0
assert not seen["overlaps"]
