"""A check, a trace and an interface, as a console and JSON show them."""

from typing import Any, Literal

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from faultpath.core.results import Result
from faultpath.core.text import counted
from faultpath.interface import Gap, Interface, rank, transitive_readers
from faultpath.report.sentences import checks as words
from faultpath.report.tables import Line, Table, line
from faultpath.report.terminal import STYLES, drawn
from faultpath.run.check.check import SystemCheck
from faultpath.run.check.results import Checked
from faultpath.run.check.tracing import Trace, TracedRead, TraceFinding

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


def interface_table(interface: Interface) -> RenderableType:
    """Return the channels of an interface, most readers first: who feeds each, who reads it and
    who is reached through a reconstruction; and what is reconstructed."""
    lines: list[Line] = []
    for channel in rank(interface):
        sources = (f"{name} {interface.source(name).provenance.value}" for name in channel.sources)
        reached = set(transitive_readers(interface, channel.name)) - set(channel.readers)
        readers = (*channel.readers, *(f"reaches {name}" for name in sorted(reached)))
        gap = "" if channel.gap is Gap.NONE else f"{channel.gap.value} gap"
        entries = ("\n".join(sources), "\n".join(readers))
        lines.append(line(channel.name, *entries, aside=gap))
    columns = ("fed by", "read by")
    table = Table(
        title=f"Information interface of {interface.name}",
        corner="channel",
        columns=columns,
        words=columns,
        lines=tuple(lines),
    )
    reconstructions = [
        Text(f"{module} reconstructs {name}.") for module, name in interface.reconstructions
    ]
    return Group(drawn(table), *reconstructions)


def trace_table(trace: Trace[Any]) -> Table:
    """Return a line for each reader of a channel, in the order in which they read."""
    taps: dict[tuple[str, str], list[TracedRead]] = {}
    for read in trace.reads:
        taps.setdefault((read.reader, read.channel), []).append(read)
    columns = ["channel", "source", "at steps", "of steps", "made by"]
    lines: list[Line] = []
    for (reader, channel), reads in taps.items():
        source = reads[0].source
        steps = (" ".join(str(r.step) for r in reads), " ".join(str(r.valid_step) for r in reads))
        entries = [channel, source, *steps, trace.reconstructed.get(source, ("",))[0]]
        if trace.fault:
            by = (name for read in reads for name in read.altered_by)
            entries.insert(1, ", ".join(dict.fromkeys(by)))
        lines.append(line(reader, *entries))
    if trace.fault:
        columns.insert(1, "altered by")
    return Table(
        title=f"{trace.variant} of {trace.system}, {trace.steps} steps in {trace.scene}",
        corner="who",
        columns=tuple(columns),
        words=tuple(columns),
        lines=tuple(lines),
        notes=(
            "At steps: those of the reading. Of steps: those at which the source got the value "
            "that was read; -1 is before the first.",
            *(
                f"{source} is reconstructed by {module} from {', '.join(channels) or 'nothing'}."
                for source, (module, channels) in trace.reconstructed.items()
            ),
        ),
    )
