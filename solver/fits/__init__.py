"""Inverse problems: the values of fields of a case that fit targets and measured points."""
