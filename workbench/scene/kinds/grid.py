"""The kind grid: every case of one axis or two, side by side at one scale, coloured as contact is."""

from dataclasses import replace

from .contact import KIND as CONTACT

KIND = replace(
    CONTACT, name="grid", description="every case of one axis or two, side by side at one scale", cells="each"
)
