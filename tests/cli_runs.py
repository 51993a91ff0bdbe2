"""Running the command line, in this process and in others."""

import contextlib
import io
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch

from faultpath.cli.main import main

ROOT = Path(__file__).resolve().parents[1]
TOY = f"{ROOT / 'examples' / 'toy.py'}:create"
COMMAND = [sys.executable, "-c", "from faultpath.cli.main import main; main()"]


@dataclass(frozen=True)
class Ended:
    """How a command ended."""

    status: int
    out: str
    err: str

    def refused(self, *names: str) -> str:
        """Return the one sentence of a mistake, after checking that it is one and has the names."""
        assert self.status == 2, (self.status, self.out, self.err)
        assert "Traceback" not in self.out + self.err
        assert self.err.endswith("\n")
        *notices, line = self.err.splitlines()
        assert line.startswith("faultpath: ")
        assert not [notice for notice in notices if notice.startswith("faultpath: ")]
        assert len(line) > 30
        assert not [name for name in names if name not in line], (line, names)
        return line


def faultpath(*arguments: object) -> Ended:
    out, err = io.StringIO(), io.StringIO()
    command = ["faultpath", *map(str, arguments)]
    with (
        patch.object(sys, "argv", command),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as stop:
            return Ended(int(stop.code or 0), out.getvalue(), err.getvalue())
    raise AssertionError("main() always exits with a status")


def audit(*arguments: object, **options: object) -> Ended:
    """Audit the toy in this process; an option given here replaces the default one."""
    return faultpath(*audit_line(*arguments, **options))


def audit_line(*arguments: object, **options: object) -> list[object]:
    chosen: dict[str, object] = {
        "system": TOY,
        "baseline": "calibrated",
        "repair": "blind",
        "fault": "gain:scale=0.6",
        "library": "carts",
        "scenes": 6,
        "workers": 0,
    } | options
    return ["audit", chosen.pop("system"), *flags(chosen), *arguments]


def flags(values: dict[str, object]) -> list[object]:
    """Return options as a line has them."""
    return [part for name, value in values.items() for part in (f"--{name}", value)]


def start(words: Path, *line: object) -> subprocess.Popen[str]:
    """Run a command in a process and session of its own, its words going into a file."""
    with words.open("w") as file:
        return subprocess.Popen(
            [*COMMAND, *map(str, line)],
            stdout=file,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
            env={**os.environ, "COLUMNS": "200"},
        )


def until(condition: Callable[[], object], what: str, seconds: float = 60.0) -> None:
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, f"waited in vain for {what}"
        time.sleep(0.02)


def shards(folder: Path) -> list[Path]:
    return sorted(folder.glob("shards/*.parquet"))


def edit(path: Path, change: Callable[[dict], object]) -> None:
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))
