"""Conclude stored reference runs anew: the same trials, decided by the code that is here."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from blocks import PROVENANCE, REFERENCE, ROOT, load, parsed
from faultpath_paper.claims import again
from faultpath_paper.reproduction import write_pages
from faultpath_paper.run import CONCLUSIONS, built, read_results
from paper_blocks import PLACE, RUN
from repeats import points_of

from faultpath.analyses.decide import decide
from faultpath.analyses.map.analysis import map_analysis
from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.decide import concluded
from faultpath.analyses.scan.errors import Scanned
from faultpath.analyses.scan.model import ScanResult
from faultpath.api.folders import MAP, RECORD, SCAN, as_text
from faultpath.api.replaying import shown_first
from faultpath.api.runs import open_run
from faultpath.report.map import tables
from faultpath.report.sentences import words
from faultpath.report.tables import markdown_blocks
from faultpath.run.deliveries import Deliveries
from faultpath.run.plan import SystemSpec
from faultpath.run.provenance import RunProvenance, seal
from faultpath.run.registry import load_system
from faultpath.run.store.folder import OUTCOMES, TRACES, read_outcomes
from faultpath.run.store.tables import decode_outcomes, decode_traces, encode_traces
from faultpath.run.trials import Trials
from faultpath.system import library_of


def conclude_all(say: Callable[[str], None]) -> None:
    """Decide every reference run anew and write its record, table and page; then the paper's."""
    for folder in sorted(path.parent for path in REFERENCE.glob(f"*/{RECORD}")):
        before = words(parsed(folder / RECORD, AuditResult)).headline
        say(f"{folder.name}: {before}\n    now: {words(audit(folder)).headline}")
    for folder in sorted(path.parent for path in REFERENCE.glob(f"*/{MAP}")):
        say(f"{folder.name}: {words(reversal_map(folder)).headline}")
    for folder in sorted(path.parent for path in REFERENCE.glob(f"*/{SCAN}")):
        say(f"{folder.name}: {words(scan(folder)).headline}")
    for line in paper(RUN, PLACE):
        say(f"the paper: {line}")


def audit(folder: Path) -> AuditResult:
    """Decide a stored audit anew and write its record and pages."""
    before = parsed(folder / RECORD, AuditResult)
    outcomes = read_outcomes(folder / OUTCOMES)
    record = decide(before.question, before.facts, before.conditions, outcomes, before.findings)
    (folder / RECORD).write_text(as_text(record), "utf-8")
    _keep_examples(folder, record, outcomes)
    _reseal(folder)
    open_run(folder).report()
    return record


def _keep_examples(folder: Path, record: AuditResult, trials: Trials) -> None:
    """Leave out the traces of all trials but those of the scenes that the report begins with."""
    traces = decode_traces((folder / TRACES).read_bytes())
    shown = shown_first(record, trials, traces)
    kept = {at: trace for at, trace in traces.items() if (at.scene, at.seed) in shown}
    if len(kept) < len(traces):
        examples = decode_outcomes((folder / OUTCOMES).read_bytes(), kept)
        (folder / TRACES).write_bytes(encode_traces(examples))


def reversal_map(folder: Path) -> MapResult:
    """Decide a reference map anew from its trials; write its record and table."""
    before = load(folder.name).record
    question, facts = before.question, before.facts
    place = str(ROOT / facts.system) if ".py:" in facts.system else facts.system
    spec = SystemSpec(name=place, options=question.options)
    system = load_system(spec)
    analysis = map_analysis(system, spec, question, library_of(system, facts.library))
    findings = Deliveries(rows=(), findings=before.findings)
    analysis = replace(analysis, facts=facts)
    record = analysis.conclude(read_outcomes(folder / OUTCOMES), findings, points_of(before))
    (folder / MAP).write_text(record.model_dump_json(indent=1) + "\n", "utf-8")
    (folder / "table.md").write_text(markdown_blocks(tables(record)) + "\n", "utf-8")
    _reseal(folder)
    load.cache_clear()
    return record


def scan(folder: Path) -> ScanResult:
    """Decide a reference scan anew from its trials; write its result, tables and page."""
    before = parsed(folder / SCAN, ScanResult)
    trials = read_outcomes(folder / OUTCOMES)
    version, first = before.versions[0], before.scenes[0]
    scenes = tuple(scene.id for scene in trials.scenes)
    scanned = Scanned(
        tried=tuple(stage.error for stage in version.first),
        errors=before.errors,
        chosen=before.chosen,
        singles=tuple(single.error for single in version.singles),
        pairs=tuple(pair.errors for pair in version.pairs),
        together=tuple(together.errors for together in version.together),
        first=scenes[:first],
        second=scenes[first:],
    )
    deliveries = Deliveries(rows=(), findings=before.findings)
    record = concluded(before.question, before.facts, before.ranking, scanned, trials, deliveries)
    (folder / SCAN).write_text(record.model_dump_json(indent=1) + "\n", "utf-8")
    _reseal(folder)
    open_run(folder).report()
    load.cache_clear()
    return record


def paper(folder: Path, target: Path) -> list[str]:
    """Conclude a reproduction; return the claims whose answers changed, with both answers."""
    results, old = read_results(folder)
    update = {"ledger": again(results, old.ledger), **built(results)}
    record = old.model_copy(update=update)
    (folder / CONCLUSIONS).write_text(record.model_dump_json(indent=1) + "\n", "utf-8")
    write_pages(target, record, _reseal(folder))
    answers = {claim.id: claim.verdict for claim in old.ledger.claims}
    return [
        f"{claim.id}: {answers.get(claim.id, 'not answered')} -> {claim.verdict}"
        for claim in record.ledger.claims
        if claim.verdict != answers.get(claim.id)
    ] or ["No claim changed its answer."]


def _reseal(folder: Path) -> RunProvenance:
    """Write the digests of the files that were made anew; a run that kept none keeps none."""
    origin = parsed(folder / PROVENANCE, RunProvenance)
    if not origin.files:
        return origin
    here = [name for name in origin.files if (folder / name).is_file()]
    sealed = origin.model_copy(update={"files": {**origin.files, **seal(folder, here)}})
    (folder / PROVENANCE).write_text(sealed.model_dump_json(indent=2) + "\n", "utf-8")
    return sealed
