"""Two ends: transit_times times, search of all equilibria, stability, continuation, selection."""
