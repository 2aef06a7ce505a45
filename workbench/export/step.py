"""STEP: the centreline as a B-spline over the arc length, and the solid about it. Needs Open Cascade.

The tube is not made by a sweep of the CAD kernel: its surface r(s) + a (cos v n(s) + sin v b(s)) is a rational B-spline
as soon as r, n and b are B-splines over the same knots, because a circle is one. So its error is that of three splines,
which is measured here before the kernel gets them.
"""

from importlib import import_module
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from solver.problem.errors import InputError

from ..geometry.centreline import Array, Centreline
from .file_format import ExportedRod, Format, metres

DEGREE = 5
NEAR = 1e-6  # of rho: the default tolerance
SPANS = (16, 4096)  # the fewest and the most spans that are tried
FACES = (16, 8, 4, 2)  # spans of a face, tried in this order
MEASURED = 1e-4  # of the volume: the error allowed of the kernel's default measure, which other programs show
MISSING = (
    "STEP files need Open Cascade ({why}): pip install 'rod-workbench[cad]', and on a bare Debian or Ubuntu "
    "apt-get install libgl1"
)
MODULES = (
    "BRepBuilderAPI", "BRepCheck", "BRepGProp", "BRepLib", "Geom", "GProp", "IFSelect", "Interface", "Message",
    "STEPControl", "TopAbs", "TopExp", "TopoDS", "collections", "gp",
)  # fmt: skip
# Units of length that Open Cascade names; the others are written as SI with a prefix.
NAMED = {"um": "UM", "mm": "MM", "cm": "CM", "m": "M", "km": "KM", "in": "INCH", "ft": "FT"}
PREFIXED = {"nm": ".NANO.", "dm": ".DECI."}


def write(path: Path, rod: ExportedRod) -> dict[str, Any]:
    """Write the rod to its tolerance, without the solid where the options say so; see `write_line`."""
    metres(rod.unit)  # refuses a unit that STEP does not know
    return write_line(path, rod.line, rod.unit, rod.title, rod.tolerance / 2, not rod.options.centreline)


def write_line(path: Path, line: Centreline, unit: str, name: str, tolerance: float, solid: bool) -> dict[str, Any]:
    """Write the centreline, and the solid where asked for; returns numbers about the file by name.

    Parameters
    ----------
    tolerance
        The greatest distance of curve and surface from the rod [length].

    Raises
    ------
    InputError
        Open Cascade is missing or cannot write the file, no spline of `SPANS` is within the tolerance, or the volume of
        the solid is not measured to `MEASURED`.
    """
    occ = kernel()
    splines, missed = fit(line, tolerance)
    shapes = [occ.BRepBuilderAPI_MakeEdge(_curve(occ, splines)).Edge()]
    facts: dict[str, Any] = {"spans": splines.c.shape[0] - DEGREE, "within": missed}
    if solid:
        body, facts["volume"] = _measurable(occ, splines, (line.a, line.bore) if line.bore else (line.a,))
        shapes.insert(0, body)
    _write(occ, path, shapes, unit, name)
    return facts


def near(line: Centreline) -> float:
    """The default tolerance [length]."""
    return NEAR * line.rho


def kernel() -> Any:
    """The names of Open Cascade that are used here. Raises `InputError` with what to install where it is missing."""
    try:
        import_module("OCP")
        modules = [import_module(f"OCP.{name}") for name in MODULES]
    except ImportError as error:
        raise InputError(MISSING.format(why=str(error).partition("\n")[0])) from None
    return SimpleNamespace(
        **{name: value for module in modules for name, value in vars(module).items() if not name.startswith("__")}
    )


def fit(line: Centreline, tolerance: float) -> tuple[BSpline, float]:
    """r(s), n(s) and b(s) as one quintic spline with values (9,), and the error of its tube [length].

    Raises `InputError` where no number of spans within `SPANS` reaches the tolerance.
    """
    missed, spans = np.inf, SPANS[0]
    while spans <= SPANS[1]:
        s = np.linspace(line.s[0], line.s[-1], spans + 1)
        spline = make_interp_spline(s, _known(line, s), k=DEGREE)
        between = ((s[1:] + s[:-1])[:, None] / 2 + np.diff(s)[:, None] * np.array([-0.25, 0.0, 0.25])).ravel()
        off = np.abs(spline(between) - _known(line, between)) * np.repeat([1.0, line.a, line.a], 3)
        missed = float(np.sqrt(3) * off.reshape(-1, 3, 3).max(axis=2).sum(axis=1).max())
        if missed <= tolerance:
            return spline, missed
        spans *= 2
    raise InputError(
        f"a spline of {SPANS[1]} spans misses this rod of length {line.L:g} by {missed:.1e}, and {tolerance:.1e} is "
        "needed: give a larger --tolerance"
    )


def volume(occ: Any, body: Any, within: float | None = 1e-6) -> float:
    """Volume of a solid, its integrals to a relative error `within`; None: by the kernel's default, without a bound."""
    properties = occ.GProp_GProps()
    if within is None:
        occ.BRepGProp.VolumeProperties_s(body, properties)
    else:
        occ.BRepGProp.VolumeProperties_s(body, properties, within, False, False)
    return float(properties.Mass())


def _known(line: Centreline, s: Array) -> Array:
    place, _, out, across = line.frame(s)
    return np.concatenate([place, out, across], axis=-1)


def _knots(occ: Any, spline: BSpline) -> tuple[Any, Any]:
    """Distinct knots and their multiplicities."""
    values, count = np.unique(spline.t, return_counts=True)
    knots, often = occ.Array1_double(1, values.size), occ.Array1_int(1, values.size)
    for i, (value, times) in enumerate(zip(values, count, strict=True), 1):
        knots.SetValue(i, float(value))
        often.SetValue(i, int(times))
    return knots, often


def _curve(occ: Any, splines: BSpline) -> Any:
    poles = occ.Array1_gp_Pnt(1, len(splines.c))
    for i, place in enumerate(splines.c[:, :3], 1):
        poles.SetValue(i, occ.gp_Pnt(*map(float, place)))
    return occ.Geom_BSplineCurve(poles, *_knots(occ, splines), DEGREE)


def _quarter(occ: Any, splines: BSpline, a: float, k: int) -> Any:
    """A quarter of the tube's surface, s along u and a quarter circle along v."""
    knots, often = _knots(occ, splines)
    place, out, across = np.split(splines.c, 3, axis=1)
    poles = occ.Array2_gp_Pnt(1, len(place), 1, 3)
    weights = occ.Array2_double(1, len(place), 1, 3)
    for j, (turn, far) in enumerate(((0.0, 1.0), (0.25, np.sqrt(2)), (0.5, 1.0)), 1):
        angle = (k + 2 * turn) * np.pi / 2
        row = place + a * far * (np.cos(angle) * out + np.sin(angle) * across)
        for i, point in enumerate(row, 1):
            poles.SetValue(i, j, occ.gp_Pnt(*map(float, point)))
            weights.SetValue(i, j, 1 / far)
    arc, twice = occ.Array1_double(1, 2), occ.Array1_int(1, 2)
    for i in (1, 2):
        arc.SetValue(i, float(i - 1))
        twice.SetValue(i, 3)
    return occ.Geom_BSplineSurface(poles, weights, knots, arc, often, twice, DEGREE, 2)


def _measurable(occ: Any, splines: BSpline, radii: tuple[float, ...]) -> tuple[Any, float]:
    """The tube as a valid solid that the kernel's default measures to `MEASURED`, and its volume.

    The default measures with a fixed number of points a face, too few for a face along a whole rod: 23 % too little for
    20 cm of Table 1's rod, 16 % too much for 100 cm. So faces are made shorter until the measure is near enough.
    """
    true, off = None, np.inf
    for spans in FACES:
        body = _solid(occ, splines, radii, spans)
        if not occ.BRepCheck_Analyzer(body).IsValid():
            raise InputError("Open Cascade does not accept the solid; --centreline writes the curve alone")
        true = volume(occ, body) if true is None else true
        off = abs(volume(occ, body, None) / true - 1)
        if off <= MEASURED:
            return body, true
    raise InputError(
        f"Open Cascade measures the solid's volume {off:.1e} off, as other programs would; --centreline writes the "
        "curve alone, a smaller --tolerance makes shorter faces"
    )


def _solid(occ: Any, splines: BSpline, radii: tuple[float, ...], spans: int) -> Any:
    """The quarters of the walls of rod and bore in faces of at most so many spans, and two flat ends, sewn together."""
    a = radii[0]
    sewing = occ.BRepBuilderAPI_Sewing(1e-6 * a)
    walls = [[_quarter(occ, splines, radius, k) for k in range(4)] for radius in radii]
    knots = np.unique(splines.t)
    faces = -(-(knots.size - 1) // spans)
    cuts = knots[np.round(np.linspace(0, knots.size - 1, faces + 1)).astype(int)]
    for quarter in (quarter for wall in walls for quarter in wall):
        for near, far in pairwise(map(float, cuts)):
            piece = quarter.Copy()
            piece.Segment(near, far, 0.0, 1.0)
            sewing.Add(occ.BRepBuilderAPI_MakeFace(piece, 1e-7 * a).Face())
    for u in (splines.t[0], splines.t[-1]):
        outer, *inner = (_circle(occ, wall, float(u)) for wall in walls)
        end = occ.BRepBuilderAPI_MakeFace(outer, True)
        for wire in inner:
            end.Add(occ.TopoDS.Wire(wire.Reversed()))
        sewing.Add(end.Face())
    sewing.Perform()
    if sewing.NbFreeEdges():
        raise InputError(f"Open Cascade left {sewing.NbFreeEdges()} open edges; --centreline writes the curve alone")
    shells = occ.TopExp_Explorer(sewing.SewedShape(), occ.TopAbs_ShapeEnum.TopAbs_SHELL)
    body = occ.BRepBuilderAPI_MakeSolid(occ.TopoDS.Shell(shells.Current())).Solid()
    occ.BRepLib.OrientClosedSolid_s(body)
    return body


def _circle(occ: Any, wall: list[Any], u: float) -> Any:
    """The wire of a wall's four quarters at u."""
    wire = occ.BRepBuilderAPI_MakeWire()
    for quarter in wall:
        wire.Add(occ.BRepBuilderAPI_MakeEdge(quarter.UIso(u)).Edge())
    return wire.Wire()


def _write(occ: Any, path: Path, shapes: list[Any], unit: str, name: str) -> None:
    for printer in occ.Message.DefaultMessenger_s().Printers():  # which report every transfer
        printer.SetTraceLevel(occ.Message_Gravity.Message_Fail)
    settings = occ.Interface_Static
    keys = ("xstep.cascade.unit", "write.step.unit", "write.step.product.name")
    writer = occ.STEPControl_Writer()
    before = [settings.CVal_s(key) for key in keys]
    for key, value in zip(keys, (NAMED.get(unit, "MM"), NAMED.get(unit, "MM"), name), strict=True):
        settings.SetCVal_s(key, value)
    try:
        for shape in shapes:
            writer.Transfer(shape, occ.STEPControl_StepModelType.STEPControl_AsIs)
        if writer.Write(str(path)) != occ.IFSelect_ReturnStatus.IFSelect_RetDone:
            raise InputError(f"Open Cascade cannot write {path}")
    finally:  # they are the whole process's
        for key, value in zip(keys, before, strict=True):
            settings.SetCVal_s(key, value)
    if unit in PREFIXED:
        text = path.read_text(encoding="ascii")
        path.write_text(text.replace("SI_UNIT(.MILLI.,.METRE.)", f"SI_UNIT({PREFIXED[unit]},.METRE.)"))


FORMAT = Format(write, "solid", near, curve_share=0.5, has_centreline=True)
