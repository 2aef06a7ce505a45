"""The rods that the live page offers: each with its source, in its own units. A table."""

from dataclasses import dataclass, field
from math import pi, radians
from typing import Any

from solver import Cylinder, Ends, Rod


@dataclass(frozen=True)
class Preset:
    """A rod to begin with.

    state: a study as plain data, see `page_model.study_of`. spans: of sliders of quantities with either sign, the
    greatest size or the two ends. source: where the values come from, and which are assumed.
    """

    name: str
    title: str
    source: str
    state: dict[str, Any]
    spans: dict[str, float | tuple[float, float]] = field(default_factory=dict)


def _wound(EI: float, GJ: float, a: float, R: float, tension: float, lay: float) -> dict[str, float]:
    """The angles and loads of both ends of a rod wound as a helix; lay in degrees."""
    ends = Ends.helix(Rod(EI=EI, GJ=GJ, a=a, L=1.0), Cylinder(R), tension, radians(lay))
    return {name: float(getattr(ends, name)) for name in ("beta0", "betaL", "FZ", "MZ", "M3")}


PRESETS = (
    Preset(
        "table1",
        "Table 1 of the paper",
        "Table 1 of the paper, with the length from the text below its eq. (47); cm and N. The table contradicts "
        "itself; the menu offers its readings.",
        {
            "units": {"length": "cm", "force": "N"},
            "reading": "force-first/tension/paper",
            "base": {
                "E": 1.07e4, "nu": 0.25, "a": 0.25, "L": 20.0, "R": 0.75, "side": "outside", "beta": pi / 6,
                "dbeta": 0.5, "dgamma": 0.5, "F1": 5.0, "F3": 10.0,
            },
        },
        {"dbeta": 2.0, "dgamma": 2.0, "F1": 20.0, "F3": 40.0},
    ),
    Preset(
        "dna",
        "DNA on a histone",
        "The left-handed superhelix of the nucleosome: 1.65 turns, radius 4.18 nm, pitch 2.39 nm (Luger et al., "
        "Nature 389, 1997). EI is that of DNA of persistence length 50 nm at 298 K, and GJ the twist stiffness, "
        "411 pN nm²; measured are 386 to 448 (table 1 of PNAS 114, 7049, 2017). Assumed: the rod's radius, "
        "1 nm; a tension of 5 pN; the torque that keeps this pitch; no charges: the equations do not contain what "
        "holds real DNA on the histone. nm and pN.",
        {
            "units": {"length": "nm", "force": "pN"},
            "base": {
                "EI": 205.7, "GJ": 411.4, "a": 1.0, "L": 43.5, "R": 3.18, "side": "outside",
                "beta": radians(-84.8), "dbeta": 0.0, "dgamma": 0.0108, "F2": 0.0, "F3": 5.0,
            },
        },
        {"dbeta": 0.3, "dgamma": 0.1, "F2": 10.0, "F3": 40.0},
    ),
    Preset(
        "pipe",
        "Drill pipe in a borehole",
        "A 5 in pipe of 19.50 lb/ft: 127.0 mm outside, wall 9.19 mm (API Spec 5D, 5DP), so 108.6 mm inside, in a "
        "hole of 8 1/2 in (215.9 mm). Steel of 206 GPa. Assumed: 200 kN of compression all along, no "
        "weight, no friction, no tool joints, no torque, and both ends held parallel to the hole. m and kN.",
        {
            "units": {"length": "m", "force": "kN"},
            "base": {
                "E": 2.06e8, "nu": 0.3, "a": 0.0635, "inner_radius": 0.0543, "L": 100.0, "R": 0.10795,
                "side": "inside", "beta0": 0.0, "betaL": 0.0, "FZ": -200.0, "MZ": 0.0, "M3": 0.0,
            },
        },
        {"beta0": radians(2.0), "betaL": radians(2.0), "FZ": (-400.0, -10.0), "MZ": 5.0, "M3": 5.0},
    ),
    Preset(
        "cable",
        "Cable on a drum",
        "Five turns of a 20 mm wire rope under 10 kN, held at both ends in the direction of the lay. The drum is 18 "
        "times as thick as the rope, which is what crane rules (ASME) ask of sheaves at least where a rope hoists "
        "loads. Assumed is all else: EI is a fortieth of that of a solid bar of steel, as the wires slide on "
        "each other, and GJ = EI/1.3; the loads are those of its helix. mm and N.",
        {
            "units": {"length": "mm", "force": "N"},
            "base": {
                "EI": 3.927e7, "GJ": 3.021e7, "a": 10.0, "L": 5970.0, "R": 180.0, "side": "outside",
                **_wound(EI=3.927e7, GJ=3.021e7, a=10.0, R=180.0, tension=1e4, lay=89.0),
            },
        },
        {"FZ": 2000.0, "MZ": 5e6, "M3": 5e5},
    ),
)  # fmt: skip
