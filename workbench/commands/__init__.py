"""The commands of the command line; only they print or know an exit status."""
