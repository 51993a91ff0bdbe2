"""What callers hand in that can be nothing of what was asked for: a sentence each."""

from collections.abc import Sequence

from faultpath.errors import UserError

LARGEST = 2**63 - 1
"""What the tables hold."""


def checked_texts(**given: object) -> None:
    """Raise `UserError` for what is no text."""
    for name, value in given.items():
        if not isinstance(value, str):
            raise UserError(f"{name} is {value!r:.80}: give it as text.")


def checked_count(name: str, value: object) -> int | None:
    """Return a whole number or `None`; `UserError` for anything else."""
    if value is None or (isinstance(value, int) and not isinstance(value, bool)):
        return value
    raise UserError(f"{name} is {value!r:.80}: give a whole number, or None.")


def checked_seeds(seeds: int | Sequence[int]) -> tuple[int, ...]:
    """Return the seeds; `UserError` for what is no whole number between 0 and 2^63 - 1."""
    found: tuple[object, ...] = (
        tuple(seeds) if isinstance(seeds, Sequence) and not isinstance(seeds, str) else (seeds,)
    )
    for seed in found:
        if not isinstance(seed, int) or isinstance(seed, bool) or not 0 <= seed <= LARGEST:
            raise UserError(
                f"{seed!r:.80} is not a seed: give whole numbers between 0 and 2^63 - 1."
            )
    return tuple(seed for seed in found if isinstance(seed, int))
