"""A check and a trace in words, as a console and JSON show them."""

from typing import Any, Literal

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.core.results import Result
from faultpath.core.text import counted
from faultpath.report.sentences import checks as words
from faultpath.report.terminal import STYLES
from faultpath.run.check.check import SystemCheck
from faultpath.run.check.results import Checked
from faultpath.run.check.tracing import Trace, TraceFinding

_STYLES = {"passed": STYLES["good"], "failed": STYLES["bad"], "not judged": STYLES["faint"]}


class Check(Result):
    """One thing that was looked at."""

    name: str
    summary: str
    """One line on what was seen, or on why nothing could be."""
    failures: tuple[str, ...] = ()
    """A sentence each: what is wrong, where, and what to do."""
    remarks: tuple[str, ...] = ()
    """Sentences on what may be a mistake and may be none."""
    judged: bool = True

    @property
    def status(self) -> Literal["passed", "failed", "not judged"]:
        """Result of the check in a word."""
        if self.failures:
            return "failed"
        return "passed" if self.judged else "not judged"


class Report(SystemCheck[Check]):
    """A check of a system; what `faultpath check --json` prints."""

    @property
    def failures(self) -> tuple[str, ...]:
        """The sentences of all checks that failed."""
        return tuple(sentence for check in self.checks for sentence in check.failures)


class TraceReport(Trace[str]):
    """A trace of a variant; what `faultpath trace --json` prints."""


def report_of(result: SystemCheck[Checked]) -> Report:
    """Return a check in words."""
    checks = tuple(
        Check(
            name=check.name,
            summary=words.summary(check),
            failures=tuple(map(words.describe, check.failures)),
            remarks=tuple(map(words.describe, check.remarks)),
            judged=not check.unjudged,
        )
        for check in result.checks
    )
    fields: dict[str, Any] = {**dict(result), "checks": checks}
    return Report(**fields)


def trace_report_of(trace: Trace[TraceFinding]) -> TraceReport:
    """Return a trace in words."""
    fields: dict[str, Any] = dict(trace)
    for name in ("privileged", "findings"):
        fields[name] = tuple(map(words.describe_read, fields[name]))
    return TraceReport(**fields)


def check_lines(report: Report) -> RenderableType:
    """Return a line for each check, with its failures and remarks below, and how many failed."""
    scenes = f"{len(report.scenes)} of {counted(report.of, 'scene')} of {report.library}"
    fault = f", and with {report.fault}" if report.fault else ""
    about = f"{', '.join(report.variants)} in {scenes}, seed {report.seed}{fault}"
    lines: list[RenderableType] = [Text(f"{report.system}: {about}", "bold")]
    unjudged: dict[str, list[str]] = {}
    for check in report.checks:
        if check.status == "not judged" and not check.remarks:
            unjudged.setdefault(check.summary, []).append(check.name)
            continue
        lines.append(_line(check.status, f"{check.name}: {check.summary}"))
        texts = (*check.failures, *(f"Remark: {remark}" for remark in check.remarks))
        lines += (Padding(Text(f"- {text}"), (0, 0, 0, 2)) for text in texts)
    lines += [
        _line("not judged", f"{', '.join(names)}: {summary}") for summary, names in unjudged.items()
    ]
    failed = sum(check.status == "failed" for check in report.checks)
    remarks = sum(len(check.remarks) for check in report.checks)
    text = f"{counted(failed, 'check')} failed" if failed else "No check failed"
    text += f"; {counted(remarks, 'remark')}." if remarks else "."
    return Group(*lines, Text(text, STYLES["bad" if failed else "good"]))


def _line(status: str, text: str) -> Text:
    return Text.assemble(Text(status, _STYLES[status]), f"  {text}")
