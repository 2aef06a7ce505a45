"""A notebook that is executed, and what its page shows."""

from pathlib import Path

import numpy as np
import pytest

from solver import Case, Cylinder, Rod, Start, solve

CELLS = (
    "from solver import Case, Cylinder, Rod, Start, solve\n"
    "rod = Rod(E=1.07e4, nu=0.25, a=0.25, L=20.0, stiffness='paper')\n"
    "sol = solve(Case(rod, Cylinder(R=0.75), Start(beta='30deg', dbeta=0.5, F1=5.0, F3=10.0)))\n"
    "sol",
    "sol.plot(length='cm', force='N')",
    "sol.scene(length='cm', force='N')",
)


@pytest.mark.slow
def test_a_notebook_shows_table_diagram_and_scene(tmp_path: Path) -> None:
    nbformat = pytest.importorskip("nbformat", reason="pip install nbclient ipykernel")
    nbclient = pytest.importorskip("nbclient", reason="pip install nbclient ipykernel")
    pytest.importorskip("ipykernel", reason="pip install nbclient ipykernel")
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in CELLS])
    nbclient.NotebookClient(
        book, kernel_name="python3", timeout=300, resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    table, plot, scene = ([*cell["outputs"]][-1]["data"] for cell in book.cells)
    assert "number of bends" in table["text/html"]
    assert len(plot["image/png"]) > 10_000
    assert scene["text/html"].startswith('<iframe sandbox="allow-scripts"')
    assert "default-src" in scene["text/html"]


def test_a_solution_becomes_a_dataset_with_the_units_that_are_named() -> None:
    rods = Rod(E=[1e4, 2e4], nu=0.25, a=0.25, L=20.0)
    sol = solve(Case(rods, Cylinder(R=0.75), Start(beta="30deg", dbeta=0.5, F1=5.0, F3=10.0)), stations=11)
    ds = sol.to_dataset(length="cm", force="N")
    np.testing.assert_array_equal(ds["E"].values, [1e4, 2e4])
    np.testing.assert_array_equal(ds["z"].values, sol.z)
    assert ds["contact"].attrs["units"] == "N/cm"
