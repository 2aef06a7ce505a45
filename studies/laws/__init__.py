"""Laws of a study: their kinds, and verdicts on them in words."""
