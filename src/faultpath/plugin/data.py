"""For a package that makes files and keeps them: whole files, and the state of the code behind."""

from faultpath.core.files.parquet import Unreadable, read_table
from faultpath.trials.code import system_code
from faultpath.trials.store.atomic import (
    check_output,
    locked,
    make_folder,
    sweep,
    write,
    write_file,
    write_text,
)
from faultpath.trials.trees import Root, packages, trees_of

__all__ = [
    "Root",
    "Unreadable",
    "check_output",
    "locked",
    "make_folder",
    "packages",
    "read_table",
    "sweep",
    "system_code",
    "trees_of",
    "write",
    "write_file",
    "write_text",
]
