"""The result of a map with its words, which are made from its numbers where they are shown."""

from faultpath.analyses.map.model import MapResult
from faultpath.report.sentences import maps


class MapRecord(MapResult):
    """The result of a map: what was asked, what came out, and what it means."""

    @property
    def headline(self) -> str:
        """The result in one sentence."""
        return maps.headline(self)

    @property
    def sentences(self) -> tuple[str, ...]:
        """All that it says, sentence by sentence."""
        return maps.sentences(self)
