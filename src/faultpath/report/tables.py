"""The record as tables for a paper (LaTeX with booktabs) and for a page of text (Markdown).

Both have the paper's Table IV as their model: methods and effects as rows, paths as columns.
"""

from collections.abc import Callable
from dataclasses import dataclass

from faultpath.record.model import DecisionRecord, Effect
from faultpath.report import wording
from faultpath.report.escapes import latex as tex
from faultpath.report.escapes import markdown as md
from faultpath.statistics import Estimate


@dataclass(frozen=True)
class Line:
    """One row of a table, in the reader's own characters; `None` in `values` opens a section."""

    label: str
    values: tuple[str, ...] | None


_OTHERS: tuple[tuple[str, Callable[[Effect], Estimate | None]], ...] = (
    ("time on joint successes (s)", lambda effect: effect.time_s),
    ("terminal distance (m)", lambda effect: effect.terminal_distance_m),
    ("least clearance (m)", lambda effect: effect.min_clearance_m),
)


def table_lines(record: DecisionRecord) -> tuple[tuple[str, ...], tuple[Line, ...]]:
    """Return the column heads (paths) and the rows that both formats write out."""
    asked = record.question
    titles = {path.name: path.title for path in record.paths}
    effects = {effect.path: effect for effect in record.effects}
    rates = {(c.variant, c.path): wording.plain(c.success_percent) for c in record.cells}
    breaks = {b.path: wording.break_even(b.result) for b in record.break_even}
    names = [path.name for path in record.paths if path.name in effects]

    def row(label: str, text: Callable[[Effect], str]) -> Line:
        return Line(label, tuple(text(effects[name]) for name in names))

    lines = [
        Line(variant, tuple(rates[variant, name] for name in names))
        for variant in (asked.baseline, asked.repair)
    ]
    lines += [
        Line(f"{asked.repair} minus {asked.baseline}, success (pp)", None),
        row("Difference", lambda e: wording.signed(e.success.value)),
        row(_interval_label(record), lambda e: wording.interval(e.success) or "–"),
        row("Wins:losses", lambda e: wording.wins_losses(e.wins, e.losses)),
        row("p of this contrast alone", lambda e: wording.p_value(e.p_value)),
        row(f"p after Holm, {record.hypotheses} contrasts", wording.adjusted),
        row("Decided for", lambda e: decided(record, e)),
        row("Found with 80% power (pp)", lambda e: _or_dash(e.minimum_detectable_pp)),
        row("Scenes (void pairs)", lambda e: f"{e.scenes} ({e.void_pairs})"),
        Line("Fault frequencies at which neither is decided to be ahead (%)", None),
        Line("p* and the set", tuple(breaks.get(name, "–") for name in names)),
    ]
    for label, pick in _OTHERS:
        estimates = [pick(effects[name]) for name in names]
        if not any(estimates):
            continue
        title = f"Secondary, nothing is decided: {asked.repair} minus {asked.baseline}, {label}"
        lines.append(Line(title, None))
        lines.append(Line("Difference", tuple(map(_value, estimates))))
        lines.append(Line(_interval_label(record), tuple(map(_range, estimates))))
    return tuple(titles[name] for name in names), tuple(lines)


def decided(record: DecisionRecord, effect: Effect) -> str:
    """Return the arm that the family decides for, with what keeps it out of a headline."""
    if not effect.acted:
        return "not tested"
    arm = {1: record.question.repair, -1: record.question.baseline}.get(effect.sign, "–")
    return f"{arm} ({effect.extreme})" if effect.extreme else arm


def markdown_table(record: DecisionRecord) -> str:
    """Return the table as Markdown, with the question above it and the verdict below."""
    heads, lines = table_lines(record)
    asked = record.question
    rows = [
        f"| Success/100 | {' | '.join(map(md, heads))} |",
        f"| :-- | {' | '.join('--:' for _ in heads)} |",
    ]
    for line in lines:
        cells = line.values if line.values is not None else ("",) * len(heads)
        label = md(line.label) if line.values is not None else f"*{md(line.label)}*"
        rows.append(f"| {label} | {' | '.join(map(md, cells))} |")
    about = (
        f"{md(asked.repair)} against {md(asked.baseline)} on {md(asked.system)}, "
        f"fault {md(asked.fault)}; {asked.n_scenes} scenes of {md(asked.library)}, "
        f"{wording.seeds(asked.seeds)}. Primary contrast: {md(asked.primary)}. Intervals and tests "
        f"speak of {record.estimand}."
    )
    return "\n".join([about, "", *rows, "", md(record.verdict.headline), ""])


def latex_table(record: DecisionRecord) -> str:
    """Return a `table` environment that needs the package booktabs and nothing else."""
    heads, lines = table_lines(record)
    asked = record.question
    columns = len(heads)
    body: list[str] = []
    for line in lines:
        if line.values is None:
            body += [
                r"\addlinespace",
                rf"\multicolumn{{{columns + 1}}}{{@{{}}l}}{{\emph{{{tex(line.label)}:}}}} \\",
            ]
        else:
            body.append(
                f"{_tex_value(line.label)} & {' & '.join(map(_tex_value, line.values))} \\\\"
            )
    caption = (
        f"{tex(asked.repair)} against {tex(asked.baseline)} on {tex(asked.system)}, fault "
        f"{tex(asked.fault)}: success/100 over {asked.n_scenes} scenes of {tex(asked.library)}, "
        f"{wording.seeds(asked.seeds)}. Wins:losses are {tex(asked.repair)}-only:"
        f"{tex(asked.baseline)}-only successes. Void pairs count for neither side. Primary "
        f"contrast: {tex(asked.primary)}. Intervals and tests speak of {tex(record.estimand)}."
    )
    head = " & ".join(["Method", *map(tex, heads)])
    return "\n".join(
        [
            "% Needs \\usepackage{booktabs}",
            r"\begin{table}[t]",
            rf"\caption{{{caption}}}",
            r"\label{tab:faultpath}",
            r"\centering\footnotesize",
            r"\setlength{\tabcolsep}{3pt}",
            rf"\begin{{tabular}}{{@{{}}l{'c' * columns}@{{}}}}",
            r"\toprule",
            rf"{head} \\",
            r"\midrule",
            *body,
            r"\bottomrule",
            r"\end{tabular}",
            r"\end{table}",
            "",
        ]
    )


def _interval_label(record: DecisionRecord) -> str:
    levels = {f"{100 * effect.success.level:g}" for effect in record.effects}
    return f"{levels.pop()}% interval" if len(levels) == 1 else "Interval"


def _or_dash(value: float | None) -> str:
    return "–" if value is None else wording.plain(value)


def _value(estimate: Estimate | None) -> str:
    return "–" if estimate is None else wording.signed(estimate.value, 2)


def _range(estimate: Estimate | None) -> str:
    return (wording.interval(estimate, 2) if estimate is not None else "") or "–"


def _tex_value(text: str) -> str:
    # Braces keep a leading bracket or star from being read as an argument of the row end before it.
    escaped = tex(text)
    return "{" + escaped + "}" if escaped.startswith(("[", "*")) else escaped
