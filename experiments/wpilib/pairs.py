"""The pairs of errors that the design names, at its own sizes: success with neither, each and both.

    python experiments/wpilib/pairs.py WORK_FOLDER

A scan halves sizes that cost too much, so it does not run all of these. They run here in the scenes
of its second stage. Each pair is tested by itself, by the rule of a scan.
"""

import json
import sys
from itertools import product
from pathlib import Path

import numpy as np

from faultpath.analyses.model import CORRECT
from faultpath.analyses.planning import rows_of
from faultpath.analyses.scan.decide import successes
from faultpath.analyses.scan.record import ScanRecord
from faultpath.faults import at_readers
from faultpath.run import Study, SystemSpec, load_system
from faultpath.run.execution.runner import run_study
from faultpath.stats.cancelling import cancelling
from faultpath.system import library_of

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
VARIANT = "default"
DIAMETER = tuple(f"diameter:scale={scale}@odometry" for scale in ("0.975", "1.025"))
LATENCY = tuple(
    f"latency:{size}@vision" for size in ("offset=0.1", "offset=-0.1", "scale=2", "scale=0")
)


def main(folder: Path) -> None:
    """Run the pairs in the scan's second scenes, and write what came out beside this file."""
    scan = ROOT / "docs" / "reference" / "scan-wpilib" / "scan.json"
    first, second = ScanRecord.model_validate_json(scan.read_bytes()).scenes
    spec = SystemSpec(name="examples/wpilib_wheels.py:create")
    system = load_system(spec)
    library = library_of(system, "selection")
    scenes = tuple(scene.id for scene in library.scenes[first : first + second])
    pairs = {f"{one} & {other}": (one, other) for one, other in product(DIAMETER, LATENCY)}
    rows = list(rows_of(CORRECT, {VARIANT: ()}, (0,)))
    for text in (*DIAMETER, *LATENCY, *pairs):
        faults = at_readers(system.fault(text), system.variants[VARIANT].readers)
        rows += rows_of(text, {VARIANT: faults}, (0,))
    study = Study(name="pairs", system=spec, library=library.name, scenes=scenes, rows=tuple(rows))
    result = run_study(study, folder, workers=1, system=system, progress=lambda at: print(at.count))
    success, unlike = successes(result.trials, VARIANT, [row.path for row in rows[1:]], scenes)
    assert not unlike
    table = []
    for text, (one, other) in pairs.items():
        alone = np.stack([success[one], success[other]])
        tested = cancelling(success[CORRECT], alone, {(0, 1): success[text]}, set()).pairs[0, 1]
        table.append({"diameter": one, "latency": other, **tested._asdict()})
    (HERE / "pairs.json").write_text(json.dumps(table, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
