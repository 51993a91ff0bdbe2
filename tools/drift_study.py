"""The calibration error of the main job, drawn by scene, drifting, and shared only in part.

    python tools/drift_study.py           fly what is missing, and ship it
    python tools/drift_study.py --try 5   see that it flies, on scenes of the selection library

The design was frozen in `docs/reference/drift-L3/design.json` before a held-out scene was flown.
An error `e` supplies mass times `1 + e` and thrust scale times `1 - e`, as the preset `calibration`
does. It is Gaussian: drawn once a scene (law `fixed`), or an Ornstein-Uhlenbeck process (`drift`)
with the same standard deviation at every moment. The reconstruction gets the same error on every
path that strikes it; what differs is how far the predictor's goes along with it.
"""

import argparse
import sys
from collections.abc import Iterable, Sequence
from functools import cache
from math import sqrt
from pathlib import Path

from blocks import REFERENCE, parsed
from flown_code import ROOT
from pydantic import BaseModel, ConfigDict

from faultpath.door.systems import hands
from faultpath.execution import Progress, Stopwatch, run_provenance, run_study
from faultpath.faults import Bias, Fault
from faultpath.planning import scenes_of
from faultpath.record import CORRECT, SHARED
from faultpath.store.folder import OUTCOMES
from faultpath.store.sealed import seal
from faultpath.trials import Arm, Row, Study, System, SystemSpec, library_of, load_system

FOLDER = REFERENCE / "drift-L3"
PREDICTOR, RECONSTRUCTION = "predictor", "reconstruction"
SIGNS = {"mass": 1.0, "thrust_scale": -1.0}
"""Of a calibration error, by channel."""


class Design(BaseModel):
    """What is flown, and nothing else; frozen in a file beforehand."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    question: str
    system: str
    options: dict[str, str]
    baseline: str
    repair: str
    library: str
    scenes: int
    seed: int
    std: float
    """Of the relative error of mass and thrust scale, at every moment."""
    laws: dict[str, float | None]
    """Time constant of the error by law, s; none where it is drawn once a scene."""
    correlations: tuple[float, ...]
    """Between the error at the predictor and the error at the reconstruction."""
    like: str
    """The reference run with one constant error of that size."""
    family: str
    """What is decided together."""

    def paths(self) -> tuple[str, ...]:
        """Return the paths of one law, as `faultpath.record` names them: full correlation is the
        shared error."""
        parts = (joined(each) for each in self.correlations if each < 1)
        return CORRECT, RECONSTRUCTION, *parts, SHARED

    def faults(self, law: str, path: str) -> tuple[Fault, ...]:
        """Return the faults of a path under a law."""
        told = self.std, self.laws[law]
        at_predictor = {joined(each): each for each in self.correlations} | {SHARED: 1.0}
        found: list[Fault] = []
        if path != CORRECT:
            found += _error(*told, 1.0, "calibration", RECONSTRUCTION)
        if path in at_predictor:
            along = at_predictor[path]
            found += _error(*told, along, "calibration", PREDICTOR)
            found += _error(*told, sqrt(1 - along**2), "calibration/predictor", PREDICTOR)
        return tuple(found)

    def study(self, system: System, scenes: Sequence[str], library: str) -> Study:
        """Return the trials; `CORRECT` is flown once for all laws."""
        rows: dict[tuple[str, str], Row] = {}
        for law in self.laws:
            for path in self.paths():
                for variant in (self.baseline, self.repair):
                    present = system.variants[variant].consumers
                    faults = tuple(
                        part
                        for fault in self.faults(law, path)
                        for part in fault.resolved(system.interface, present)
                    )
                    name = row_name(law, path)
                    arm = Arm(variant=variant, faults=faults, seed=self.seed)
                    rows[variant, name] = Row(variant=variant, path=name, seed=self.seed, arm=arm)
        spec = SystemSpec(name=self.system, options=self.options)
        return Study(
            name="drift-L3",
            system=spec,
            library=library,
            scenes=tuple(scenes),
            rows=tuple(rows.values()),
        )


def joined(correlation: float) -> str:
    """Return what a path is called on which both modules err, with a correlation below 1."""
    return f"correlation {correlation:g}"


def row_name(law: str, path: str) -> str:
    """Return what a path of a law is called in the outcome table."""
    return path if path == CORRECT else f"{law}/{path}"


def _error(
    std: float, time_constant_s: float | None, share: float, cause: str, module: str
) -> Iterable[Fault]:
    if not share:
        return ()
    bias = Bias(std=std * share, relative=True, time_constant_s=time_constant_s)
    return (
        Fault(channel=channel, intervention=bias, consumers=(module,), cause=cause, loading=sign)
        for channel, sign in SIGNS.items()
    )


@cache
def design() -> Design:
    """Return the frozen design."""
    return parsed(FOLDER / "design.json", Design, "bring it back from the history")


def fly(asked: Design, library: str, count: int, folder: Path, workers: int) -> None:
    """Fly what the folder lacks; write its provenance."""
    stopwatch = Stopwatch()
    system = load_system(SystemSpec(name=asked.system, options=asked.options))
    scenes = scenes_of(library_of(system, library), count)
    told = set[int]()

    def note(now: Progress) -> None:
        if now.trials_done not in told:
            told.add(now.trials_done)
            print(f"{now.trials_done} of {now.trials_total} trials", flush=True)

    with hands(system, workers) as workforce:
        result = run_study(
            asked.study(system, scenes, library),
            folder,
            progress=note,
            notice=print,
            system=system,
            shared=True,  # so that a part of the scenes may be flown first
            executor=workforce,
        )
        command, files = ("python", "tools/drift_study.py"), seal(folder, (OUTCOMES,))
        made = run_provenance(result, stopwatch, command, workforce, system.backend, files)
    (folder / "provenance.json").write_text(made.model_dump_json(indent=2) + "\n", "utf-8")
    for said in (*result.findings, *(f"failed: {each.error}" for each in result.failures)):
        print(said)


def main(arguments: Sequence[str] | None = None) -> int:
    """Fly; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--try", dest="tried", type=int, metavar="N", help="N selection scenes")
    parser.add_argument(
        "--first", type=int, metavar="N", help="only N scenes for now; ship nothing"
    )
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args(arguments)
    asked, runs = design(), ROOT / "runs"
    if given.tried:
        fly(asked, "selection", given.tried, runs / "drift-selection", given.workers)
        return 0
    folder = runs / "drift-L3"
    fly(asked, asked.library, given.first or asked.scenes, folder, given.workers)
    if given.first:
        return 0
    for name in (OUTCOMES, "provenance.json"):
        (FOLDER / name).write_bytes((folder / name).read_bytes())
    return 0


if __name__ == "__main__":
    sys.exit(main())
