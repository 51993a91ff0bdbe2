"""The record as tables: one list of quantities, with the paths as rows or as columns."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from faultpath.record import wording
from faultpath.record.model import DecisionRecord, Effect
from faultpath.record.plain import not_standing
from faultpath.record.question import Question
from faultpath.record.words import adjusted, only_alone
from faultpath.report.thresholds import by_threshold
from faultpath.tables import MISSING, Entry, Line, Table, line
from faultpath.tables.latex import booktabs
from faultpath.tables.markdown import block


@dataclass(frozen=True)
class _Of:
    """What a quantity is read from: one path of a record."""

    record: DecisionRecord
    effect: Effect

    def rate(self, variant: str) -> Entry:
        """Return the success of a variant over the scenes compared, percent."""
        baseline = variant == self.record.question.baseline
        rate = self.effect.baseline_percent if baseline else self.effect.repair_percent
        return Entry(text=wording.plain(rate))

    def difference(self) -> Entry:
        """Return the difference; bold is decided."""
        return Entry(
            text=wording.signed(self.effect.success.value),
            detected=self.effect.detected,
            aside=wording.reservation(self.effect),
        )

    def decided(self) -> Entry:
        """Return the arm that the family decides for, with what keeps it out of a headline."""
        return decided_for(self.record.question, self.effect)

    def void(self) -> Entry:
        """Return the number of void pairs."""
        count = self.effect.void_pairs
        return Entry(text=str(count), tone="bad" if count else "")

    def power(self) -> Entry:
        """Return the difference that is found with 80 % power."""
        least = self.effect.findable_pp
        return Entry(text=MISSING if least is None else wording.plain(least))

    def power_seen(self) -> Entry:
        """Return it for as much discordance as was seen."""
        least = self.effect.minimum_detectable_pp
        return Entry(text=MISSING if least is None else wording.plain(least))

    def mcnemar(self) -> Entry:
        """Return exact McNemar's p, where another test decides."""
        p = self.effect.mcnemar_p_value
        return Entry(text=MISSING if p is None else wording.p_value(p))

    def break_even(self) -> Entry:
        """Return the fault frequencies at which neither arm is decided to be ahead."""
        found = {b.path: wording.break_even(b.result) for b in self.record.break_even}
        return Entry(text=found.get(self.effect.path, MISSING))


def decided_for(asked: Question, effect: Effect) -> Entry:
    """Return the arm that the family decides for, with what keeps it out of a headline, or the
    p-value that keeps it from being decided where the interval alone leaves out 0."""
    if not effect.acted:
        return Entry(text="not tested")
    arm = {1: asked.repair, -1: asked.baseline}.get(effect.sign, MISSING)
    p = adjusted(asked, effect) if only_alone(effect) else ""
    return Entry(text=arm, aside=", ".join(filter(None, (effect.extreme, p))))


DIFFERENCE = ("difference", "interval", "won")
_ARMS = ("baseline", "repair")
BEHIND = ("holm", "power", "scenes", "void", "break-even")
"""Beside a forest plot, which has the rest."""
SHOWN = (*_ARMS, *DIFFERENCE, *BEHIND)
ALL = (
    *(*_ARMS, *DIFFERENCE, "p", "mcnemar", "holm", "decided"),
    *("power", "power-seen", "scenes", "void", "break-even"),
)
_QUANTITIES: Mapping[str, tuple[str, Callable[[_Of], Entry | str]]] = {
    "baseline": ("", lambda of: of.rate(of.record.question.baseline)),
    "repair": ("", lambda of: of.rate(of.record.question.repair)),
    "difference": ("Difference, pp", _Of.difference),
    "interval": ("", lambda of: wording.interval(of.effect.success) or MISSING),
    "won": ("Won:lost", lambda of: wording.wins_losses(of.effect.wins, of.effect.losses)),
    "p": ("p, alone", lambda of: wording.p_value(of.effect.p_value)),
    "holm": ("", lambda of: wording.adjusted(of.effect)),
    "decided": ("Decided for", _Of.decided),
    "power": ("80 % power, pp", _Of.power),
    "power-seen": ("the same at the discordance seen, pp", _Of.power_seen),
    "mcnemar": ("p, exact McNemar", _Of.mcnemar),
    "scenes": ("Scenes", lambda of: str(of.effect.scenes)),
    "void": ("Void pairs", _Of.void),
    "break-even": ("Break-even, %", _Of.break_even),
}
"""Label and entry of all that a record says of a path; labels left empty are the record's own."""


def by_path(record: DecisionRecord, names: Sequence[str], title: str = "") -> Table:
    """Return a table with a row for each path and a column for each of the quantities `names`."""
    lines = [
        line(
            _title(record, effect),
            *(_QUANTITIES[name][1](_Of(record, effect)) for name in _named(record, names)),
            aside="primary" if effect.path == record.question.primary else "",
        )
        for effect in record.effects
    ]
    columns = tuple(
        _label(record, name) + (", %" if name in _ARMS else "") for name in _named(record, names)
    )
    return Table(title=title, corner="Path", columns=columns, lines=tuple(lines))


def by_quantity(
    record: DecisionRecord, names: Sequence[str], title: str = "", notes: Sequence[str] = ()
) -> Table:
    """Return a table with a column for each path and a row for each of the quantities `names`."""
    lines = [
        line(
            _label(record, name),
            *(_QUANTITIES[name][1](_Of(record, effect)) for effect in record.effects),
            aside=name if name in _ARMS else "",
        )
        for name in _named(record, names)
    ]
    return Table(
        name="faultpath",
        title=title,
        corner="Success, %",
        columns=tuple(_title(record, effect) for effect in record.effects),
        lines=tuple(lines),
        notes=tuple(notes),
    )


def whole_table(record: DecisionRecord) -> Table:
    """Return every quantity of every path, with the question as title: the table of a paper."""
    asked = record.question
    title = (
        f"{asked.repair} against {asked.baseline} on {asked.system}, fault {asked.fault}: "
        f"{record.flown} scenes of {asked.library}, {wording.seeds(asked.seeds)}"
    )
    notes = (
        f"Difference: success of {asked.repair} minus success of {asked.baseline}. Won:lost: "
        f"scenes in which only {asked.repair} or only {asked.baseline} succeeds. Void pairs count "
        "for neither side. Break-even: the fault frequencies at which neither is decided to be "
        "ahead, with the estimate in front; any: none is decided from which on one of them is.",
        f"Primary contrast: {asked.primary}. {_ruled(record)}{_corrected(record)} Intervals and "
        f"tests speak of {record.estimand}.",
        *not_standing(record),
        record.verdict.headline,
    )
    table = by_quantity(record, ALL, title, notes)
    return table.model_copy(update={"lines": (*table.lines, *_secondary(record))})


def _ruled(record: DecisionRecord) -> str:
    rule = record.question.ruled
    return f"Rule: {rule}. " if rule else ""


def _corrected(record: DecisionRecord) -> str:
    if record.stopped is None:
        return f"Holm's correction is for {record.hypotheses} contrasts."
    others = "" if record.hypotheses == 1 else ", half of it for the primary one"
    return (
        f"The audit was sequential: intervals and p-values hold at whatever scene it stopped. "
        f"{wording.counted(record.hypotheses, 'contrast')} share the error rate{others}."
    )


def markdown_table(record: DecisionRecord) -> str:
    """Return the whole table as Markdown, with the question above it and the verdict below."""
    tables = (whole_table(record), by_threshold(record))
    return "\n\n".join(map(block, filter(None, tables)))


def latex_table(record: DecisionRecord) -> str:
    """Return a `table` environment that needs the package booktabs and nothing else."""
    return "% Needs \\usepackage{booktabs}\n" + booktabs(whole_table(record))


def _named(record: DecisionRecord, names: Sequence[str]) -> list[str]:
    beside = any(effect.mcnemar_p_value is not None for effect in record.effects)
    shown = {"power": record.stopped is None, "mcnemar": beside}
    shown["power-seen"] = any(effect.planning_detectable_pp for effect in record.effects)
    return [name for name in names if shown.get(name, True)]


def _label(record: DecisionRecord, name: str) -> str:
    asked = record.question
    levels = {f"{100 * effect.success.level:g} % interval" for effect in record.effects}
    interval = levels.pop() if len(levels) == 1 else "Interval"
    said = {
        "baseline": asked.baseline,
        "repair": asked.repair,
        "interval": interval,
        "holm": "p, Holm" if record.stopped is None else "p, family",
    }
    return said.get(name, _QUANTITIES[name][0])


def _title(record: DecisionRecord, effect: Effect) -> str:
    return next((path.title for path in record.paths if path.name == effect.path), effect.path)


def _secondary(record: DecisionRecord) -> list[Line]:
    asked, lines = record.question, list[Line]()
    shown = {"time on joint successes (s)": [effect.time_s for effect in record.effects]}
    for name, metric in asked.metrics.items():
        label = f"{metric.said(name)} ({metric.unit})"
        shown[label] = [effect.metrics.get(name) for effect in record.effects]
    for label, estimates in shown.items():
        if any(estimates):
            title = f"Secondary, nothing is decided: {asked.repair} minus {asked.baseline}, {label}"
            values = ("" if e is None else wording.signed(e.value, 2) for e in estimates)
            ranges = ("" if e is None else wording.interval(e, 2) for e in estimates)
            lines += [
                line(title),
                line("Difference", *(value or MISSING for value in values)),
                line(_label(record, "interval"), *(ends or MISSING for ends in ranges)),
            ]
    return lines
