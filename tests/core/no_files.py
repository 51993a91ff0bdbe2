"""What may stand in the place of a file and is none."""

import os
import socket
import stat
from collections.abc import Callable
from pathlib import Path

import pytest


def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as endpoint, pytest.MonkeyPatch.context() as patch:
        patch.chdir(path.parent)  # the path of a socket may be a hundred bytes long
        endpoint.bind(path.name)


def _device(path: Path) -> None:
    """Make a device like /dev/zero, which never ends."""
    try:
        os.mknod(path, 0o600 | stat.S_IFCHR, os.makedev(1, 5))
    except PermissionError:
        pytest.skip("only root makes devices")


THINGS: dict[str, Callable[[Path], None]] = {
    "a pipe": os.mkfifo,
    "a socket": _socket,
    "a device": _device,
    "a folder": Path.mkdir,
}
