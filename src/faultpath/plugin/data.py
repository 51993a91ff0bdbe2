"""For a package that makes files and keeps them: whole files, and the state of the code behind."""

from faultpath.core.files.parquet import Unreadable, read_table
from faultpath.trials.code import read_code, system_code
from faultpath.trials.imports import Root, packages
from faultpath.trials.store.atomic import (
    check_output,
    locked,
    make_folder,
    sweep,
    write,
    write_file,
    write_text,
)

__all__ = [
    "Root",
    "Unreadable",
    "check_output",
    "locked",
    "make_folder",
    "packages",
    "read_code",
    "read_table",
    "sweep",
    "system_code",
    "write",
    "write_file",
    "write_text",
]
