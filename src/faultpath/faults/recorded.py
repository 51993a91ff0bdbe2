"""Recorded errors of other trials, delivered step by step."""

import hashlib
from collections.abc import Collection, Mapping
from functools import lru_cache
from typing import Any, Literal, NamedTuple, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from faultpath.core.arrays import Array, like, namespace
from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.faults.base import Intervention, Memory, Moment
from faultpath.interface import Channel


class Address(NamedTuple):
    """Channel, scene and seed of the errors in a part of a record."""

    channel: str
    scene: str
    seed: int


Record: TypeAlias = Mapping[Address, NDArray[np.float32]]
"""Errors `[T, ...]`, one for each control step."""

_COLUMNS = ("channel", "scene", "seed", "steps", "turns", "errors")


def encode_record(record: Record, turning: Collection[str] = ()) -> bytes:
    """Return a record as a Parquet file.

    Readings of the channels in `turning` are rotation matrices; their errors are rotation matrices
    too, in the readings' own axes. All other errors are added.
    """
    from faultpath.core.files.parquet import encode

    rows = [
        {
            **address._asdict(),
            "steps": len(errors),
            "turns": int(address.channel in turning),
            "errors": np.ascontiguousarray(errors, np.float32).reshape(-1),
        }
        for address, errors in sorted(record.items(), key=lambda entry: entry[0])
    ]
    return encode(_schema(), rows)


class Recorded(Intervention):
    """Add the errors that a file holds for the channel, by scene, seed and step.

    So one module alone can get the errors that all modules had in another trial. After the end of a
    scene's record its last error stays.
    """

    kind: Literal["recorded"] = "recorded"
    phrase = "with the errors of {file}"
    file: str
    """A Parquet file of `encode_record`."""
    channel: str = ""
    """Filled in by `resolved`."""
    digest: str = ""
    """Digest of the file, filled in by `resolved`, so that trials belong to its contents."""

    def resolved(self, channel: Channel) -> Self:
        """Fill in channel and digest; `UserError` for a file without errors of the channel."""
        digest, errors, _ = _read(self.file, channel.name)
        if self.digest not in ("", digest):
            raise UserError(f"{self.file} is not the file that the fault was made with: {_AGAIN}")
        if not errors:
            raise UserError(
                f"{self.file} holds no errors of channel '{channel.name}': aim the fault at one "
                f"that it has, or {_AGAIN}"
            )
        return self.model_copy(update={"channel": channel.name, "digest": digest})

    def begin(self, reading: Array, at: Moment) -> Memory:
        """Return the errors of all steps, `[T, B, ...]`, on the host, and whether they turn
        readings."""
        digest, errors, turns = _read(self.file, self.channel)
        if digest != self.digest:
            raise UserError(f"{self.file} has changed: {_AGAIN}")
        scenes: list[NDArray[np.float32]] = []
        for scene in at.draws.scenes:
            rows = errors.get((scene, at.draws.seed))
            shape = tuple(reading.shape[1:])
            if rows is None or not len(rows) or rows.shape[1] != np.prod(shape):
                raise UserError(
                    f"{self.file} holds no errors like {list(shape)} of channel '{self.channel}' "
                    f"in scene '{scene}', seed {at.draws.seed}: record that scene too"
                )
            scenes.append(rows.reshape(-1, *shape))
        longest = max(map(len, scenes))
        padded = [
            np.concatenate((rows, rows[-1:].repeat(longest - len(rows), 0))) for rows in scenes
        ]
        return np.stack(padded, axis=1), turns

    def apply(self, reading: Array, memory: Memory, at: Moment) -> tuple[Array, Memory]:
        """Return the reading with this step's error."""
        errors, turns = memory
        error = like(errors[min(at.step, len(errors) - 1)].astype(np.float64), reading)
        if turns:
            xp = namespace(reading)
            return xp.sum(reading[..., None] * error[..., None, :, :], axis=-2), memory
        return reading + error, memory


_AGAIN = "record the errors again"


def _schema() -> dict[str, Any]:
    from faultpath.core.files.parquet import INTEGER, NUMBERS, TEXT

    return dict(zip(_COLUMNS, (TEXT, TEXT, INTEGER, INTEGER, INTEGER, NUMBERS), strict=True))


def _read(
    file: str, channel: str
) -> tuple[str, Mapping[tuple[str, int], NDArray[np.float32]], bool]:
    """Return a file's digest, a channel's errors `[T, N]` by scene and seed, and whether they turn.

    `UserError` for a file that cannot be read or is no record.
    """
    try:
        data = contents(file)
    except OSError as error:
        raise UserError(f"the record {file} cannot be read: {error.strerror}.") from error
    trials = decode_record(data, file).get(channel, {})
    turning = {turns for turns, _ in trials.values()}
    digest = hashlib.sha256(data).hexdigest()[:16]
    return digest, {key: errors for key, (_, errors) in trials.items()}, turning == {True}


@lru_cache(maxsize=4)
def decode_record(
    data: bytes, file: str
) -> Mapping[str, Mapping[tuple[str, int], tuple[bool, NDArray[np.float32]]]]:
    """Return what `encode_record` wrote; `UserError`, naming `file`, for data that is no record.

    By channel, then by scene and seed: whether errors turn the reading, and the errors `[T, N]`.
    """
    from faultpath.core.files.parquet import Unreadable, decode

    channels: dict[str, dict[tuple[str, int], tuple[bool, NDArray[np.float32]]]] = {}
    try:
        for row in decode(data, _schema())[0]:
            errors = np.reshape(row["errors"], (row["steps"], -1))
            by_trial = channels.setdefault(row["channel"], {})
            by_trial[row["scene"], row["seed"]] = bool(row["turns"]), errors
    except (Unreadable, ValueError) as error:
        raise UserError(f"{file} is no record of errors: {error}.") from error
    return channels
