"""Rods as files of other programs: STEP, meshes, tables."""
