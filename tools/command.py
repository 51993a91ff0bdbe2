"""The command, as a tool has it fill a folder: where a step fails, the tool ends as that did."""

import argparse
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path


def new_folder(doc: str | None, arguments: Sequence[str] | None) -> Path:
    """Return the one argument of a tool whose docstring is `doc`; exit with 2 where it exists."""
    parser = argparse.ArgumentParser(description=(doc or "").partition("\n")[0])
    parser.add_argument("folder", type=_absent, metavar="FOLDER")
    return parser.parse_args(arguments).folder


def _absent(name: str) -> Path:
    folder = Path(name)
    if folder.exists():
        raise argparse.ArgumentTypeError(f"{folder} exists: name a folder that is new")
    return folder


def faultpath(*arguments: str) -> None:
    """Run the command that lies beside this Python; exit with its status where it fails."""
    command = [str(Path(sys.executable).with_name("faultpath")), *arguments]
    status = subprocess.run(command, check=False).returncode
    if status:
        sys.exit(status)
