"""The kind ghosts: every case of an axis on one cylinder, thin, each in the colour of its value."""

from .base import Kind

KIND = Kind("ghosts", "every case of an axis in one scene", "together", most=3)
