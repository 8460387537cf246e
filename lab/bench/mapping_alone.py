"""`python -m lab.bench.mapping_alone SIZES`: the mapper's bench in a process with one thread of matrix algebra.

The dense reference is one large matrix product, which would wait for every core of a busy machine; one thread each
compares the work itself.
"""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
from collections.abc import Sequence

from lab.bench.rows import Row

_ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def measure_mapper_alone(
    objects: Sequence[int] | None = None,
    detections: Sequence[int] | None = None,
    dimensions: Sequence[int] | None = None,
    frames: int | None = None,
) -> list[Row]:
    """The rows of `measure_mapper`, from a process of its own; None: as large as it is by default."""
    sizes = {"objects": objects, "detections": detections, "dimensions": dimensions, "frames": frames}
    given = json.dumps({name: value for name, value in sizes.items() if value is not None})
    done = subprocess.run(
        [sys.executable, "-m", "lab.bench.mapping_alone", given],
        env={**os.environ, **_ONE_THREAD},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    rows: list[Row] = json.loads(done.stdout.splitlines()[-1])
    return rows


def main() -> None:
    """Prints the rows as one line of JSON."""
    from lab.bench.mapping import measure_mapper

    print(json.dumps(asyncio.run(measure_mapper(**json.loads(sys.argv[1])))))


if __name__ == "__main__":
    main()
