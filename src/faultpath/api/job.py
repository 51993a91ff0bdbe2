"""One job, as audit, map and reproduction do it: trials run, failures displayed, files sealed."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from faultpath.api.display import Display, Show
from faultpath.decisions import RunProvenance
from faultpath.trials import Study, System
from faultpath.trials.execution import Failure, RunResult, Stopwatch, run_provenance, run_study
from faultpath.trials.work import Executor

_SHOWN = 5
"""Different errors that are displayed."""


@dataclass(frozen=True)
class Job:
    """Where and on what the trials of one call run, how long, and who is shown how far it is."""

    folder: Path
    executor: Executor
    display: Display
    time_limit_s: float | None = None
    stopwatch: Stopwatch = field(default_factory=Stopwatch)

    def run(
        self,
        study: Study,
        system: System,
        show: Show,
        folder: Path | None = None,
        notice: Callable[[str], None] | None = None,
        **how: Any,
    ) -> RunResult:
        """Run a study, into the job's folder unless another is given; see `run_study` for `how`.

        Raises `Stopped` on Ctrl-C, and `UserError` where the study cannot be run.
        """
        return run_study(
            study,
            folder or self.folder,
            progress=show,
            notice=notice or self.display.say,
            system=system,
            executor=self.executor,
            time_limit_s=self.time_limit_s,
            **how,
        )

    def finish(
        self, result: RunResult, system: System, names: Iterable[str], folder: Path | None = None
    ) -> RunProvenance:
        """Display failures and write the provenance, with digests of the files that `names` are.

        A command shows findings with what was decided; a call from Python is shown them here.
        """
        if result.failures:
            self._show_failures(result)
        if not self.display.is_command:
            for finding in result.findings:
                self.display.say(finding)
        return run_provenance(
            folder or self.folder,
            names,
            result,
            self.stopwatch,
            self.display.command,
            self.executor,
            system.backend,
        )

    def _show_failures(self, result: RunResult) -> None:
        say = self.display.say
        say(f"{len(result.failures)} trials failed and void their pairs.", "bold red")
        alike: dict[str, list[Failure]] = {}
        for failure in result.failures:
            alike.setdefault(failure.error, []).append(failure)
        for error, (first, *more) in list(alike.items())[:_SHOWN]:
            rest = f" and {len(more)} more trials" if more else ""
            details = f" ({first.details})" if first.details else ""
            say(f"  {first.scene}{rest}: {' '.join(error.split())}{details}")
        if len(alike) > _SHOWN:
            say(f"  and {len(alike) - _SHOWN} other errors, in {self.folder / 'failures'}")
