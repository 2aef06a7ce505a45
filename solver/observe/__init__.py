"""Observables: numbers of a whole rod with their errors; derivatives by the fields of its case; cautions."""
