"""The report of a run: one HTML document with figures, laws and scenes."""
