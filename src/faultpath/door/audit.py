"""`faultpath.audit`: run the arms of one question, decide, and write the run folder."""

import hashlib
import re
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from datetime import datetime
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, get_args

from faultpath.door.display import Display, display
from faultpath.door.systems import LOCAL, Chosen, choose, hands
from faultpath.errors import UserError
from faultpath.planning import plan_audit
from faultpath.record import Generalise, StopRule, StopWhen
from faultpath.setup_limit import setup_limit
from faultpath.statistics import IN_FORCE, RULES, RuleName
from faultpath.trials import System, library_of
from faultpath.trials.state import system_code

if TYPE_CHECKING:
    from faultpath.door.run import Run

_SHARED = Path("runs") / ".shared"
"""Where runs into folders that nobody named share trials."""

_LONGEST_NAME = 180
"""Of a run folder; file systems take 255 bytes."""


def audit(
    system: str | PathLike[str] | System,
    *,
    baseline: str,
    repair: str,
    fault: str,
    library: str = "held-out",
    scenes: int | None = None,
    seeds: int | Sequence[int] = 0,
    primary: str | None = None,
    generalise: Generalise = "scenes",
    stop_when: StopWhen | None = None,
    margin_pp: float | None = None,
    rule: RuleName = IN_FORCE,
    options: Mapping[str, object] | None = None,
    folder: str | PathLike[str] | None = None,
    workers: int | None = None,
    time_limit_s: float | None = None,
    progress: bool | Display = True,
    metric: str = "",
    thresholds: Sequence[float] = (),
    executor: str = LOCAL,
    share: str | PathLike[str] | None = None,
    signals: bool = True,
) -> "Run":
    """Audit a repair against a baseline under correct inputs, under the fault at each module
    alone, and under the shared fault.

    Args:
        system: `quadrotor`, `module:attribute`, `file.py:attribute`, a file in which `create`
            builds the system, or a `System`. One that `load_system` gave is built again from its
            name and options, in worker processes too. Any other object flies as it is, in this
            process, and its trials are never taken for those of another call.
        baseline: Variant to compare with. For the quadrotor also what builds a predictor,
            reconstruction or planner of your own, as `my_model.py:create`.
        repair: Variant that is meant to help, named likewise.
        fault: As on the command line: `calibration=+0.1`, `mass:scale=1.1`,
            `wind:delay=5@predictor,onset=20`.
        library: Library of scenes, by name or file.
        scenes: How many of its first scenes; `None` for all.
        seeds: Seeds of the noise, and of trained models where there are any.
        primary: Path that leads the headline, a module or `shared`; default the shared one.
        generalise: To new `scenes`, or to newly trained `models` too, which takes several seeds.
        stop_when: Stop as soon as the primary contrast is `decided`, or the effect on every path is
            (`all-decided`): scenes come in a random order, `scenes` is the most that are flown, and
            intervals and tests are such that hold wherever one stops. Default: fly all.
        margin_pp: A difference that is shown to be smaller than this, in percentage points, ends
            a sequential audit too.
        rule: By which an audit with a fixed number of scenes is decided. `exact` was in force
            before and is for scenes seen under it: no verdict is redone by a rule chosen later.
        options: The system's own options, such as `{"wind": "L3"}`.
        folder: Run folder. The default is `runs/<question>-<code>` in the working directory, so
            that the same call resumes, and finds what is finished.
        workers: Worker processes, 0 for this process alone; default one per core where that helps.
        time_limit_s: Seconds that a block of scenes may take in a worker.
        progress: Whether to show progress and notices, in a notebook's cell or on the standard
            error; otherwise notices go to the log `faultpath`.
        metric: Of the system's own, told beside success.
        thresholds: Of that metric, at which success is told anew.
        executor: `local` for processes of this machine, `ray` for the Ray cluster that
            `RAY_ADDRESS` names or that runs here, else one of the call's own, or `ray:HOST:PORT`.
        share: Folder in which runs into other folders find what this one flew, and this one what
            they flew, of the same arms and scenes, by the same code, on the same machine. The
            default is `runs/.shared` where `folder` is left out; a folder that you name is flown
            from scratch. Only trials that this machine's worker processes flew are shared.
        signals: Whether to fly the scenes that the report begins with once more and keep what their
            modules read and wrote, for the report to plot.

    Raises:
        UserError: What was asked cannot be done; the sentence says why, and what to do.
        Stopped: Ctrl-C, or a notebook's stop button, ended it; the same call resumes.
    """
    given = dict(locals())
    checked_texts(baseline=baseline, repair=repair, fault=fault, library=library)
    drawn = checked_seeds(seeds)
    called = isinstance(progress, Display) and progress.is_command
    limit = setup_limit(str(system), time_limit_s) if called else nullcontext()
    with limit:
        chosen = choose(system, options or {}, workers, (baseline, repair), executor)
        built = chosen.system
        scenes_from = library_of(built, library)
    asked = plan_audit(
        built,
        chosen.spec,
        baseline=baseline,
        repair=repair,
        fault=built.fault(fault),
        fault_text=fault,
        library=scenes_from,
        scenes=checked_count("scenes", scenes),
        seeds=drawn,
        primary=primary,
        generalise=generalise,
        metric=metric,
        thresholds=thresholds,
        stop_when=_checked_stop(stop_when),
        margin_pp=_checked_margin(margin_pp),
        rule=_checked_rule(rule),
    )
    said = {"system": chosen.spec.name, "options": chosen.spec.options}
    told = display(progress, "audit", given | said)

    # What flies, stores and draws takes a while to load, and no mistake so far waits for it.
    from faultpath.door.carrying_out import carry_out
    from faultpath.door.job import Job
    from faultpath.door.run import Run
    from faultpath.store import read_table
    from faultpath.store.folder import OUTCOMES
    from faultpath.store.sealed import read_regular

    named = [asked.study.name, fault, Path(library).stem]
    named += [f"{metric}-{','.join(f'{each:g}' for each in thresholds)}"] if metric else []
    named += [] if rule == IN_FORCE else [f"rule-{rule}"]
    named += _until(asked.question.stop)
    place = run_folder(folder, chosen, named, scenes, drawn)
    if chosen.notice:
        told.say(chosen.notice)
    between = between_runs(share, folder, executor)
    with hands(built, chosen.workers, chosen.executor) as workforce:
        job = Job(place, workforce, told, time_limit_s, between)
        held = carry_out(built, asked, job, signals)
    run = Run(place, held, read_table(read_regular(place / OUTCOMES)))
    run.report()
    return run


def between_runs(
    share: str | PathLike[str] | None, folder: str | PathLike[str] | None, executor: str
) -> Path | None:
    """Return the folder in which a run shares trials with others, if it does."""
    if executor != LOCAL:
        return None
    if share is not None:
        return Path(share)
    return _SHARED if folder is None else None


def run_folder(
    folder: str | PathLike[str] | None,
    chosen: Chosen,
    named: Sequence[str],
    scenes: int | None,
    seeds: Sequence[int],
) -> Path:
    """Return the folder of a run.

    Without a `folder` it is that of the question, which `named` tells apart, and of the code as it
    is. `UserError` for one that holds a run of an object, which may have been another.
    """
    from faultpath.store.manifest import keyed

    name = _name(chosen, named, scenes, seeds)
    if folder is None and not chosen.own:
        return keyed(Path("runs"), name, system_code(chosen.system, chosen.spec).state)
    now = datetime.now().strftime("%Y%m%d-%H%M%S-%f")
    place = Path("runs") / f"{name}-{now}" if folder is None else Path(folder)
    if chosen.own and (place / "manifest.json").exists():
        raise UserError(
            f"{place} holds a run, and whether it was of this same object cannot be told: give "
            "another folder, or put what builds the system into a file and name that."
        )
    return place


def _name(chosen: Chosen, named: Sequence[str], scenes: int | None, seeds: Sequence[int]) -> str:
    """Name the run folder after everything that makes it another study."""
    drawn = ",".join(map(str, seeds))
    options = (f"{key}-{value}" for key, value in sorted(chosen.spec.options.items()))
    parts = [*named, *options]
    if scenes is not None:
        parts.append(f"{scenes}-scenes")
    if drawn != "0":
        parts.append(f"seeds-{drawn}")
    name = re.sub(r"[^A-Za-z0-9.+=,_-]+", "_", "-".join(parts)).strip("._")
    if len(name) > _LONGEST_NAME:
        name = f"{name[:_LONGEST_NAME]}-{hashlib.sha256(name.encode()).hexdigest()[:12]}"
    return name


def checked_texts(**given: object) -> None:
    """Raise `UserError` for what is no text."""
    for name, value in given.items():
        if not isinstance(value, str):
            raise UserError(f"{name} is {value!r:.80}: give it as text.")


def checked_count(name: str, value: object) -> int | None:
    """Return a whole number or `None`; `UserError` for anything else."""
    if value is None or (isinstance(value, int) and not isinstance(value, bool)):
        return value
    raise UserError(f"{name} is {value!r:.80}: give a whole number, or None.")


def _until(rule: StopRule | None) -> list[str]:
    if rule is None:
        return []
    small = "" if rule.margin_pp is None else f"-within-{rule.margin_pp:g}"
    return [f"until-{rule.when}{small}"]


def _checked_rule(rule: object) -> RuleName:
    for known in RULES:
        if rule == known:
            return known
    raise UserError(f"rule is {rule!r:.80}: choose {' or '.join(RULES)}.")


def _checked_stop(rule: object) -> StopWhen | None:
    rules: tuple[StopWhen, ...] = get_args(StopWhen)
    for known in rules:
        if rule == known:
            return known
    if rule is None:
        return None
    raise UserError(f"stop_when is {rule!r:.80}: choose {' or '.join(rules)}, or None.")


def _checked_margin(margin: object) -> float | None:
    if margin is None or (isinstance(margin, (int, float)) and not isinstance(margin, bool)):
        return margin
    raise UserError(f"margin_pp is {margin!r:.80}: give a number of percentage points, or None.")


def checked_seeds(seeds: int | Sequence[int]) -> tuple[int, ...]:
    """Return the seeds; `UserError` for what is no whole number between 0 and 2^63 - 1."""
    found: tuple[object, ...] = (
        tuple(seeds) if isinstance(seeds, Sequence) and not isinstance(seeds, str) else (seeds,)
    )
    for seed in found:
        if not isinstance(seed, int) or isinstance(seed, bool) or not 0 <= seed < 2**63:
            raise UserError(
                f"{seed!r:.80} is not a seed: give whole numbers between 0 and 2^63 - 1."
            )
    return tuple(seed for seed in found if isinstance(seed, int))
