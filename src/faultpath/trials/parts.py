"""Parts of their own that users name where a variant is asked for: `my_model.py:create`."""

import re
from collections.abc import Iterable, Mapping

from faultpath.errors import UserError
from faultpath.trials.registry import system_options

BRING = "bring"
"""The option of a system that takes such names, parted by commas; a system without it takes no
parts."""

_NAME = re.compile(r"([^:]+:[A-Za-z_]\w*)(?:/|$)")


def with_parts(system: str, options: Mapping[str, str], variants: Iterable[str]) -> dict[str, str]:
    """Return the options of a system with the parts that `variants` name among them.

    So worker processes, fingerprint and record get them as they get every option. A variant is
    named by a part, or by a part and more after a slash, as in `my_model.py:create/gru`.
    `UserError` for a file without the name of what builds the part, or a comma in its path.
    """
    named = [name for name in variants if ":" in name or name.endswith(".py")]
    if not named or BRING not in {option.name for option in system_options(system)}:
        return dict(options)
    for name in named:
        if ":" not in name:
            raise UserError(
                f"'{name}' is a file: name the function in it that builds your part too, as in "
                f"'{name}:create'."
            )
        if "," in name:
            raise UserError(f"'{name}' has a comma in it: rename the file, commas part names.")
    found = [part for part in options.get(BRING, "").split(",") if part]
    found += [part for name in named for part in _NAME.findall(name)]
    return {**options, BRING: ",".join(dict.fromkeys(found))}
