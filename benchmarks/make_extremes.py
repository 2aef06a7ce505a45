"""Write workbench/lab/extreme_runs.json: beta of the named extremes by Taylor series to 25 digits, where possible.

Run from the root: python -m benchmarks.make_extremes
"""

import json

import numpy as np

from benchmarks.march_25_digits import march
from solver.problem.dimensionless import reduce
from workbench.lab.extreme_runs import FILE, SHARES, extremes

_STEPS = 1500  # some minutes for all of them together


def main() -> None:
    named = extremes()
    problems = [reduce(one.case) for one in named]
    columns = [np.concatenate([getattr(p, f) for p in problems]) for f in ("lam", "mu", "phi", "beta0", "dbeta0")]
    t = np.concatenate([p.span for p in problems])[:, None] * np.array(SHARES)
    beta = march(*columns, t, most=_STEPS)[0]
    rows = {}
    for one, values in zip(named, beta, strict=True):
        arrived = bool(np.isfinite(values).all())
        rows[one.name] = {"beta": values.tolist() if arrived else None, "source": "taylor" if arrived else ""}
    FILE.write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{FILE}: {sum(row['beta'] is not None for row in rows.values())} of {len(rows)} by Taylor series")


if __name__ == "__main__":
    main()
