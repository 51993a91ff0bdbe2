"""Code of a system runs apart from its caller, whose directory and output it may not take over."""

import os
import sys
from collections.abc import Generator
from contextlib import contextmanager, redirect_stdout, suppress

from faultpath.system.system import System

FOLDER = "_faultpath_folder"
"""Under which name a system keeps the working directory that it entered while it loaded."""


@contextmanager
def set_apart(system: System | None = None) -> Generator[str]:
    """Yield the working directory, and put it back at the end of the `with` block.

    A loaded `system` runs in the one that it entered. What is printed is no output of a command.
    """
    before = working_directory()
    try:
        if system is not None and (own := vars(system).get(FOLDER)):
            os.chdir(own)
        with redirect_stdout(sys.stderr):
            yield before
    finally:
        if working_directory() != before:
            with suppress(OSError):  # it was removed meanwhile
                os.chdir(before)


def working_directory() -> str:
    """Return the working directory; empty where it was removed."""
    try:
        return os.getcwd()
    except FileNotFoundError:
        return ""
