"""Errors that a user can act on."""


class UserError(Exception):
    """A mistake in what was asked: one sentence says what is wrong, where, and what to do.

    The command line prints the sentence without a traceback and exits with status 2; a notebook
    shows it alone as well.
    """

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


class Stopped(UserError):
    """Ctrl-C ended the command; the sentence says what is kept and how to go on."""


class Notice(UserWarning):
    """A sentence that a user should know of a run; workers hand it to their parent."""


class SystemMistake(UserError):
    """A mistake in the code of a user's system."""

    place: str = ""
    """File and line of that code, once they are known; `faultpath.core.error_source` finds them."""

    def __str__(self) -> str:
        sentence = super().__str__()
        return f"{self.place}: {sentence}" if self.place else sentence
