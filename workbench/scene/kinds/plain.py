"""The kind plain: the rod on its cylinder, in one colour."""

from .base import Kind

KIND = Kind("plain", "the rod on its cylinder", "one")
