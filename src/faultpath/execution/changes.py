"""What is said when code or data are not those that a run began with."""

from collections.abc import Sequence
from datetime import datetime

from faultpath.code import CodeState, Watch, named
from faultpath.errors import UserError
from faultpath.execution.attempt import Reply, Wrong
from faultpath.execution.ledger import Progress


def check_same(before: CodeState, now: CodeState) -> None:
    """Raise `UserError` where a file has other contents now; files in one of them alone may be."""
    changed = tuple(
        name
        for mine, theirs in ((before.files, now.files), (before.data, now.data))
        for name, digest in mine.items()
        if theirs.get(name, digest) != digest
    )
    if changed:
        raise UserError(under_way(changed))


def watched(unread: Watch, reply: Reply) -> Reply:
    """Return a reply, or what is wrong with it: a file changed before it was read."""
    changed = unread.changed()
    return Wrong(UserError(under_way(changed))) if changed else reply


def under_way(names: Sequence[str]) -> str:
    """Say that files changed under a run, and what becomes of it."""
    return (
        f"{named(names)} changed while the run was under way: trials of the code before are kept "
        "as such and not mixed with others; run the command again to run the code as it is now"
    )


def kept_trials(now: Progress, again: int, written: tuple[datetime, datetime]) -> str:
    """Say how many trials an earlier invocation left, and from when they are."""
    first, last = (f"{moment:%Y-%m-%d %H:%M}" for moment in written)
    when = f"from {first}" if first == last else f"from {first} to {last}"
    tried = f"; {again} that failed are tried again" if again else ""
    return f"Kept {now.trials_done} of {now.trials_total} trials, {when} UTC{tried}."


def unnamed(paths: Sequence[str]) -> str:
    """Say that a system reads files whose change nobody would notice."""
    return (
        f"The system reads {named(paths)}, not named in its data_files: a change there would not "
        "be noticed, and trials of before would be taken for trials of now."
    )
