"""Stored studies: schema, runs, resume, growth, merge, checks, reading, selection, verdicts."""
