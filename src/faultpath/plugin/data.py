"""For a package that makes data files: whole files, and the state of the code that made them."""

from faultpath.core.files.atomic import (
    check_output,
    locked,
    make_folder,
    sweep,
    write,
    write_file,
)
from faultpath.core.trees import Root, packages, trees_of
from faultpath.run.code import system_code

__all__ = [
    "Root",
    "check_output",
    "locked",
    "make_folder",
    "packages",
    "sweep",
    "system_code",
    "trees_of",
    "write",
    "write_file",
]
