"""Errors that a user can act on."""


class UserError(Exception):
    """A mistake in what was asked: one sentence says what is wrong, where, and what to do.

    The command line prints the sentence without a traceback and exits with status 2.
    """
