"""Datasets and exports as other programs read them: CF, pint, pandas, ParaView and USD."""

import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np
import pytest
import pyvista as pv
import xarray as xr

import workbench.accessor  # noqa: F401
from solver import Case, Cylinder, InputError, Rod, Start, solve
from solver.problem.units import FORCES, LENGTHS
from tests.workbench import small
from workbench.export.file_format import ExportOptions
from workbench.export.stored_rod import export
from workbench.run import in_memory, writing
from workbench.stored.stored_study import StoredStudy

UNSOLVED = "failed: on purpose"


@pytest.fixture
def line(six) -> xr.Dataset:
    """One axis, E, of falling values."""
    return six.rod.sel(R=1.0).isel(E=[1, 0])


# CF


def test_a_file_states_its_conventions_and_its_axes_have_no_number_for_missing_values(six, tmp_path) -> None:
    writing.write(six, tmp_path / "small.h5")
    with h5py.File(tmp_path / "small.h5") as file:
        assert file.attrs["Conventions"] == "CF-1.11"
        assert not [name for name in ("E", "R", "u", "s") if "_FillValue" in file[name].attrs]
    assert six.attrs["Conventions"] == "CF-1.11"


def test_the_cf_checker_finds_no_error(tmp_path) -> None:
    pytest.importorskip("compliance_checker", reason="compliance-checker is not installed")
    study = small.TEXT.replace('outputs = ["beta", "alpha", "z", "F1"]', 'outputs = ["beta", "position"]')
    writing.write(in_memory.run(small.loads(study, default_name="small")), tmp_path / "small.nc")
    command = [Path(sys.executable).with_name("compliance-checker"), "--test=cf:1.11", tmp_path / "small.nc"]
    told = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    assert "cf:1.11" in told
    assert not re.search(r"^ +Errors *$", told, re.MULTILINE), told


def test_udunits_and_pint_know_every_unit_and_agree_but_for_dyn() -> None:
    cf = pytest.importorskip("cf_units", reason="cf-units is not installed")
    pint = pytest.importorskip("pint", reason="pint is not installed").UnitRegistry()
    for length in LENGTHS:
        assert cf.Unit(length).convert(1.0, "m") == pytest.approx(pint(length).to("m").magnitude, rel=1e-12)
    for force in FORCES:
        if force != "dyn":  # UDUNITS knows it as dyne, as docs/how-to/use-other-programs.md says
            assert cf.Unit(force).convert(1.0, "N") == pytest.approx(pint(force).to("N").magnitude, rel=1e-12)
    for text, other in ("N/cm^2", "N/m^2"), ("N cm^2", "N m^2"), ("rad/cm", "rad/m"), ("1/cm", "1/m"):
        assert cf.Unit(text).convert(1.0, other) == pytest.approx(pint(text).to(other).magnitude, rel=1e-12)


# pint


def test_pint_reads_the_units_of_a_dataset(six) -> None:
    pytest.importorskip("pint_xarray", reason="pint-xarray is not installed")
    held = six.pint.quantify()
    np.testing.assert_allclose(held["FZ"].pint.to("lbf").pint.magnitude, six["FZ"] / 4.4482216152605)
    np.testing.assert_allclose(held["E"].pint.to("MPa").pint.magnitude, six["E"] / 100)
    np.testing.assert_allclose(held["kappa_max"].pint.to("1/m").pint.magnitude, six["kappa_max"] * 100)
    assert held["outcome"].pint.units is None
    assert (held["bends"].where(held["solved"]).pint.magnitude == six["bends"]).all()
    xr.testing.assert_allclose(held.pint.dequantify("~P")["FZ"].drop_vars(["E", "R"]), six["FZ"].drop_vars(["E", "R"]))


# pandas


def test_a_table_has_one_row_for_each_case_with_the_axes_as_its_index(six) -> None:
    table = six.rod.to_pandas()
    assert table.shape[0] == 6
    assert table.index.names == ["E", "R"]
    assert table.loc[(2e4, 0.75), "turns_around"] == float(six["turns_around"].sel(E=2e4, R=0.75))
    assert (table["a"] == 0.25).all()  # that all cases share
    assert table["outcome"].eq("solved").all()
    assert table.attrs["units"]["E"] == "N/cm^2"
    assert table.attrs["units"]["kappa_max"] == "1/cm"
    assert "outcome" not in table.attrs["units"]
    assert "beta" not in table


def test_a_table_of_stations_has_every_array_that_is_asked_for_also_one_that_is_not_stored(six) -> None:
    table = six.rod.to_pandas("beta", "position", "kappa")
    assert table.shape == (6 * 21, 6)
    assert table.index.names == ["E", "R", "u"]
    one = six.rod.sel(E=1e4, R=1.0)
    np.testing.assert_array_equal(table.loc[(1e4, 1.0), "beta"], one["beta"])
    np.testing.assert_array_equal(table.loc[(1e4, 1.0), "position_y"], one.rod.position.sel(xyz="y"))
    assert table.attrs["units"] == {
        "E": "N/cm^2", "R": "cm", "u": "1", "s": "cm", "beta": "rad", "position_x": "cm", "position_y": "cm",
        "position_z": "cm", "kappa": "1/cm",
    }  # fmt: skip


def test_the_table_of_one_case_has_one_row(six) -> None:
    table = six.rod.sel(E=1e4, R=1.0).rod.to_pandas()
    assert table.shape[0] == 1
    assert table["E"].item() == 1e4


def test_samples_keep_their_fields_as_columns() -> None:
    study = small.study("[sample]\nsize = 3\nseed = 1\n[sample.E]\nfrom = 1e4\nto = 2e4\n", 'outputs = ["beta"]')
    drawn = in_memory.run(study)
    assert drawn.rod.to_pandas().index.name == "sample"
    np.testing.assert_array_equal(drawn.rod.to_pandas()["E"], drawn["E"])
    np.testing.assert_array_equal(drawn.rod.to_pandas("beta")["E"], np.repeat(drawn["E"].values, 21))


def test_a_table_too_large_is_refused(six, monkeypatch) -> None:
    monkeypatch.setattr("workbench.stored.derived_arrays.MOST", 100)
    with pytest.raises(InputError, match=r"the table would have \d+ numbers, more than 100"):
        six.rod.to_pandas()


# ParaView


def times(path: Path) -> dict[float, Path]:
    """The files of an index by their time steps."""
    sets = ElementTree.parse(path).iter("DataSet")
    return {float(one.attrib["timestep"]): path.parent / one.attrib["file"] for one in sets}


def test_a_time_series_has_one_file_a_value_in_rising_order(line, tmp_path) -> None:
    done = export(StoredStudy(line), tmp_path / "moduli.pvd", ExportOptions({}))
    found = times(tmp_path / "moduli.pvd")
    assert list(found) == [1e4, 2e4]
    assert done.facts == {"axis": "E", "files": 2, "unsolved": 0}
    for value, file in found.items():
        np.testing.assert_allclose(pv.read(file).points, line.rod.sel(E=value).rod.position, atol=1e-12)
    reader = pv.PVDReader(tmp_path / "moduli.pvd")
    assert reader.time_values == [1e4, 2e4]
    reader.set_active_time_value(2e4)
    np.testing.assert_allclose(reader.read()[0].point_data["beta"], line["beta"].sel(E=2e4), atol=1e-12)


def test_a_time_series_leaves_out_a_case_without_a_shape(line, tmp_path) -> None:
    done = export(StoredStudy(small.with_outcomes(line, ["solved", UNSOLVED])), tmp_path / "one.pvd", ExportOptions({}))
    assert list(times(tmp_path / "one.pvd")) == [2e4]
    assert done.facts["unsolved"] == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one", "one.pvd"]


def test_a_time_series_goes_along_the_axis_that_is_not_named(tmp_path) -> None:
    ds = in_memory.run(small.grid().at_stations(61))
    export(StoredStudy(ds), tmp_path / "radii.pvd", ExportOptions({"E": 1e4}))
    assert list(times(tmp_path / "radii.pvd")) == [0.5, 0.75, 1.0]


def test_a_folder_with_other_files_is_never_replaced(line, tmp_path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match=r"mine is not a folder of VTP files only, it is or holds notes.txt"):
        export(StoredStudy(line), tmp_path / "mine.pvd", ExportOptions({}), force=True)
    assert (tmp_path / "mine" / "notes.txt").read_text() == "mine"
    assert not (tmp_path / "mine.pvd").exists()


# USD


def numbers(text: str, name: str) -> np.ndarray:
    (found,) = re.findall(rf"\] {re.escape(name)} = \[(.*?)\]", text)
    return np.array([float(word) for word in re.findall(r"[-+\d.e]+", found)])


def test_a_usd_curve_between_the_stations_is_the_solvers(tmp_path) -> None:
    ds = in_memory.run(small.study("[axes.E]\nvalues = [2e4]\n").at_stations(201))
    export(StoredStudy(ds), tmp_path / "rod.usda", ExportOptions({}))
    text = (tmp_path / "rod.usda").read_text()
    assert text.startswith("#usda 1.0\n")
    assert 'metersPerUnit = 0.01\n    upAxis = "Z"' in text
    points = numbers(text, "points").reshape(-1, 3)
    assert numbers(text, "curveVertexCounts") == len(points) == 1201  # two parts a station, for the push
    assert numbers(text, "widths") == 0.5
    solution = solve(
        Case(Rod(2e4, 0.25, 0.25, 20.0, "paper"), Cylinder(0.75), Start(beta=np.pi / 6, F1=5.0, F3=10.0, dbeta=0.5)),
        tol=1e-12, stations=801,
    )  # fmt: skip
    middle = (points[:-1:3] + 3 * points[1::3] + 3 * points[2::3] + points[3::3]) / 8
    np.testing.assert_allclose(points[::3], solution.position[::2], atol=1e-7)  # nine digits of 10 cm
    np.testing.assert_allclose(middle, solution.position[1::2], atol=2e-5)  # cubics over 0.05 cm
    np.testing.assert_allclose(numbers(text, "primvars:push"), solution.push[::2], rtol=1e-5, atol=1e-4)


@pytest.mark.parametrize("stations", [15, 21, 41, 201])
def test_the_cubics_of_usd_leave_the_solvers_rod_by_no_more_than_they_say(stations) -> None:
    ds = in_memory.run(small.study("[axes.E]\nvalues = [2e4]\n").at_stations(stations))
    line = StoredStudy(ds).select({"E": 0}).centreline
    s = np.linspace(0, 20, 1001)
    start = Start(beta=np.pi / 6, F1=5.0, F3=10.0, dbeta=0.5)
    solution = solve(Case(Rod(2e4, 0.25, 0.25, 20.0, "paper"), Cylinder(0.75), start), tol=1e-12, stations=s)
    missed = np.linalg.norm(line.cubic(s) - solution.position, axis=-1).max()
    assert missed <= line.cubic_error * (1 + 1e-6)
    assert line.cubic_error < 10 * missed  # an estimate that says anything at all


def test_too_few_stations_for_the_cubics_of_usd_are_refused_without_a_study_and_the_number_named_is_enough(
    tmp_path,
) -> None:
    study = small.study("[axes.E]\nvalues = [2e4]\n")
    coarse = in_memory.run(study.at_stations(8)).assign_attrs(study="")
    for tolerance in (None, 1e-3, 0.1):
        with pytest.raises(InputError, match=r"8 stations fix the rod between them to \S+ cm only, and") as told:
            export(StoredStudy(coarse), tmp_path / "rod.usda", ExportOptions(tolerance=tolerance))
        assert f"is needed for a tolerance of {tolerance or 2.5e-4:g} cm: store about" in str(told.value)
        more = int(re.search(r"store about (\d+)", str(told.value))[1])
        done = export(
            StoredStudy(in_memory.run(study.at_stations(more))),
            tmp_path / f"{more}.usda",
            ExportOptions(tolerance=tolerance),
        )
        assert done.facts["tolerance"] == (tolerance or 2.5e-4)
    assert not (tmp_path / "rod.usda").exists()


def test_usd_reads_the_curve_and_its_validators_find_nothing(tmp_path) -> None:
    usd = pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Usd, UsdGeom, UsdValidation

    assert usd
    dense = in_memory.run(small.grid().at_stations(41))
    export(StoredStudy(dense), tmp_path / "rod.usda", ExportOptions({"E": 1e4, "R": 1.0}, tolerance=1.0))
    stage = Usd.Stage.Open(str(tmp_path / "rod.usda"))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 0.01
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    curve = UsdGeom.BasisCurves(stage.GetPrimAtPath("/Rod/Centreline"))
    stations = curve.ComputeVaryingDataSize(0)
    assert curve.ComputeVertexDataSize(0) == 3 * (stations - 1) + 1
    assert stations % 40 == 1  # parts of the way between two stored stations, for the push
    assert len(UsdGeom.PrimvarsAPI(curve).GetPrimvar("push").Get()) == stations
    np.testing.assert_allclose(
        curve.GetExtentAttr().Get(), UsdGeom.Boundable.ComputeExtentFromPlugins(curve, 0), atol=1e-5
    )
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert not UsdValidation.ValidationContext(validators).Validate(stage)
