"""Stored studies: the schema of the file, construction, validated reading, writing, selection, verdicts, cautions."""
