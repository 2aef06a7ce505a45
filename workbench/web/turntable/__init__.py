"""Turntables: rods on their cylinder that a reader turns, as one offline HTML file or as figures of the report."""
