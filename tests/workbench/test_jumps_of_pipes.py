"""Pictures of pipes that change their shape, or have none, at some weights on bit."""

import pytest
import xarray as xr

from studies.language.loader import loads
from workbench.figures import canvas, figure_kinds
from workbench.figures.well_tracks import JUMP
from workbench.run import in_memory
from workbench.stored.stored_study import StoredStudy

STUDY = """
title = "A pipe pushed into a horizontal hole"
observables = ["FZ0", "arriving_max", "push_max", "push_max_at"]
outputs = ["beta", "alpha", "z", "contact"]
units = {length = "ft", force = "klbf"}

[base]
E = "30000 ksi"
nu = 0.3
a = "2.5 in"
inner_radius = "2.138 in"
L = 1000.0
R = "4.25 in"
side = "inside"
weight = "19.5 lbf/ft"
inclination = "90deg"
friction = 0.25
sliding = "axial-forward"
beta0 = 0.0
betaL = 0.0

[axes.wob]
values = [45.0, 50.0, 68.0, 1500.0]
"""


@pytest.fixture(scope="module")
def pipes() -> xr.Dataset:
    return in_memory.run(loads(STUDY))


def test_a_jump_of_the_slack_off_is_drawn_and_said(pipes: xr.Dataset) -> None:
    drawn = figure_kinds.figure(StoredStudy(pipes), "well")
    (jump,) = [line for ax in drawn.axes for line in ax.get_lines() if line.get_label() == JUMP]
    assert sorted(jump.get_ydata()) == [50.0, 68.0]


def test_the_word_of_an_unsolved_pipe_stands_before_the_curves(pipes: xr.Dataset) -> None:
    (ax, *_) = figure_kinds.figure(StoredStudy(pipes), "states").axes
    (word,) = [text for text in ax.texts if text.get_bbox_patch() is not None]
    assert word.get_zorder() > max(line.get_zorder() for line in ax.get_lines())


def test_the_largest_push_that_is_said_is_that_of_solve_and_not_of_a_station(pipes: xr.Dataset) -> None:
    said = " ".join(canvas.caption(figure_kinds.figure(StoredStudy(pipes), "well", at={"wob": 68.0})))
    most = float(pipes["push_max"].sel(wob=68.0)) * 1000  # lbf/ft
    at = float(pipes["push_max_at"].sel(wob=68.0))
    assert f"Largest push of the wall: {most:.4g} lbf/ft at s = {at:.4g} ft" in said
