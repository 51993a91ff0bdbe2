"""From the arguments of a call, or the flags of a command, to a question that was checked."""

import re
from collections.abc import Mapping
from typing import TypeVar

from pydantic import ValidationError

from faultpath.core.errors import UserError
from faultpath.core.results import Frozen
from faultpath.core.validation_messages import misfit_of
from faultpath.trials.question import Flag

_Asked = TypeVar("_Asked", bound=Frozen)


def ask(model: type[_Asked], fields: Mapping[str, object], command: bool = False) -> _Asked:
    """Return what is asked; `UserError` for what does not fit, by its flag if `command`."""
    try:
        return model.model_validate(dict(fields))
    except ValidationError as error:
        wrong = misfit_of(error, model)
        first = str(wrong.place[0]) if wrong.place else ""
        where = flag(model, first) if command and first in model.model_fields else wrong.where
        raise UserError(f"{where}: {wrong.says}.") from None


def flag(model: type[Frozen], name: str) -> str:
    """Return what the command line calls a field: `margin_pp` is `--margin`."""
    field = model.model_fields[name]
    for note in field.metadata:
        if isinstance(note, Flag) and note.name:
            return note.name
    dashed = re.sub(r"_(s|pp)$", "", name).replace("_", "-")
    return f"--no-{dashed}" if field.default is True else f"--{dashed}"
