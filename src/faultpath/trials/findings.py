"""What a finished run shows about its declarations, at no cost."""

from collections.abc import Iterable

from faultpath.taps import TapCount
from faultpath.trials.outcome import Outcome
from faultpath.trials.table import OutcomeTable


def unread(counts: Iterable[tuple[str, TapCount]]) -> tuple[str, ...]:
    """Name the consumers that a variant declares and that never read, in any of its arms.

    `counts` are what the taps did in each arm, with the name of the variant.
    """
    reads: dict[tuple[str, str, str], int] = {}
    for variant, tap in counts:
        key = (variant, tap.channel, tap.consumer)
        reads[key] = reads.get(key, 0) + tap.deliveries
    return tuple(
        f"Variant '{variant}' declares that {consumer} reads '{channel}', but it never did: take "
        "it out of the variant's consumers, or deliver the channel to it."
        for (variant, channel, consumer), count in reads.items()
        if count == 0
    )


def unproven(table: OutcomeTable) -> tuple[str, ...]:
    """Say so where the hashes are the same in all scenes, and so prove nothing about the pairs."""
    sound = [row.outcome for row in table.rows if not row.outcome.failed]
    scenes = {outcome.scene for outcome in sound}
    if len(scenes) < 2 or len({_conditions(outcome) for outcome in sound}) > 1:
        return ()
    return (
        f"All {len(scenes)} scenes carry the same hashes of initial state, disturbance and planner "
        f"noise ({', '.join(map(repr, _conditions(sound[0])))}), so nothing proves that two trials "
        "met the same conditions: hash what each scene begins with and meets.",
    )


def _conditions(outcome: Outcome) -> tuple[str, str, str]:
    return outcome.initial_hash, outcome.disturbance_hash, outcome.planner_noise_hash
