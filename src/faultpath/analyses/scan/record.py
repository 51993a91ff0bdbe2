"""The result of a scan with its words, which are made from its numbers where they are shown."""

from faultpath.analyses.scan.model import ScanResult
from faultpath.report.sentences import scan


class ScanRecord(ScanResult):
    """The result of a scan: what was asked, what came out, and what it means."""

    @property
    def headline(self) -> str:
        """The result in a sentence or two."""
        return scan.headline(self)

    @property
    def sentences(self) -> tuple[str, ...]:
        """All that it says, sentence by sentence."""
        return scan.sentences(self)

    @property
    def commands(self) -> tuple[str, ...]:
        """Commands that audit the listed pairs, as a shell takes them."""
        return scan.commands(self)
