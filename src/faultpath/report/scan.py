"""A scan as tables, pictures, terminal and page; all numbers are the result's."""

from math import inf
from pathlib import Path

from faultpath.analyses.scan.model import ScanError, ScannedVersion, ScanResult, SecondStage
from faultpath.analyses.scan.sources import Candidate, Ranking
from faultpath.core.text import counted
from faultpath.report.frame import render, write_pages
from faultpath.report.scan_pictures import letters, strip, triangle
from faultpath.report.sentences import wording, words
from faultpath.report.sentences.scan import named, of_pair, size
from faultpath.report.tables import Entry, Line, Table, html, line, markdown_blocks
from faultpath.run.provenance import RunProvenance

_MOST_PAIRS = 10
"""As many pairs have room in a terminal."""


def tables(result: ScanResult, most_pairs: float = _MOST_PAIRS) -> tuple[Table, ...]:
    """Return the errors alone, their pairs where these are not too many, those of a source at
    several readers, and the ranking."""
    version = result.versions[0]
    pairs = _pairs(result) if 0 < len(version.pairs) <= most_pairs else None
    together = _together(result) if version.together else None
    return tuple(filter(None, (_alone(result), pairs, together, ranking_table(result.ranking))))


def _pairs(result: ScanResult) -> Table:
    """Return success with each pair of errors that ran, beside each of them alone."""
    lines: list[Line] = []
    for at, pair in enumerate(result.versions[0].pairs):
        entries: list[Entry] = []
        for version in result.versions:
            one = version.pairs[at]
            p = one.covers_p if one.corrected_p is None else one.corrected_p
            rates = (one.none, one.first, one.second, one.both)
            entries += [Entry(text=_percent(rate)) for rate in rates]
            shown = "not tested" if p is None else wording.p_value(p)
            listed = one.kind is not None
            entries.append(Entry(text=shown, detected=listed, aside="listed" * listed))
        lines.append(line(" and ".join(named(result.errors[e]) for e in pair.errors), *entries))
    return Table(
        name="every-pair",
        title="Success with pairs of errors, %",
        corner="Errors",
        columns=_of_versions(result, "neither", "first", "second", "both", "p, Holm"),
        lines=tuple(lines),
        notes=(
            "p: one-sided, that both together succeed more often than the worse one alone; tested "
            "where each of them costs success, or in one source.",
        ),
    )


def _alone(result: ScanResult) -> Table:
    """Return success with each error alone, in the first stage and in the second."""
    versions = result.versions
    none = [
        entry
        for version in versions
        for entry in (_percent(version.first[0].none), _percent(_none(version)), "")
    ]
    lines = [line("no error", *none)]
    places = {error.text: place for place, error in enumerate(result.errors)}
    tried = sorted((first.error for first in versions[0].first), key=_in_order)
    for error in tried:
        entries: list[Entry] = []
        for version in versions:
            first = next(f for f in version.first if f.error.text == error.text)
            second = next((s for s in version.singles if s.error == places.get(error.text)), None)
            alone = _percent(first.alone) if first.acted else "never acted"
            entries += [Entry(text=alone), *_second(second)]
        lines.append(line(named(error), *entries))
    return Table(
        name="errors",
        title="Success with each error alone, %",
        corner="Error",
        columns=_of_versions(result, "first stage", "second stage", "p, Holm"),
        lines=tuple(lines),
        notes=(
            f"The first stage has {counted(result.scenes[0], 'scene')}, the second "
            f"{result.scenes[1]} others. p: one-sided, that the error costs success or, where it "
            "is said to raise it, that it does (below 0.025).",
        ),
    )


def _in_order(error: ScanError) -> tuple[str, str, int, int]:
    return error.source, error.reader, error.sign, error.halvings


def _second(single: SecondStage | None) -> tuple[Entry, Entry]:
    if single is None:
        return Entry(text="not run"), Entry(text="")
    p = single.helps_p if single.kind == "helps" else single.corrected_p
    effect = {"hurts": "costs", "helps": "raises"}.get(single.kind or "", "")
    text = Entry(text=_percent(single.alone), detected=bool(effect), aside=effect)
    return text, Entry(text=wording.p_value(p))


def _none(version: ScannedVersion) -> float | None:
    rates = [part.none for part in (*version.singles, *version.together)]
    return rates[0] if rates else None


def _percent(rate: float | None) -> str:
    return "not run" if rate is None else f"{rate:.0f}"


def _of_versions(result: ScanResult, *columns: str) -> tuple[str, ...]:
    """Return columns for each version, under its name where there are two."""
    if len(result.versions) == 1:
        return columns
    return tuple(f"{of.variant}: {column}" for of in result.versions for column in columns)


def _together(result: ScanResult) -> Table:
    """Return success with a source wrong at several readers at once."""
    lines: list[Line] = []
    for at, together in enumerate(result.versions[0].together):
        errors = [result.errors[place] for place in together.errors]
        sizes = " and ".join(dict.fromkeys(map(size, errors)))
        where = f"all but {together.left_out}" if together.left_out else "all"
        rates = [
            _percent(rate)
            for version in result.versions
            for rate in (version.together[at].none, version.together[at].success)
        ]
        lines.append(line(f"{wording.in_words(errors[0].source)} {sizes}", where, *rates))
    return Table(
        name="together",
        title="Success with one source wrong at several readers, %",
        corner="Source",
        columns=("readers", *_of_versions(result, "no error", "wrong there")),
        words=("readers",),
        lines=tuple(lines),
        notes=("All readers is how deployment has an error of the source. Not tested.",),
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
                ", ".join(source.readers),
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
        f"the command's root mean square, in {counted(ranking.probed, 'scene')}.",
    )


def write_scan(result: ScanResult, provenance: RunProvenance, folder: Path) -> list[Path]:
    """Write `report.html`, `scan.svg`, `scan-2.svg` of a repair, and `table.md`; return their
    paths."""
    pages = {"report.html": page(result, provenance)}
    for number, version in enumerate(result.versions, 1):
        if version.singles:
            name = "scan.svg" if number == 1 else f"scan-{number}.svg"
            pages[name] = triangle(result, version).render(standalone=True) + "\n"
    pages["table.md"] = markdown_blocks(tables(result, inf)) + "\n"
    return write_pages(pages, folder)


def page(result: ScanResult, provenance: RunProvenance) -> str:
    """Return the scan as one page that opens without a network."""
    letter = [letters(version) for version in result.versions]
    versions = [
        {
            "name": version.variant,
            "triangle": triangle(result, version).render() if version.singles else "",
            "strips": [
                {
                    "letters": " and ".join(names[place] for place in pair.errors),
                    "words": of_pair(result, pair),
                    "picture": strip(result, version, pair).render(),
                }
                for pair in version.listed
            ],
        }
        for version, names in zip(result.versions, letter, strict=True)
    ]
    return render(
        "scan.html.j2",
        result=result,
        words=words(result),
        question=result.question,
        facts=result.facts,
        provenance=provenance,
        n_trials=result.trials,
        versions=versions,
        tables=[(table, html(table, caption=False)) for table in tables(result, inf)],
    )
