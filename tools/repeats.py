"""Whether the code that is here repeats the trials of a stored run: a fixed sample of them.

The sample is drawn by a hash over scenes and seeds, with every version and condition; of a map
or scan, which has many conditions, over these as well. A trial repeats where its status and all its
numbers are equal to the bit, and the hash of its trajectory where the run kept one. The quadrotor's
arithmetic is its own and has to repeat; NumPy and torch choose by processor and get a tolerance.
"""

import hashlib
from collections.abc import Sequence
from contextlib import chdir, suppress

from blocks import OUTCOMES, REFERENCE, REPEATS, ROOT, Repeats, Run

from faultpath.analyses.audit import audit_analysis
from faultpath.analyses.map.analysis import map_analysis
from faultpath.analyses.map.lattice import UNITS
from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.analysis import ScanAnalysis, scan_analysis
from faultpath.analyses.scan.model import ScanResult
from faultpath.api.replaying import outcomes_at
from faultpath.run.attempt import Done, attempt
from faultpath.run.plan import Plan, SystemSpec, Treatment
from faultpath.run.registry import load_system
from faultpath.run.store.folder import read_outcomes
from faultpath.run.store.tables import TrialAddress
from faultpath.run.trials import Trials
from faultpath.system import Outcome, System, library_of

SECONDS = 3.0
"""About how long a sample may take; a scene with all versions and conditions is the least."""
_CONDITIONS = 8
"""Conditions of a map or scan that are sampled."""
_NEAR = 1e-3
"""Share by which a number of a trial may differ where libraries choose how to compute it."""


def repeat(run: Run) -> Repeats:
    """Run a sample of a stored run's trials with the code that is here and compare them."""
    trials = read_outcomes(REFERENCE / run.name / OUTCOMES)
    before = outcomes_at(trials)
    with chdir(ROOT):
        system, plan = planned(run)
        treatments: dict[str, Treatment] = {}
        at: dict[str, list[TrialAddress]] = {}
        for address, treatment in sample(run, plan, before):
            treatments[treatment.key()] = treatment
            at.setdefault(treatment.key(), []).append(address)
        tolerant = run.record.facts.system != "quadrotor"
        repeated, near, first = 0, 0, ""
        for key, addresses in at.items():
            scenes = tuple(dict.fromkeys(address.scene for address in addresses))
            reply = attempt(system, treatments[key], scenes)
            again = {o.scene: o for o in reply.outcomes} if isinstance(reply, Done) else {}
            for address in addresses:
                differs = _differences(before[address], again.get(address.scene))
                repeated += not differs
                alike = tolerant and _alike(before[address], again.get(address.scene))
                near += not differs or alike
                place = ", ".join((address.variant, address.condition, address.scene))
                first = first or (differs and f"{place}, seed {address.seed}: {differs}")
    count = sum(map(len, at.values()))
    return Repeats(trials=len(trials), sampled=count, repeated=repeated, near=near, first=first)


def planned(run: Run) -> tuple[System, Plan]:
    """Return system and trials of a stored audit, map or scan, as the code here plans them."""
    question, facts = run.record.question, run.record.facts
    spec = SystemSpec(name=facts.system, options=question.options)
    system = load_system(spec)
    library = library_of(system, facts.library)
    if isinstance(run.record, ScanResult):
        analysis = scan_analysis(system, spec, question, library, known=run.record.ranking)
        return system, plan_of(analysis, read_outcomes(REFERENCE / run.name / OUTCOMES))
    if not isinstance(run.record, MapResult):
        return system, audit_analysis(system, spec, question, library).plan
    return system, map_analysis(system, spec, question, library).plan(points_of(run.record))


def points_of(record: MapResult) -> list[tuple[int, int]]:
    """Return the points of a map as its analysis counts them."""
    scale = record.facts.up_to
    errors = (point.errors for point in record.points)
    return [(round(x / scale * UNITS), round(y / scale * UNITS)) for x, y in errors]


def plan_of(analysis: ScanAnalysis, trials: Trials) -> Plan:
    """Return the plan of the last round of a scan, whose choices follow from its trials."""
    rounds = analysis.rounds()
    plan = next(rounds).plan
    with suppress(StopIteration):
        while True:
            plan = rounds.send(trials).plan
    return plan


def sample(
    run: Run, plan: Plan, before: dict[TrialAddress, Outcome]
) -> Sequence[tuple[TrialAddress, Treatment]]:
    """Return the trials to repeat, always the same of the same run."""
    treatments = {(row.variant, row.condition, row.seed): row.treatment for row in plan.rows}
    conditions = sorted({condition for _, condition, _ in treatments}, key=_hash_order)
    if not isinstance(run.record, AuditResult):
        conditions = conditions[:_CONDITIONS]
    seeds = {seed for _, _, seed in treatments}
    places = sorted(
        {(at.scene, at.seed) for at in before if at.seed in seeds},
        key=lambda place: _hash_order(*map(str, place)),
    )
    origin = run.provenance
    cost = origin.wall_s * max(origin.machine.workers, 1) / len(before)
    trials = len(conditions) * len({variant for variant, _, _ in treatments})
    places = places[: min(8, max(1, int(SECONDS / (cost * trials))))]
    return [
        (at, treatments[at[:3]])
        for at in sorted(before)
        if at[:3] in treatments and at.condition in conditions and (at.scene, at.seed) in places
    ]


def _hash_order(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _differences(first: Outcome, again: Outcome | None) -> str:
    if again is None or again.failed:
        return "failed now"
    names = ["status", "time_s", *(["trajectory_hash"] if first.trajectory_hash else [])]
    gaps = [n.partition("_")[0] for n in names if getattr(first, n) != getattr(again, n)]
    gaps += [n for n, value in first.metrics.items() if again.metrics.get(n) != value]
    return ", ".join(gaps) and f"other {', '.join(gaps)}"


def _alike(first: Outcome, again: Outcome | None) -> bool:
    if again is None or again.status is not first.status:
        return False
    pairs = [(first.time_s, again.time_s)]
    pairs += [(v or 0.0, again.metrics.get(n) or 0.0) for n, v in first.metrics.items()]
    return all(abs(one - two) <= _NEAR * max(1.0, abs(one)) for one, two in pairs)


def write(run: Run) -> Repeats:
    """Repeat a sample, and keep what came of it beside the run."""
    result = repeat(run)
    (REFERENCE / run.name / REPEATS).write_text(result.model_dump_json(indent=1) + "\n", "utf-8")
    return result
