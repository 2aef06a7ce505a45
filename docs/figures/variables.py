"""Draw the variables of docs/explanation/physics.md; run as a script it writes variables.png beside itself.

The rod is drawn in the parallel projection of `project`; its tangent and the directions at the marked section are
those of the equations.
"""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

INK, SOFT, FAINT = "#1c2430", "#5b6675", "#d5dae1"
ROD, ANGLE = "#2a7bb7", "#01834e"
AZIMUTH, TILT = np.radians(38.0), np.radians(20.0)  # of the line of sight, from the x axis and from the horizontal
R, HEIGHT, RHO = 1.0, 4.6, 1.12
PITCH = np.radians(52.0)  # beta of the rod drawn, constant
HERE = 3.3  # arc length of the marked section


def project(points: Any) -> Any:
    """The picture coordinates of points, (..., 2)."""
    x, y, z = np.moveaxis(np.asarray(points, dtype=float), -1, 0)
    right = -x * np.sin(AZIMUTH) + y * np.cos(AZIMUTH)
    near = x * np.cos(AZIMUTH) + y * np.sin(AZIMUTH)
    return np.stack([right, z * np.cos(TILT) - near * np.sin(TILT)], axis=-1)


def ring(radius: float, z: float, low: float = 0.0, high: float = 2 * np.pi) -> Any:
    angle = np.linspace(low, high, 200)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle + z], axis=-1)


def centreline(s: Any) -> Any:
    """Position of the centreline at arc length s: alpha' = sin(beta)/rho, z' = cos(beta)."""
    s = np.asarray(s, dtype=float)
    alpha = s * np.sin(PITCH) / RHO + AZIMUTH - 1.65
    return np.stack([RHO * np.cos(alpha), RHO * np.sin(alpha), s * np.cos(PITCH)], axis=-1)


def arrow(
    ax: Axes, start: Any, way: Any, text: str, colour: str, shift: tuple[float, float], width: float = 1.6
) -> None:
    """An arrow in space, with its name beside its tip."""
    tail, tip = project(start), project(np.asarray(start) + np.asarray(way))
    ax.annotate("", tip, tail, arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": width, "shrinkA": 0,
                                           "shrinkB": 0, "mutation_scale": 12}, zorder=8)  # fmt: skip
    ax.annotate(text, tip, shift, textcoords="offset points", color=colour, ha="center", va="center", zorder=9,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.9})  # fmt: skip


def cylinder(ax: Axes) -> None:
    """The cylinder, its axis, and its radius."""
    edge = AZIMUTH + np.pi / 2
    for side in (edge, edge + np.pi):
        line = project([[R * np.cos(side), R * np.sin(side), z] for z in (0, HEIGHT)])
        ax.plot(*line.T, color=SOFT, linewidth=1)
    ax.plot(*project(ring(R, HEIGHT)).T, color=SOFT, linewidth=1)
    ax.plot(*project(ring(R, 0, edge - np.pi, edge)).T, color=SOFT, linewidth=1)
    ax.plot(*project(ring(R, 0, edge, edge + np.pi)).T, color=FAINT, linewidth=1)
    ax.plot(*project([[0, 0, 0], [0, 0, HEIGHT + 0.35]]).T, color=SOFT, linewidth=0.9, linestyle=(0, (8, 3, 2, 3)))
    arrow(ax, (0, 0, HEIGHT + 0.3), (0, 0, 0.55), "z", INK, (9, -2))
    way = AZIMUTH + 2.6
    arrow(ax, (0, 0, HEIGHT), (R * np.cos(way), R * np.sin(way), 0), "", SOFT, (0, 0), 1.1)
    middle = project([0.55 * R * np.cos(way), 0.55 * R * np.sin(way), HEIGHT])
    ax.annotate("R", middle, (6, -8), textcoords="offset points", color=SOFT, ha="center", va="center")


def rod(ax: Axes) -> None:
    """The rod; what lies behind the cylinder is faint."""
    s = np.linspace(0, 6.2, 900)
    points = centreline(s)
    front = points[:, 0] * np.cos(AZIMUTH) + points[:, 1] * np.sin(AZIMUTH) > -0.25
    drawn = project(points)
    for here, look in ((~front, {"alpha": 0.25, "zorder": 1}), (front, {"zorder": 4})):
        ax.plot(*np.where(here[:, None], drawn, np.nan).T, color=ROD, linewidth=6, solid_capstyle="round", **look)
    start = project(centreline(0))
    ax.plot(*start, "o", color=INK, markersize=5, zorder=6)
    ax.annotate("s = 0", start, (-4, -13), textcoords="offset points", ha="center")
    along = project(centreline(np.linspace(0.9, 1.7, 40)))  # beside the rod, as curved as it is
    way = np.gradient(along, axis=0)
    beside = along + 0.13 * np.column_stack([way[:, 1], -way[:, 0]]) / np.hypot(*way.T)[:, None]
    ax.plot(*beside.T, color=ROD, linewidth=1.3)
    ax.annotate("", beside[-1], beside[-4], arrowprops={"arrowstyle": "-|>", "color": ROD, "shrinkA": 0, "shrinkB": 0})
    ax.annotate("s", beside[20], (8, -7), textcoords="offset points", ha="center", va="center", color=ROD)


def section(ax: Axes) -> None:
    """The marked section: its azimuth, the angle beta, and the components of force and moment along N, B, T."""
    at = centreline(HERE)
    alpha = np.arctan2(at[1], at[0])
    eX, eY, eZ = np.array([np.cos(alpha), np.sin(alpha), 0]), np.array([-np.sin(alpha), np.cos(alpha), 0]), np.eye(3)[2]
    T = np.sin(PITCH) * eY + np.cos(PITCH) * eZ
    N = -eX
    B = np.cross(T, N)
    foot = np.zeros(3)
    below = at * (1, 1, 0)
    ax.plot(*project([foot, below]).T, color=ANGLE, linewidth=1.2, zorder=5)
    ax.annotate("ρ", project(0.6 * below), (12, 5), textcoords="offset points", color=ANGLE, ha="center")
    ax.plot(*project([below, at]).T, color=ANGLE, linewidth=0.9, linestyle=(0, (1.5, 2)), zorder=5)
    ax.annotate("z", project(0.55 * below + 0.45 * at), (8, 0), textcoords="offset points", color=ANGLE, ha="center")
    zero = RHO * np.array([np.cos(AZIMUTH - 1.65), np.sin(AZIMUTH - 1.65), 0])
    ax.plot(*project([foot, zero]).T, color=ANGLE, linewidth=0.9, linestyle=(0, (4, 3)), zorder=5)
    ax.plot(*project(ring(0.5, 0, AZIMUTH - 1.65, alpha)).T, color=ANGLE, linewidth=1.2, zorder=5)
    ax.annotate(
        "α", project(ring(0.68, 0, AZIMUTH - 1.65, alpha)[100]), color=ANGLE, ha="center", va="center", zorder=9
    )
    up = project([at, at + 1.25 * eZ])
    ax.plot(*up.T, color=ANGLE, linewidth=0.9, linestyle=(0, (4, 3)), zorder=5)
    fan = np.linspace(0, PITCH, 60)[:, None]
    ax.plot(*project(at + 0.8 * (np.cos(fan) * eZ + np.sin(fan) * eY)).T, color=ANGLE, linewidth=1.2, zorder=7)
    middle = at + 0.98 * (np.cos(0.3 * PITCH) * eZ + np.sin(0.3 * PITCH) * eY)
    ax.annotate("β", project(middle), color=ANGLE, ha="center", va="center", zorder=9)
    arrow(ax, at, 1.5 * T, "F₃, M₃  along T", INK, (40, 4))
    arrow(ax, at, 1.15 * B, "F₂, M₂  along B", INK, (-51, 9))
    arrow(ax, at, 0.75 * N, "F₁, M₁  along N", INK, (-58, 4))
    ax.plot(*project(at), "o", color="white", markeredgecolor=INK, markersize=6, zorder=10)


def draw() -> Figure:
    """The picture."""
    fig = Figure(figsize=(4.6, 6.6), layout="constrained")
    ax = fig.add_subplot()
    cylinder(ax)
    rod(ax)
    section(ax)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_xlim(-1.35, 2.25)
    ax.set_ylim(-0.55, 5.2)
    return fig


if __name__ == "__main__":
    draw().savefig(Path(__file__).with_suffix(".png"), dpi=200)
