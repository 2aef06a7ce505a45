"""Problems of two ends: transit times, search of all equilibria, stability, continuation, selection."""
