"""What a list of equilibria says of its energies."""

import json
from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import simpson
from scipy.interpolate import CubicSpline

from solver import Rod
from tests.slow import slow
from tests.workbench.command import exit_status

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def ran(tmp_path, monkeypatch, capsys) -> Run:
    """Runs a command in this process, in an empty folder: exit status, stdout and stderr, each on one line."""
    monkeypatch.chdir(tmp_path)

    def run(*args: object) -> tuple[int, str, str]:
        capsys.readouterr()
        status = exit_status(*args)
        return status, *(" ".join(text.split()) for text in capsys.readouterr())

    return run


@pytest.mark.parametrize("held", ["", slow("--height 5 --within FZ=-20:20")])
def test_a_list_of_equilibria_shows_which_part_of_the_energy_is_elastic(held: str, ran: Run) -> None:
    """Bending: Simpson's rule on the stored shape. The rest: the work of the loads on its displacements."""
    options = f"--L 6 {held} --out all.h5".split()
    status, out, err = ran("equilibria", *options, "--json")
    assert status == 0, err
    told = json.loads(out)
    with xr.open_dataset("all.h5", engine="h5netcdf") as ds:
        rod = Rod(**{name: float(ds[name]) for name in ("E", "nu", "a", "L")}, stiffness=ds.attrs["stiffness"])
        A, C, rho = rod.bending_stiffness, rod.torsional_stiffness, float(ds["rho"])
        for i, row in enumerate(told["equilibria"]):
            beta, s = ds["beta"].values[i], ds["s"].values
            kappa = np.hypot(CubicSpline(s, beta)(s, 1), np.sin(beta) ** 2 / rho)
            loads = {name: float(np.ravel(ds[name].values)[i if ds[name].ndim else 0]) for name in ("FZ", "MZ", "M3")}
            twist = loads["M3"] ** 2 * rod.L / (2 * C)
            turned = loads["M3"] * rod.L / C - simpson(np.sin(beta) * np.cos(beta), x=s) / rho
            work = loads["MZ"] * np.ptp(ds["alpha"].values[i][[0, -1]]) * np.sign(ds["alpha"].values[i][-1])
            work += loads["M3"] * turned + (0 if held else loads["FZ"] * ds["z"].values[i][-1])
            bending = simpson(A * kappa**2 / 2, x=s)
            assert row["bending_energy"] == pytest.approx(bending, rel=2e-3)
            assert row["twist_energy"] == pytest.approx(twist, rel=1e-12)
            energy = row["held_energy" if held else "energy"]
            assert energy == pytest.approx(bending + twist - work, abs=2e-3 * bending)
            assert float(ds["bending_energy"][i]) == row["bending_energy"]
            assert float(ds["twist_energy"][i]) == row["twist_energy"]
    _, out, _ = ran("equilibria", *options, "--force")
    name, loads_said = ("held energy", "the given loads and end moments") if held else ("energy", "FZ, MZ and M3")
    assert f"{name} (N cm) bending energy (N cm) bends" in out
    assert f"{name} = bending energy + twist energy ({twist:.6g} N cm" in out
    assert f"- work of {loads_said}" in out
