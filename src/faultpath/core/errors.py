"""Errors that a user can act on."""


class UserError(Exception):
    """A user's mistake: one sentence says what is wrong, where, and what to do.

    The command line prints the sentence without a traceback and exits with status 2; a notebook
    shows it alone as well.
    """

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


class Stopped(UserError):
    """Ctrl-C ended the command; the sentence says what is kept and how to resume."""


class Notice(UserWarning):
    """A sentence about a run that its user should read; workers pass it to their parent."""


class SystemMistake(UserError):
    """A mistake in the code of a user's system."""

    location: str = ""
    """File and line of that code, once `faultpath.core.error_source` has found them."""

    def __str__(self) -> str:
        sentence = super().__str__()
        return f"{self.location}: {sentence}" if self.location else sentence
