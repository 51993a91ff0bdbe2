"""For a package that adds verbs to `faultpath`; it imports little, because `--help` loads it."""

from faultpath.cli.options import FOUND, Json, Verbs, path, refuse_with
from faultpath.core.errors import Stopped, UserError
from faultpath.run.texts import LARGEST

__all__ = [
    "FOUND",
    "LARGEST",
    "Json",
    "Stopped",
    "UserError",
    "Verbs",
    "path",
    "refuse_with",
]
