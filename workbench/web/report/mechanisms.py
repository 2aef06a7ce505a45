"""Why a claim of the paper comes out as it does: the mechanics behind each panel, with the stored numbers."""

from collections.abc import Callable

import numpy as np
import xarray as xr

from studies.language.readings import DEFAULT

from ...words import labels


def mechanism(claim: str, ds: xr.Dataset) -> str:
    """Return why the laws of a claim come out as they do under the default reading of Table 1.

    Parameters
    ----------
    claim : str
        Its number in the paper, for example ``"(1)"``.
    ds : xr.Dataset
        The stored panel.

    Returns
    -------
    Two or three sentences; none under another reading, which has other loads, and for a claim without a row here.
    """
    explain = MECHANISMS.get(claim)
    return "" if explain is None or ds.attrs.get("reading") != DEFAULT.name else explain(ds)


def _of_modulus(ds: xr.Dataset) -> str:
    sweep = _ends(ds["amplitude"] * (180 / np.pi), "{:.0f}°")
    room = _ends(ds["L"] / ds["bend_number"], "{:.2g}") + f" {ds.attrs['length_unit']}"
    return (
        "F₃ + Aκ²/2 is constant along the rod (eq. 27), so the same change of tension bends a stiffer rod less: κ goes "
        f"with 1/√A. A bend sweeps about the same angle at every E ({sweep}), so it needs more length: {room}."
    )


def _of_radius(ds: xr.Dataset) -> str:
    twist = _ends(ds["M3"], "{:.3g}") + f" {_moment(ds)}"
    return (
        f"With F₁₀ and β₀′ given, the twisting moment M₃ = F₁₀/β₀′ + 3A sin 2β₀/(2ρ) falls ({twist}), and so does the "
        "curvature sin²β/ρ that the cylinder imposes: the sharpest bend opens. But the energy of lying across the "
        "axis, A sin⁴β/(2ρ²), falls too, so β swings farther."
    )


def _of_start_angle(ds: xr.Dataset) -> str:
    force = _ends(ds["FZ"], "{:.3g}") + f" {ds.attrs['force_unit']}"
    twist = _ends(ds["M3"], "{:.3g}") + f" {_moment(ds)}"
    return (
        "F₁₀ and F₃₀ stay, but a larger β₀ turns F₃₀ away from the axis: the axial tension FZ = F₃₀ cos β₀ falls "
        f"({force}), and the twisting moment M₃ rises ({twist}). Less tension and more twist make the bends shorter."
    )


def _of_end_angle(ds: xr.Dataset) -> str:
    bends = _ends(ds["bend_number"], "{:.2f}")
    return (
        "The loads stay, and they set most of the spacing of the bends. Turning the far end changes the shape by a "
        f"fraction of one bend ({bends}), until this equilibrium ends at a fold: too little for another whole bend."
    )


def _of_forces(ds: xr.Dataset) -> str:
    middle = {name: ds.sizes[name] // 2 for name in ("F1", "F3")}
    with_f1, with_f3 = (_ends(100 * ds["attached"].isel({other: middle[other]}), "{:.0f} %") for other in ("F3", "F1"))
    return (
        "Larger loads bend the rod more sharply, F₁₀ through the twisting moment and F₃₀ through the tension, and the "
        "contact force grows with them. But pull grows as well as push: the share of the length on which the cylinder "
        f"pushes goes from {with_f1} with F₁₀, and from {with_f3} with F₃₀."
    )


MECHANISMS: dict[str, Callable[[xr.Dataset], str]] = {
    "(1)": _of_modulus,
    "(2)": _of_radius,
    "(3)": _of_start_angle,
    "(4)": _of_end_angle,
    "(5)": _of_forces,
}


def _ends(values: xr.DataArray, form: str) -> str:
    """The first and the last value along the axis of a panel."""
    return " to ".join(labels.minus_signs(form.format(float(values.values.flat[k]))) for k in (0, -1))


def _moment(ds: xr.Dataset) -> str:
    return labels.unit(f"{ds.attrs['force_unit']} {ds.attrs['length_unit']}")
