"""What the taps did, read back from a run folder."""

from pathlib import Path

from pydantic import ValidationError

from faultpath.errors import UserError
from faultpath.trials.deliveries import Deliveries


def read_deliveries(path: Path) -> Deliveries:
    """Read `deliveries.json` of a run folder; `UserError` when there is none to read."""
    try:
        return Deliveries.model_validate_json(path.read_bytes())
    except OSError as error:
        raise UserError(
            f"cannot read {path} ({error.strerror}): run the study again, which keeps its trials"
        ) from error
    except ValidationError as error:
        raise UserError(
            f"{path} is damaged: run the study again, which keeps its trials and writes it anew"
        ) from error
