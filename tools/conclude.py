"""Conclude stored reference runs anew: the same trials, decided by the code that is here.

Where the tracks of the flights that a page shows are not stored beside it, they are read back from
the page.
"""

import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import map_blocks
import numpy as np
from blocks import REFERENCE, ROOT
from numpy.typing import NDArray

from faultpath.door.saved import MAP, RECORD, SYSTEM, TRACES, as_text
from faultpath.faults import parse_fault
from faultpath.record import DecisionRecord, Question, RunProvenance, decide
from faultpath.record import Path as FaultPath
from faultpath.report.html import write_report
from faultpath.report.inputs import ReportInput, Traces
from faultpath.report.reproduction.inputs import ReproductionInput
from faultpath.report.reproduction.page import reproduction_page
from faultpath.report.reproduction.terminal import ledger_markdown
from faultpath.report.viewer_packing import unpack
from faultpath.store import TrialAddress, read_outcomes, read_traces
from faultpath.store.sealed import seal
from faultpath.store.signals import SIGNALS, decode_signals
from faultpath.studies import reversal, shipped
from faultpath.studies.central import of_page
from faultpath.studies.claims import LIMITS, TOPICS, again
from faultpath.studies.pages import PAGES, table_4
from faultpath.studies.run import CONCLUSIONS, plan, read_results
from faultpath.tables import latex, markdown
from faultpath.taps import TapCount
from faultpath.trials import (
    Deliveries,
    OutcomeTable,
    RowDeliveries,
    System,
    SystemSpec,
    load_system,
    system_shown,
)

_DATA = re.compile(r'id="viewer-data">(.*?)</script>', re.DOTALL)


def conclude_all(tell: Callable[[str], None]) -> None:
    """Decide every reference run anew and write its record, table and page; then the paper's."""
    for folder in sorted(path.parent for path in REFERENCE.glob("*/record.json")):
        before = json.loads((folder / "record.json").read_bytes())
        record = _audit(folder, before)
        tell(f"{folder.name}: {before['verdict']['headline']}\n    now: {record.verdict.headline}")
    for folder in sorted(path.parent for path in REFERENCE.glob(f"*/{MAP}")):
        tell(f"{folder.name}: {map_blocks.conclude(folder).headline}")
    for platform in shipped.shipped():
        for line in _paper(shipped.RUNS / platform, REFERENCE / "paper" / platform):
            tell(f"the paper on {platform}: {line}")


def _audit(folder: Path, before: Mapping[str, Any]) -> DecisionRecord:
    system, record, outcomes = _decided(folder, before)
    (folder / RECORD).write_text(as_text(record), "utf-8")
    origin = RunProvenance.model_validate_json((folder / "provenance.json").read_bytes())
    scenes = list(dict.fromkeys(row.outcome.scene for row in outcomes.rows))
    shown = system_shown(system, (record.question.baseline, record.question.repair), scenes)
    stored, kept = folder / TRACES, (folder / SIGNALS).is_file()
    tracks = read_traces(stored) if stored.is_file() else _tracks(folder / "report.html")
    if SYSTEM in origin.files:
        (folder / SYSTEM).write_text(shown.model_dump_json(indent=1) + "\n", "utf-8")
    write_report(
        ReportInput(
            record=record,
            provenance=_reseal(folder, origin),
            interface=shown.interface,
            variants=shown.variants,
            outcomes=outcomes,
            traces=Traces(tracks, shown.control_dt_s),
            plans=shown.plans,
            signals=decode_signals((folder / SIGNALS).read_bytes()) if kept else {},
        ),
        folder,
    )
    return record


def _decided(
    folder: Path, before: Mapping[str, Any]
) -> tuple[System, DecisionRecord, OutcomeTable]:
    asked = Question.model_validate(before["question"])
    place = str(ROOT / asked.system) if ".py:" in asked.system else asked.system
    system = load_system(SystemSpec(name=place, options=asked.options))
    presets, dt_s = system.fault_presets, system.control_dt_s
    asked = asked.model_copy(
        update={
            "faults": parse_fault(asked.fault, system.interface, presets, dt_s).resolved(
                system.interface
            ),
            "trained": system.trained,
            "ends": {status.value: words for status, words in system.ends.items()},
            "metrics": dict(system.metrics),
        }
    )
    paths = [FaultPath.model_validate(path) for path in before["paths"]]
    outcomes = read_outcomes(folder / "outcomes.parquet")
    record = decide(asked, paths, outcomes, findings=tuple(before.get("findings", ())))
    return system, record, outcomes


def _paper(folder: Path, target: Path) -> list[str]:
    """Conclude a shipped reproduction; return what its claims were answered and now are."""
    results, old = read_results(folder)
    was = old.ledger
    built = [part for page in PAGES for part in page.build(results)]
    names = {table.name for table in old.tables}
    found = old.model_copy(
        update={
            "ledger": again(results, was),
            "tables": tuple(part for part in built if part.name in names),
            "figures": tuple(part for part in built if part.name not in names),
        }
    )
    origin = RunProvenance.model_validate_json((folder / "provenance.json").read_bytes())
    asked = plan((), old.profile, options={shipped.PLATFORM: was.platform})
    leg = next(leg for leg in asked.legs() if leg.setting == table_4.WINDY)
    outcomes = reversal.audited(results.outcomes)
    scenes = {row.outcome.scene for row in outcomes.rows} | {each.scene for each in found.gallery}
    page = reproduction_page(
        ReproductionInput(
            reproduction=found,
            provenance=origin,
            interface=asked.system.interface,
            variants=reversal.wired(leg),
            outcomes=outcomes,
            decision=reversal.decision(outcomes, leg, _deliveries(was.platform)),
            traces=Traces(_tracks(target / "reproduction.html"), asked.system.control_dt_s),
            plans=_plans(asked.system, sorted(scenes)),
            beside=shipped.beside(found.ledger),
            topics=TOPICS,
            limits=LIMITS,
            central=of_page(found),
        )
    )
    tables = found.tables
    (folder / CONCLUSIONS).write_text(found.model_dump_json(indent=1) + "\n", "utf-8")
    _reseal(folder, origin)
    (target / "reproduction.html").write_text(page, "utf-8")
    (target / "tables.tex").write_text(latex.document(tables), "utf-8")
    (target / "tables.md").write_text("\n\n".join(map(markdown.block, tables)) + "\n", "utf-8")
    (target / "ledger.md").write_text(ledger_markdown(found.ledger, found.profile), "utf-8")
    answers = {claim.id: claim.verdict for claim in was.claims}
    return [
        f"{claim.id}: {answers.get(claim.id, 'not answered')} -> {claim.verdict}"
        for claim in found.ledger.claims
        if claim.verdict != answers.get(claim.id)
    ] or ["No claim changed its answer."]


def _deliveries(platform: str) -> Deliveries:
    """Return what the taps did in the arms of Table IV's question.

    The shipped run keeps no receipts. The main job flies the same arms with its first seed on the
    default platform, and its record has theirs; without that run nothing is shown as struck.
    """
    record = REFERENCE / "quadrotor-L3" / "record.json"
    same = platform == shipped.default_platform() and record.is_file()
    paths = json.loads(record.read_bytes())["paths"] if same else []
    of = {path["name"]: path for path in paths}
    rows = [
        RowDeliveries(
            variant=variant,
            path=table_4.cell(variant, path).path,
            seed=0,
            taps=tuple(
                TapCount(deliveries=tap["struck_steps"], **tap)
                for tap in of.get(name, {}).get(field, ())
            ),
        )
        for path, name in reversal.NAMES.items()
        for variant, field in ((reversal.REPAIR, "struck"), (reversal.BASELINE, "baseline_struck"))
    ]
    return Deliveries(rows=tuple(rows))


def _plans(system: System, scenes: list[str]) -> dict[str, Any]:
    plans = ((scene, system.floor_plan(scene)) for scene in scenes)
    return {scene: drawn for scene, drawn in plans if drawn is not None}


def _tracks(page: Path) -> dict[TrialAddress, NDArray[np.float32]]:
    held = _DATA.search(page.read_text("utf-8"))
    if held is None:  # a system that leaves no traces
        return {}
    content = json.loads(held[1])
    data, series = unpack(content["packed"])
    tracks: dict[TrialAddress, NDArray[np.float32]] = {}
    for scene in data["scenes"]:
        for pair in scene["pairs"]:
            for arm in ("baseline", "repair"):
                if not pair[arm] or (place := pair[arm]["track"]) is None:
                    continue
                key = TrialAddress(data[arm], pair["path"], scene["seed"], scene["scene"])
                centimetres = np.stack(series[place : place + 3], axis=1).astype(np.float32)
                tracks[key] = centimetres / np.float32(100.0)
    return tracks


def _reseal(folder: Path, origin: RunProvenance) -> RunProvenance:
    """Write the digests of what was concluded anew; a run that kept none keeps none."""
    if not origin.files:
        return origin
    here = [name for name in origin.files if (folder / name).is_file()]
    files = {**origin.files, **seal(folder, here)}
    sealed = origin.model_copy(update={"files": files})
    (folder / "provenance.json").write_text(sealed.model_dump_json(indent=2) + "\n", "utf-8")
    return sealed
