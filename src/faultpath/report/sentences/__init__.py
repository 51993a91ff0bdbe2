"""From a result to its words, which are made where it is shown and never stored."""

from dataclasses import dataclass

from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.model import ScanResult
from faultpath.report.sentences import answers, findings, maps, scan
from faultpath.report.sentences.headline import headline


@dataclass(frozen=True)
class Words:
    """A result in words; `None` for what its kind of result does not say."""

    headline: str
    """The result in a sentence or two."""
    sentences: tuple[str, ...]
    """All that it says, a sentence or two each."""
    findings: tuple[str, ...]
    """Remarks on its trials that a reader has to know."""
    would_change: tuple[str, ...] | None = None
    """Changes that could change the result."""
    commands: tuple[str, ...] | None = None
    """Commands that audit the listed pairs of errors, as a shell takes them."""


def words(result: AuditResult | MapResult | ScanResult) -> Words:
    """Return what is said of a result."""
    match result:
        case AuditResult():
            return Words(
                headline(result),
                answers.sentences(result),
                findings.of_audit(result),
                would_change=tuple(answers.would_change(result)),
            )
        case MapResult():
            return Words(
                maps.headline(result),
                maps.sentences(result),
                tuple(map(findings.describe, result.findings)),
            )
        case ScanResult():
            return Words(
                scan.headline(result),
                scan.sentences(result),
                tuple(map(findings.describe, result.findings)),
                commands=scan.commands(result),
            )
