"""Mechanics of the rod on a cylinder: potential, statics, frames."""
