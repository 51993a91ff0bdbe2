"""A run on disk: the plan that it is of, its finished blocks, and the tables made from them."""

import hashlib
import json
from collections.abc import Generator, Iterable, Sequence
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from faultpath.core.errors import UserError
from faultpath.core.files import atomic
from faultpath.core.files.atomic import Say, check_folder, locked, make_folder, write_file
from faultpath.core.files.opening import LARGEST_TEXT, contents, read_regular
from faultpath.core.files.parquet import Unreadable
from faultpath.core.files.plain import Misread, model_of, read_json
from faultpath.core.results import Frozen
from faultpath.run.attempt import Done
from faultpath.run.code import CodeState, named
from faultpath.run.deliveries import Deliveries
from faultpath.run.plan import Plan
from faultpath.run.store.tables import (
    decode_outcomes,
    decode_shard,
    encode_outcomes,
    encode_shard,
    encode_traces,
)
from faultpath.run.trials import Trials

OUTCOMES, TRACES, DELIVERIES = "outcomes.parquet", "traces.parquet", "deliveries.json"
"""Files that are assembled at the end of a run."""
FORMAT = 3
"""Version of the folder's layout and of its columns."""


class Manifest(Frozen):
    """The plan of a run folder and the exact system and scenes that it was run with."""

    format: int = FORMAT
    faultpath_version: str
    code: CodeState
    """Source files, data files, packages."""
    library_hash: str
    plan: Plan

    def encode(self) -> bytes:
        """Return the file's contents."""
        content = self.model_dump(mode="json")
        return (json.dumps(content, indent=2, sort_keys=True) + "\n").encode()


def keyed(name: str, code: CodeState) -> Path:
    """Return the folder for a question, run by `code`."""
    return Path("runs") / f"{name}-{code.digest[:8]}"


class RunFolder:
    """The folder of one run.

    `manifest.json` says which plan it is, `shards/` holds one Parquet file a finished block,
    `failures/` the tracebacks of trials that failed, and `outcomes.parquet` and `traces.parquet`
    are assembled at the end, with what the taps did in `deliveries.json`. Everything is written
    atomically.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.shards = path / "shards"
        self.failures = path / "failures"
        self.manifest = path / "manifest.json"
        self.rechecks = path / "rechecks.json"
        self.provenance = path / "provenance.json"
        self._shard_files: dict[str, list[Path]] | None = None
        """By key, as listed last: listing the folder for each block would cost its square."""

    @contextmanager
    def open(self, manifest: Manifest, notice: Say, shared: bool = False) -> Generator[None]:
        """Create or continue the run, alone in the folder until the end of the `with` block.

        `shared` lets plans with other treatments use the folder one after the other. `UserError`
        when the folder cannot be written, or holds something else.
        """
        if not self.manifest.exists():  # nothing is left in a folder of somebody else
            atomic.check_free(self.path)
        make_folder(self.path)
        with locked(self.path, notice):
            previous = read_manifest(self.manifest)
            if previous is not None:
                check_same(self.path, previous, manifest, shared)
            atomic.sweep(self.path)
            if previous != manifest:  # first of all: without it the folder is nobody's
                self._write(self.manifest, manifest.encode())
            for folder in (self.shards, self.failures):
                make_folder(folder)
                atomic.sweep(folder)
            self._shard_files = self.list_shards()
            yield

    def made_by_other_code(self, manifest: Manifest) -> Manifest | None:
        """Return what the manifest would be if the code that the folder was run with ran it."""
        previous = read_manifest(self.manifest) or manifest
        made_by = {"code": previous.code, "faultpath_version": previous.faultpath_version}
        earlier = manifest.model_copy(update=made_by)
        return None if earlier == manifest else earlier

    def save_shard(self, key: str, shard: Done) -> None:
        """Store a finished block. The name carries a digest of the bytes, checked on reading."""
        data = encode_shard(key, shard)
        path = self.shards / f"{key}-{_digest(data)[:32]}.parquet"
        self._write(path, data)
        for file in self._files_of(key):
            if file != path:  # the block as it was before its failed trials were tried again
                file.unlink(missing_ok=True)
        self._files_of(key)[:] = [path]

    def written(self, keys: Sequence[str]) -> tuple[datetime, datetime]:
        """Return when the first and the last of some stored blocks were written, UTC."""
        times = [path.stat().st_mtime for key in keys for path in self._files_of(key)]
        return datetime.fromtimestamp(min(times), UTC), datetime.fromtimestamp(max(times), UTC)

    def load_shard(self, key: str, scenes: Sequence[str], notice: Say) -> Done | None:
        """Return a finished block, or `None` without a whole one; a damaged one is removed."""
        shards: list[Done] = []
        for path in tuple(self._files_of(key)):
            try:
                shards.append(_read_shard(path, key, scenes))
            except Unreadable as error:
                notice(f"{path} is damaged ({error}); removing it and running its trials again")
                path.unlink()
                self._files_of(key).remove(path)
        # A process killed between writing and tidying leaves two; the later one failed less often.
        return min(shards, key=lambda shard: sum(o.failed for o in shard.outcomes), default=None)

    def finished(
        self, units: Iterable[tuple[str, Sequence[str]]], may_stop: bool
    ) -> dict[str, Done]:
        """Return the blocks of a finished run; none where one is missing or has failures.

        A run that `may_stop` has those up to the first that is missing.
        """
        files, blocks = self.list_shards(), dict[str, Done]()
        for key, scenes in units:
            if key not in files and may_stop:
                break
            try:
                blocks[key] = _read_shard(files[key][0], key, scenes)
            except (KeyError, Unreadable):
                return {}
        failed = any(trial.failed for block in blocks.values() for trial in block.outcomes)
        return blocks if self.provenance.exists() and not failed else {}

    def save_failure(self, key: str, text: str) -> None:
        """Store what is known about the failed trials of a block; without any, forget the last."""
        path = self.failures / f"{key}.txt"
        if text:
            self._write(path, text.encode(errors="backslashreplace"))
        else:
            path.unlink(missing_ok=True)

    def load_failure(self, key: str) -> str:
        """Return what is known about the failed trials of a block; empty without any."""
        with suppress(FileNotFoundError):
            return contents(self.failures / f"{key}.txt").decode(errors="replace")
        return ""

    def save_tables(self, trials: Trials, deliveries: Deliveries) -> str:
        """Write what was assembled and return the SHA-256 of the outcomes."""
        data = encode_outcomes(trials)
        self._write(self.path / DELIVERIES, f"{deliveries.model_dump_json(indent=1)}\n".encode())
        self._write(self.path / TRACES, encode_traces(trials))
        self._write(self.path / OUTCOMES, data)
        return _digest(data)

    def list_shards(self) -> dict[str, list[Path]]:
        """Return the files of the finished blocks that are on disk, by key."""
        files: dict[str, list[Path]] = {}
        for path in sorted(self.shards.glob("*-*.parquet")):
            files.setdefault(path.name.rpartition("-")[0], []).append(path)
        return files

    def _files_of(self, key: str) -> list[Path]:
        if self._shard_files is None:
            self._shard_files = self.list_shards()
        return self._shard_files.setdefault(key, [])

    def _write(self, path: Path, data: bytes) -> None:
        write_file(path, data, self.path)


def read_manifest(path: Path) -> Manifest | None:
    """Read a manifest, `None` when there is none; `UserError` when this version cannot use it."""
    check_folder(path.parent)
    try:
        data = contents(path, LARGEST_TEXT)
        content: Any = read_json(data)
        # Before the model, which other formats do not fit.
        if content["format"] != FORMAT:
            raise UserError(
                f"{path.parent} was written in format {content['format']} and this faultpath reads "
                f"format {FORMAT}: choose another folder, or the version of faultpath that wrote it"
            )
        return model_of(data, Manifest)
    except FileNotFoundError:
        return None
    except (OSError, Misread, TypeError, KeyError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise UserError(
            f"{path} cannot be read as a manifest ({why}): choose a new folder, or delete this one"
        ) from error


def check_same(folder: Path, previous: Manifest, manifest: Manifest, shared: bool = False) -> None:
    """Raise `UserError` unless `folder` may go on with the plan of `manifest`.

    The selection of scenes may differ: a run of some scenes grows into one of the whole library in
    the same folder, and keeps what it has. In a folder that the rounds of one map or scan share,
    their treatments may differ as well.
    """
    plan, stored = manifest.plan, previous.plan
    compared: dict[str, tuple[object, object]] = {
        "version of faultpath": (previous.faultpath_version, manifest.faultpath_version),
        "question": (stored.name, plan.name),
        "system": (stored.system, plan.system),
        "library": (stored.library, plan.library),
        "state of the library": (previous.library_hash, manifest.library_hash),
    }
    if not shared:
        compared["set of variants, faults or seeds"] = (stored.rows, plan.rows)
        per_analysis = stored.scenes_per_analysis, plan.scenes_per_analysis
        compared["number of scenes from analysis to analysis"] = per_analysis
    for name, (before, after) in compared.items():
        if before != after:
            raise UserError(
                f"{folder} holds another run, with another {name}: choose a new folder, or repeat "
                "the command that made this one"
            )
    if changed := previous.code.changed(manifest.code):
        raise UserError(
            f"{folder} holds trials of other code than this (changed since: {named(changed)}): "
            "they are kept and not mixed with new ones; choose a new folder, or go back to that "
            "code to resume"
        )


def _read_shard(path: Path, key: str, scenes: Sequence[str]) -> Done:
    try:
        data = contents(path)
    except OSError as error:
        raise UserError(f"{path} cannot be read ({error.strerror}): remove it.") from error
    if path.stem != f"{key}-{_digest(data)[:32]}":
        raise Unreadable("its contents are not those that were written")
    shard = decode_shard(data, key)
    if [outcome.scene for outcome in shard.outcomes] != list(scenes):
        raise Unreadable("it holds other scenes")
    return shard


def read_outcomes(path: Path) -> Trials:
    """Read an assembled outcome table (without traces); `UserError` when there is none to read."""
    try:
        return decode_outcomes(read_regular(path))
    except Unreadable as error:
        raise UserError(
            f"{path} is damaged ({error}): run the same command again to rebuild it"
        ) from None


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
