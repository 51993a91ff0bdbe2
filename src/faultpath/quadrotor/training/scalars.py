"""Curves of a fit for TensorBoard, when somebody asks for them."""

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from faultpath.errors import UserError


class Scalars:
    """Writes numbers at the end of epochs, or nothing when nobody asked."""

    def __init__(self, writer: Any = None) -> None:
        self._writer = writer

    def add(self, epoch: int, values: Mapping[str, float]) -> None:
        """Write some numbers of an epoch, counted from 1."""
        if self._writer is not None:
            for name, value in values.items():
                self._writer.add_scalar(name, value, epoch)


@contextmanager
def open_scalars(folder: Path | None, run: str) -> Generator[Scalars, None, None]:
    """Open the event files of a run below `folder`; without a folder nothing is written."""
    if folder is None:
        yield Scalars()
    else:
        with _writer_class()(str(folder / run)) as writer:
            yield Scalars(writer)


def require_tensorboard() -> None:
    """Raise `UserError` when TensorBoard is not installed."""
    _writer_class()


def _writer_class() -> Any:
    try:
        # torch re-exports the class without saying so in its annotations.
        from torch.utils.tensorboard import SummaryWriter  # pyright: ignore[reportPrivateImportUsage]
    except ModuleNotFoundError as error:
        raise UserError(
            "--tensorboard needs the tensorboard package, which is not installed: "
            "pip install 'faultpath[tensorboard]'."
        ) from error
    return SummaryWriter
