"""Results of a command for a build: its exit status, JUnit's XML and a summary."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from faultpath.cli.options import FOUND
from faultpath.cli.options import path as as_path
from faultpath.core.errors import UserError
from faultpath.core.text import unknown
from faultpath.run.question import ADVANCED

if TYPE_CHECKING:
    from faultpath.api.runs import Run

_ASKS = ("reversal", "repair-behind", "undecided", "void")  # those of `faultpath.report.gate`

FailIf = Annotated[
    list[str] | None,
    typer.Option(
        "--fail-if",
        metavar=f"<{'|'.join(_ASKS)}>",
        help="Exit with 1 where this is found; repeat the option for more. `undecided` is about "
        "the primary contrast.",
        rich_help_panel=ADVANCED,
    ),
]
Junit = Annotated[
    Path | None,
    typer.Option(
        "--junit", parser=as_path, help="Write JUnit's XML here.", rich_help_panel=ADVANCED
    ),
]
Summary = Annotated[
    Path | None,
    typer.Option(
        "--summary",
        parser=as_path,
        help="Add a summary in Markdown to this .md file, a new file, or CI's step summary.",
        rich_help_panel=ADVANCED,
    ),
]


@dataclass(frozen=True)
class Gate:
    """Options for a build, checked before any trial runs."""

    conditions: tuple[str, ...]
    junit: Path | None
    summary: Path | None

    @classmethod
    def of(cls, fail_if: Sequence[str] | None, junit: Path | None, summary: Path | None) -> "Gate":
        """Read the options; `UserError` for what cannot be asked, or written."""
        from faultpath.core.files.atomic import check_output

        conditions = tuple(dict.fromkeys(fail_if or ()))
        for condition in conditions:
            if condition not in _ASKS:
                raise UserError(f"--fail-if {condition}: {unknown('name', condition, _ASKS)}.")
        if junit and summary and os.path.realpath(junit) == os.path.realpath(summary):
            raise UserError(f"--junit and --summary both name {junit}: give two files.")
        if junit is not None:
            check_output(junit, b'<testsuites name="faultpath"')
        if summary is not None:
            place, of_ci = os.path.realpath(summary), os.environ.get("GITHUB_STEP_SUMMARY")
            added_to = place.endswith(".md") or (of_ci and os.path.realpath(of_ci) == place)
            check_output(summary, b"" if added_to else None)
        return cls(conditions, junit, summary)

    def end(self, runs: "Sequence[Run]", say: Callable[..., Any]) -> int:
        """Write what was asked for, say what a build fails for, and return the exit status."""
        from faultpath.core.files.atomic import write_file, write_text
        from faultpath.core.files.opening import contents
        from faultpath.report.gate import found, junit, summary

        records = [run.record for run in runs]
        if self.junit is not None:
            write_text(self.junit, junit(records, self.conditions))
        if self.summary is not None:
            # A build's summary holds that of its other steps too.
            before = contents(self.summary) if self.summary.exists() else b""
            write_file(self.summary, before + summary(records, self.conditions).encode())
        status = FOUND if any(run.broken for run in runs) else 0
        for record in records:
            for name in self.conditions:
                if answer := found(record, name):
                    say(f"--fail-if {name}: {answer.reason}", markup=False, style="bold red")
                    status = FOUND
        return status
