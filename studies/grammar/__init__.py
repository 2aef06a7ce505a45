"""What a study file is written in: formulas and units, axes, dimensions."""
