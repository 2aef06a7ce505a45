"""The command loops: its table, its files and its refusals."""

import numpy as np
import pytest

from solver import Cylinder, InputError, Rod, loops
from workbench.geometry import solid_body
from workbench.stored.stored_study import StoredStudy


def test_a_dataset_of_loops_has_the_units_given_and_of_none_there_is_none() -> None:
    found = loops(Rod(E=1e4, nu=0.3, a=0.05, L=9.0), Cylinder(R=0.95), folds=1)
    ds = found.to_dataset(length="nm", force="pN")
    assert ds["energy"].attrs["units"] == "pN nm"
    del found[:]
    with pytest.raises(InputError, match="no loop was found"):
        found.to_dataset()


def test_the_ends_of_a_closed_rod_are_no_place_where_it_passes_through_itself() -> None:
    found = loops(Rod(E=1.07e4, nu=0.25, a=0.05, L=12.0), Cylinder(R=1.05, side="inside"), folds=2)
    ds = found.to_dataset(length="cm", force="N")
    for k in range(ds.sizes["equilibrium"]):
        line = StoredStudy(ds).select({"equilibrium": k}).centreline
        end = line.frame(line.s[:1])[0]
        assert all(np.linalg.norm(place - end) > line.a for place in solid_body.middles(line, (0.0, line.L)))


def test_a_model_leaves_out_no_clearance_at_the_ends_of_a_closed_rod() -> None:
    found = loops(Rod(E=1.07e4, nu=0.25, a=0.05, L=12.0), Cylinder(R=1.05, side="inside"), folds=1)
    stored = StoredStudy(found.to_dataset(length="cm", force="N"))
    for rods in (stored, stored.select({"equilibrium": 0})):
        assert rods.left_out == "The model leaves out weight, friction, and joints."
