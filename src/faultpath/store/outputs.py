"""Files that an option asks for, such as `--out FILE`: what they may take the place of."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from faultpath.errors import UserError
from faultpath.files.opening import opened
from faultpath.store.atomic import check_writable, write_text

_HEAD = 4096


@dataclass(frozen=True)
class Output:
    """A kind of file that faultpath writes."""

    what: str
    endings: tuple[str, ...]
    begins: Callable[[bytes], bool]
    """Whether the first bytes of a file are of this kind, and written by faultpath."""


PAGE = Output(
    "page", (".html", ".htm"), lambda head: b'name="generator" content="faultpath' in head
)
INTERFACE = Output(
    "interface without comments",
    (".yaml", ".yml"),
    lambda head: head.startswith(b"name: ") and b"#" not in head,
)
NUMBERS = Output(
    "JSON",
    (".json",),
    lambda head: head.startswith((b'{"format": 1, "profile"', b'{\n  "flown_s"')),
)
SCHEMA = Output("JSON Schema", (".json",), lambda head: head.startswith(b'{\n  "$defs"'))
FILM = Output("film", (".gif",), lambda head: head.startswith(b"GIF8"))


def check_output(path: Path, kind: Output) -> None:
    """Raise `UserError` where a file cannot be written, or would take the place of one that this
    option did not write; before the work that is to go into it."""
    check_writable(path)
    if not path.exists():
        return
    try:
        with opened(path) as file:
            head = file.read(_HEAD)
    except OSError as error:
        raise UserError(f"cannot replace {path} ({error.strerror}): give another path") from None
    ending = path.resolve().suffix.lower()
    ours = kind.begins(head) and ending in (*kind.endings, "")
    if not ours and (head or ending not in kind.endings):
        raise UserError(
            f"{path} is there already, and is no {kind.what} that faultpath wrote: give another "
            "path, or remove it"
        )


def write_output(path: Path, text: str, kind: Output) -> None:
    """Write a text file where `check_output` lets it be."""
    check_output(path, kind)
    write_text(path, text)
