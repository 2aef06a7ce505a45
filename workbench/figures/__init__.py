"""Matplotlib figures, each a function of a dataset."""
