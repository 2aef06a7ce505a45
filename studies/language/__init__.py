"""The study language: the file, its fields, samples and refinement, Table 1 and its readings."""
