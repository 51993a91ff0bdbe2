"""For a package that makes files and keeps them: whole files, and the state of the code behind."""

from faultpath.core.files.atomic import (
    check_output,
    locked,
    make_folder,
    sweep,
    write,
    write_file,
    write_text,
)
from faultpath.core.files.parquet import Unreadable, read_table
from faultpath.core.trees import Root, packages, trees_of
from faultpath.run.code import system_code

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
