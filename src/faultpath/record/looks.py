"""What was concluded before from the same trials: an audit that is extended after a look."""

from collections.abc import Iterable, Sequence

from faultpath.record.earlier import EarlierLook
from faultpath.record.model import DecisionRecord
from faultpath.record.question import Question
from faultpath.record.words import series


def after_looks(record: DecisionRecord, earlier: Iterable[DecisionRecord]) -> DecisionRecord:
    """Return a record that tells of other conclusions from its trials, and what they cost.

    `earlier` are records of the same arms by the same code, with the looks that they tell of. The
    same question asked again is no look, and one with too few scenes to announce anything is none.
    A sequential audit allows for all looks with the same primary contrast.
    """
    known = [look for each in earlier for look in (*each.earlier, *_looks(each))]
    looks = tuple(look for look in dict.fromkeys(known) if look != _look(record.question))
    if not looks:
        return record
    found = (*record.findings, look_words(looks))
    return record.model_copy(update={"earlier": looks, "findings": found})


def _looks(record: DecisionRecord) -> tuple[EarlierLook, ...]:
    return () if record.scenes < record.scenes_needed else (_look(record.question),)


def _look(asked: Question) -> EarlierLook:
    if asked.stop is not None:
        return EarlierLook(scenes=None, primary=asked.primary)
    return EarlierLook(
        scenes=asked.n_scenes,
        primary=asked.primary,
        generalise=asked.generalise,
        rule=asked.rule,
    )


def look_words(looks: Sequence[EarlierLook]) -> str:
    """Say what was concluded before, and what that does to what is announced now."""
    counts = sorted({look.scenes for look in looks if look.scenes is not None})
    with_scenes = f" with {series([str(n) for n in counts])} scenes" if counts else ""
    led = series([f"'{name}'" for name in dict.fromkeys(look.primary for look in looks)])
    return (
        f"This audit was concluded before{with_scenes}, led by {led}: after such a look, what it "
        "announces now is wrong more often than in 5 % of audits. Ask again of scenes that no "
        "audit has looked at, or with --stop-when, which allows for looks."
    )
