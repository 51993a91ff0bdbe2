"""A scan as tables, pictures, terminal and page; all numbers are the result's."""

from pathlib import Path

from faultpath.decisions.scan.record import ScanRecord
from faultpath.decisions.scan.sources import Candidate, Ranking
from faultpath.decisions.sentences import wording
from faultpath.decisions.sentences.scan import named, size
from faultpath.decisions.tables import Entry, Line, Table, line
from faultpath.decisions.tables.markdown import block
from faultpath.report.frame import write_pages
from faultpath.trials.provenance import RunProvenance


def tables(record: ScanRecord) -> tuple[Table, ...]:
    """Return the errors alone, those of a source at all of its readers, and the ranking."""
    together = (_together(record),) if record.versions[0].together else ()
    return _alone(record), *together, ranking_table(record.ranking)


def _alone(record: ScanRecord) -> Table:
    """Return success with each error alone, in the first stage and in the second."""
    columns: list[str] = []
    for version in record.versions:
        before = f"{version.variant}: " if len(record.versions) > 1 else ""
        columns += [f"{before}none, %", "alone, %", "second stage, %", "p, Holm"]
    lines: list[Line] = []
    for place, error in enumerate(record.errors):
        entries: list[Entry] = []
        for version in record.versions:
            first = next(f for f in version.first if f.error.text == error.text)
            second = next((s for s in version.singles if s.error == place), None)
            entries += [Entry(text=f"{first.none:.0f}"), Entry(text=f"{first.alone:.0f}")]
            if second is None:
                entries += [Entry(text="not run"), Entry(text="")]
            else:
                detected = second.kind is not None
                p = second.helps_p if second.kind == "helps" else second.corrected_p
                rates = f"{second.alone:.0f}"
                entries += [Entry(text=rates, detected=detected), Entry(text=wording.p_value(p))]
        lines.append(line(named(error), *entries))
    first, second = record.scenes
    return Table(
        name="errors",
        title="Success with each error alone",
        corner="Error",
        columns=tuple(columns),
        lines=tuple(lines),
        notes=(
            f"The first stage has {wording.counted(first, 'scene')}, the second "
            f"{second} others. p: one-sided, that the error costs success; bold below 2.5 %.",
        ),
    )


def _together(record: ScanRecord) -> Table:
    """Return success with a source wrong at all of its readers, as in deployment."""
    lines: list[Line] = []
    for at, together in enumerate(record.versions[0].together):
        errors = [record.errors[place] for place in together.errors]
        sizes = " and ".join(dict.fromkeys(map(size, errors)))
        where = f"all but {together.left_out}" if together.left_out else "all readers"
        entries: list[str] = []
        for version in record.versions:
            alone = {single.error: single.alone for single in version.singles}
            rates = [
                f"{alone[place]:.0f}" if place in alone else "not run" for place in together.errors
            ]
            of = version.together[at]
            entries += [f"{of.none:.0f}", ", ".join(rates), f"{of.success:.0f}"]
        readers = ", ".join(error.reader for error in errors)
        lines.append(line(f"{errors[0].source} {sizes}", f"{where} ({readers})", *entries))
    columns = ["at"]
    for version in record.versions:
        before = f"{version.variant}: " if len(record.versions) > 1 else ""
        columns += [f"{before}none, %", "each alone, %", "together, %"]
    return Table(
        name="together",
        title="Success with one source wrong at several readers",
        corner="Source",
        columns=tuple(columns),
        words=("at",),
        lines=tuple(lines),
        notes=("At all readers is how deployment has an error of the source. No test.",),
    )


def ranking_table(ranking: Ranking) -> Table:
    """Return the sources that may err in order."""
    ranks = [source.rank for source in ranking.sources]
    return Table(
        name="ranking",
        title="Sources that may err, by number of readers, then by probe response",
        corner="Source",
        columns=("read by", "error", "response"),
        words=("read by", "error"),
        lines=tuple(
            line(
                f"{source.rank}{'=' * (ranks.count(source.rank) > 1)} {source.name}",
                ", ".join(source.consumers),
                _sizes(source),
                "unknown" if source.response is None else f"{source.response:.2g}",
            )
            for source in ranking.sources
        ),
        notes=_ranking_notes(ranking),
    )


def _sizes(source: Candidate) -> str:
    sizes = [source.fault or f"none: {source.unsized}"] if source.fault or not source.at else []
    return ", ".join([*sizes, *source.at.values()])


def _ranking_notes(ranking: Ranking) -> tuple[str, ...]:
    order = "Ranks compare point estimates and are not tested; equal sources share one."
    if not ranking.probed:
        return (f"{order} The system shows no commands, so only readers count.",)
    return (
        f"{order} Response: median change of the command when the source errs, as a fraction of "
        f"the command's root mean square, in {wording.counted(ranking.probed, 'scene')}.",
    )


def write_scan(record: ScanRecord, provenance: RunProvenance, folder: Path) -> list[Path]:
    """Write `report.html`, `scan.svg` and `table.md`; return their paths."""
    pages = {
        "report.html": page(record, provenance),
        "table.md": table_markdown(record),
    }
    return write_pages(pages, folder)


def page(record: ScanRecord, provenance: RunProvenance) -> str:
    """Return the scan as one page that opens without a network."""
    return "<html>"


def table_markdown(record: ScanRecord) -> str:
    """Return all tables as Markdown."""
    return "\n\n".join(map(block, tables(record))) + "\n"
