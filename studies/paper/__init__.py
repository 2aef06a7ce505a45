"""Table 1 of the paper and its readings, and the studies of the paper (TOML)."""
