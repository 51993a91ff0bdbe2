"""What run folders there are, read as data: kind, verdict, and how far each has come."""

import os
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path
from typing import Literal

from faultpath.door.saved import MAP, RECORD, parsed, read_provenance
from faultpath.errors import UserError
from faultpath.record import DecisionRecord, Reproduction, RunProvenance
from faultpath.store.folder import OUTCOMES
from faultpath.store.manifest import read_manifest
from faultpath.store.parquet import Unreadable, rows_in
from faultpath.store.sealed import read_regular, unseal

Kind = Literal["audit", "map", "reproduction", "probe", "run"]
"""A `run` is damaged so that its kind cannot be told."""
State = Literal["finished", "unfinished", "damaged"]

_PROVENANCE, _REPRODUCTION, _PROBE = "provenance.json", "reproduction.json", "probe.json"
_MEASURED = (".rows", ".measured.parquet")
"""How files end that a probe keeps."""
_LEGS = ("flights", "windows")
"""What a reproduction flies and measures in."""


@dataclass(frozen=True)
class Listed:
    """A run folder, as it was found."""

    folder: str
    kind: Kind
    state: State
    words: str
    """The verdict of a finished run; of any other, what is there or what is wrong."""
    date: datetime | None = None
    """When it ended; of an unfinished one, when something was last written into it."""
    fingerprint: str = ""
    """Of the code that flew."""
    scenes: int | None = None
    trials: int | None = None
    """Of a finished run those in its outcome table; of another those kept so far."""
    wall_s: float | None = None
    """Of the last invocation."""
    resumed: bool = False
    """Whether earlier invocations flew a part, which `wall_s` leaves out."""


def runs(folders: Sequence[Path]) -> tuple[Listed, ...]:
    """Return the runs in and below some folders, the latest first, those without a date last.

    A finished run is told only if its files are as it left them. `UserError` for a folder that is
    not there.
    """
    for folder in folders:
        if not folder.is_dir():
            raise UserError(f"{folder} is no folder: give one that holds runs.")
    found = {path.resolve(): listed for folder in folders for path, listed in _below(folder)}
    early = datetime.min.replace(tzinfo=UTC)
    return tuple(sorted(found.values(), key=lambda each: each.date or early, reverse=True))


def _below(top: Path) -> Iterator[tuple[Path, Listed]]:
    for name, inside, files in os.walk(top):
        folder, held = Path(name), {*inside, *files}
        legs = "flights" in inside and any(folder.glob("flights/*/manifest.json"))
        inside[:] = sorted(
            each
            for each in inside
            if not each.startswith(".")
            and each not in ("shards", "failures", *(_LEGS if legs else ()))
        )
        if _PROVENANCE in held or (OUTCOMES in held and held & {RECORD, MAP, _REPRODUCTION}):
            yield folder, _ended(folder)
        elif "manifest.json" in held and "shards" in held:
            yield folder, _begun(folder)
        elif legs and not any(folder.glob(f"*/{_PROVENANCE}")):
            yield folder, _flying(folder)
        elif _PROBE in held or any(each.endswith(_MEASURED) for each in files):
            yield folder, _probe(folder, files)


def _ended(folder: Path) -> Listed:
    """Tell of a folder that says that its run has ended."""
    try:
        provenance = read_provenance(folder)
        told = Listed(
            str(folder),
            "run",
            "finished",
            "",
            date=_moment(provenance.finished),
            fingerprint=provenance.system_fingerprint,
            wall_s=provenance.wall_s if isfinite(provenance.wall_s) else None,
            resumed=provenance.blocks_kept > 0,
        )
        return _verdict(folder, provenance, told)
    except (UserError, Unreadable, OSError) as error:
        return Listed(str(folder), _kind(folder), "damaged", _briefly(folder, str(error)))


def _kind(folder: Path) -> Kind:
    kinds: tuple[tuple[str, Kind], ...] = (
        (RECORD, "audit"),
        (MAP, "map"),
        (_REPRODUCTION, "reproduction"),
    )
    for name, kind in kinds:
        if (folder / name).exists():
            return kind
    return "run"


def _verdict(folder: Path, provenance: RunProvenance, told: Listed) -> Listed:
    """Add what was decided; raises where the files are not those that the run left."""
    kind = _kind(folder)
    needed = {"audit": RECORD, "map": MAP, "reproduction": _REPRODUCTION}.get(kind)
    if needed is None:
        if not provenance.files.keys().isdisjoint((RECORD, MAP, _REPRODUCTION)):
            raise UserError(f"{folder} holds no {RECORD}: give the folder of a finished run.")
        unseal(folder, provenance.files, (OUTCOMES,))
        words = "Trials of a study; what they decide stands elsewhere."
        return replace(told, words=words, trials=rows_in(folder / OUTCOMES))
    held = unseal(folder, provenance.files, (needed, OUTCOMES))
    if kind == "audit":
        audit = parsed(held[RECORD], folder / RECORD, DecisionRecord)
        words, scenes = audit.verdict.headline, audit.scenes
    elif kind == "map":
        from faultpath.plane.model import MapRecord

        map_ = parsed(held[MAP], folder / MAP, MapRecord)
        words, scenes = map_.headline, map_.scenes
    else:
        from faultpath.report.reproduction.words import headline

        paper = parsed(held[_REPRODUCTION], folder / _REPRODUCTION, Reproduction)
        words, scenes = f"{headline(paper.ledger, paper.profile)}.", paper.ledger.scenes
    trials = rows_in(folder / OUTCOMES)
    return replace(told, kind=kind, words=words, scenes=scenes, trials=trials)


def _begun(folder: Path) -> Listed:
    """Tell how far a run has come that has not ended."""
    kept, last = _kept(folder)
    told = Listed(str(folder), "run", "unfinished", "", date=last, trials=kept)
    place = folder / "manifest.json"
    try:
        manifest = read_manifest(place) if place.is_file() else None
    except UserError as error:
        return replace(told, state="damaged", words=_briefly(folder, str(error)))
    if manifest is None:
        return replace(told, state="damaged", words="manifest.json is not a file")
    study = manifest.study
    asked, maps = len(study.arms()) * len(study.scenes), any("," in r.path for r in study.rows)
    # A map grows from round to round, so what it asks for now is not all.
    rows = len(study.rows) * len(study.scenes)
    table = f", which stand for {rows}" if rows != asked else ""
    of = "" if maps else f"; the run asks for {asked}{' at most' if study.look else ''}{table}"
    return replace(
        told,
        kind="map" if maps else "audit",
        words=f"{kept} trials kept{of}",
        fingerprint=manifest.code.digest,
        scenes=len(study.scenes),
    )


def _flying(folder: Path) -> Listed:
    """Tell how far a reproduction has come that has concluded nothing."""
    legs = [_kept(place.parent) for place in sorted(folder.glob("flights/*/manifest.json"))]
    kept = sum(trials for trials, _ in legs)
    words = f"{kept} trials kept, of {len(legs)} settings so far"
    last = max((moment for _, moment in legs if moment), default=None)
    return Listed(str(folder), "reproduction", "unfinished", words, date=last, trials=kept)


def _kept(folder: Path) -> tuple[int, datetime | None]:
    rows: dict[str, int] = {}
    files = [path for path in (folder / "shards").glob("*-*.parquet") if path.is_file()]
    for path in files:
        with suppress(Unreadable):  # such a block is flown again
            rows[path.name.partition("-")[0]] = rows_in(path)
    return sum(rows.values()), _written([*files, folder / "manifest.json"])


def _probe(folder: Path, files: Sequence[str]) -> Listed:
    from faultpath.evidence.probe import Probe

    if _PROBE not in files:
        kept = sum(each.endswith(_MEASURED[1]) for each in files)
        last = _written([folder / each for each in files])
        words = f"{kept} measurements kept"
        return Listed(str(folder), "probe", "unfinished", words, date=last)
    place = folder / _PROBE
    try:
        probe = parsed(read_regular(place), place, Probe)
    except UserError as error:
        return Listed(str(folder), "probe", "damaged", _briefly(folder, str(error)))
    names = ", ".join(dict.fromkeys(row.variant for row in probe.rows))
    words = f"Measures the responses of {names} on {probe.windows} windows; decides nothing."
    last = _written([place])
    return Listed(str(folder), "probe", "finished", words, date=last, scenes=probe.scenes)


def _written(files: Sequence[Path]) -> datetime | None:
    moments = [path.stat().st_mtime for path in files if path.is_file()]
    return datetime.fromtimestamp(max(moments), UTC) if moments else None


def _moment(text: str) -> datetime | None:
    try:
        moment = datetime.fromisoformat(text)
        return moment.astimezone(UTC) if moment.tzinfo else moment.replace(tzinfo=UTC)
    except (ValueError, OverflowError):  # somebody else's folder may say anything
        return None


def _briefly(folder: Path, sentence: str) -> str:
    wrong = sentence.rpartition(": ")[0] or sentence
    for named in (f"{folder}/", f"{folder}: ", f"{folder} "):
        wrong = wrong.replace(named, "")
    return wrong
