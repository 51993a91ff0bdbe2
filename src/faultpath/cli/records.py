"""Reading what a finished audit left, without what draws it."""

from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from faultpath.errors import UserError
from faultpath.record import DecisionRecord, RunProvenance

_Model = TypeVar("_Model", DecisionRecord, RunProvenance)


def read_record(folder: Path) -> DecisionRecord:
    """Read `record.json`; `UserError` when it is missing, damaged or of another version."""
    return _read(folder / "record.json", DecisionRecord)


def read_provenance(folder: Path) -> RunProvenance:
    """Read `provenance.json`; `UserError` when it is missing, damaged or of another version."""
    return _read(folder / "provenance.json", RunProvenance)


def _read(path: Path, model: type[_Model]) -> _Model:
    try:
        return model.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        raise UserError(
            f"{path.parent} holds no {path.name}: give the folder of a finished audit."
        ) from None
    except ValidationError:
        raise UserError(
            f"{path} is damaged or of another version of faultpath: run the audit again."
        ) from None
