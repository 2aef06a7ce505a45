"""Runs, stores, draws, checks and reports studies; the command line."""

__version__ = "0.1.0"
