"""LeRobot's own `lerobot.processor`, under Python 3.11 and with a torch for CPUs.

LeRobot 0.6.1 asks for Python 3.12, for which the package index has no torch for CPUs on x86-64
Linux. Four lines of three of its modules are in the syntax of 3.12; they are compiled as 3.11
writes the same. Its other modules are imported as they are, also that of the steps for relative
actions.
"""

import re
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from types import ModuleType

import torch

FOR_3_11 = {
    "lerobot.motors.motors_bus": (r"^type (NameOrID|Value) = ", r"\1 = "),
    "lerobot.processor.pipeline": (
        r"^class DataProcessorPipeline\[TInput, TOutput\]\(HubMixin\):",
        "class DataProcessorPipeline(HubMixin, __import__('typing').Generic[TInput, TOutput]):",
    ),
    "lerobot.utils.io_utils": (
        r"^def deserialize_json_into_object\[T: JsonLike\]\(fpath: Path, obj: T\) -> T:",
        "def deserialize_json_into_object(fpath: Path, obj: JsonLike) -> JsonLike:",
    ),
}
"""Pattern of the lines by module, and what is compiled in their place."""


class Loader(SourceFileLoader):
    """Loads a module of `FOR_3_11`."""

    def get_code(self, fullname: str):
        """Compile the source, its lines replaced; no byte code is read or written."""
        source = self.get_data(self.path).decode()
        return self.source_to_code(
            re.sub(*FOR_3_11[fullname], source, flags=re.MULTILINE).encode(), self.path
        )


class Finder:
    """Finds the modules of `FOR_3_11`."""

    @staticmethod
    def find_spec(name: str, path: Sequence[str] | None, target=None) -> ModuleSpec | None:
        spec = PathFinder.find_spec(name, path) if name in FOR_3_11 else None
        if spec and spec.origin:
            spec.loader = Loader(name, spec.origin)
        return spec


def processor() -> ModuleType:
    """Import and return `lerobot.processor`."""
    for name in ("nms", "qnms"):  # a torchvision for GPUs misses these; nothing here calls them
        torch.library.define(f"torchvision::{name}", "(Tensor a, Tensor b, float c) -> Tensor")
    sys.meta_path.insert(0, Finder)
    try:
        return import_module("lerobot.processor")
    finally:
        sys.meta_path.remove(Finder)
