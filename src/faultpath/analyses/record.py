"""The result of an audit with its words, which are made from its numbers where they are shown."""

from faultpath.analyses.model import AuditResult
from faultpath.report.sentences import answers
from faultpath.report.sentences.headline import headline


class DecisionRecord(AuditResult):
    """The result of an audit: what was asked, what came out, and what it means."""

    @property
    def headline(self) -> str:
        """The result in one sentence."""
        return headline(self)

    @property
    def sentences(self) -> tuple[str, ...]:
        """All that it says: changes, what follows, how sure it is and what stays open."""
        return answers.sentences(self)

    @property
    def would_change(self) -> tuple[str, ...]:
        """Changes that could change the result, a sentence each."""
        return tuple(answers.would_change(self))
