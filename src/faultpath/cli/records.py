"""Reading what a finished audit left, without what draws it and without the system's code."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from faultpath.errors import UserError
from faultpath.record import DecisionRecord, RunProvenance
from faultpath.store.sealed import AGAIN, read_regular

_Model = TypeVar("_Model", bound=BaseModel)


def read_record(folder: Path) -> DecisionRecord:
    """Read `record.json`; `UserError` when it is missing, damaged or of another version."""
    return _read(folder / "record.json", DecisionRecord)


def read_provenance(folder: Path) -> RunProvenance:
    """Read `provenance.json`; `UserError` when it is missing, damaged or of another version."""
    return _read(folder / "provenance.json", RunProvenance)


def parsed(data: bytes, path: Path, model: type[_Model]) -> _Model:
    """Return a file's contents as `model`; `UserError` when they are not that."""
    try:
        return model.model_validate_json(data)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"])) or "the whole"
        raise UserError(
            f"{path} is damaged or of another version of faultpath ({where!r}): {AGAIN}."
        ) from None


def _read(path: Path, model: type[_Model]) -> _Model:
    return parsed(read_regular(path), path, model)
