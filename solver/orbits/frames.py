"""The curve in space and the frames along it. Arrays broadcast; vectors are the last axis.

Outward radial eX, circumferential eY, axial eZ; inward normal N = -eX, tangent T = sin(beta) eY + cos(beta) eZ,
B = T x N. The axis of the cylinder is z; azimuth alpha is measured from x.
"""

from typing import Any

import numpy as np

from ..numerics.arrays import Array


def position(rho: Any, alpha: Array, z: Array) -> Array:
    """Centreline (rho cos alpha, rho sin alpha, z), (..., 3) [length]."""
    return np.stack(np.broadcast_arrays(rho * np.cos(alpha), rho * np.sin(alpha), z), axis=-1)


def outward(alpha: Array) -> Array:
    """The cylinder's outward normal eX, (..., 3)."""
    return np.stack([np.cos(alpha), np.sin(alpha), np.zeros_like(alpha)], axis=-1)


def tangent(alpha: Array, beta: Array) -> Array:
    """T = sin(beta) eY + cos(beta) eZ, (..., 3); eq. (3)."""
    s = np.sin(beta)
    return np.stack([-s * np.sin(alpha), s * np.cos(alpha), np.cos(beta)], axis=-1)


def binormal(alpha: Array, beta: Array) -> Array:
    """B = T x N = sin(beta) eZ - cos(beta) eY, (..., 3): in the surface, across the rod."""
    c = np.cos(beta)
    return np.stack([c * np.sin(alpha), -c * np.cos(alpha), np.sin(beta)], axis=-1)


def material(alpha: Array, beta: Array, gamma: Array) -> Array:
    """The section's own frame d1, d2, d3 as rows, (..., 3, 3): N and B turned by gamma about T; eq. (13)."""
    N, B = -outward(alpha), binormal(alpha, beta)
    c, s = np.cos(gamma)[..., None], np.sin(gamma)[..., None]
    return np.stack([c * N + s * B, c * B - s * N, tangent(alpha, beta)], axis=-2)
