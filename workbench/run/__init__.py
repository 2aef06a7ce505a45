"""Study runs: plan, shards, resume, workers, assembly, fidelity, merge."""
