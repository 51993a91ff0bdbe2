"""Builds the compiled kernels with the package, where that is asked for.

`HATCH_BUILD_HOOK_ENABLE_CUSTOM=true` asks for it, and `make` does. Whoever installs the engine
alone gets a pure wheel, for which nothing runs.

One source is compiled once for each instruction set; which of them runs is chosen when the kernels
are loaded. They link to neither Python nor torch, so one wheel serves every Python. Without a
compiler the package is installed all the same and runs on its portable path.
"""

import hashlib
import os
import platform
import shutil
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

NATIVE = Path("src/faultpath_quadrotor/native")
FLAGS = (
    "-std=c++17",
    "-O3",
    "-fPIC",
    "-shared",
    "-fno-exceptions",
    "-fno-rtti",
    "-fvisibility=hidden",
    # Results must not depend on what a compiler chooses to fuse or to reorder.
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-trapping-math",
    # The code is vectors already; a second look at it only spills registers.
    "-fno-tree-vectorize",
    "-fno-tree-slp-vectorize",
)
X86 = {"avx512": ("-mavx512f",), "avx2": ("-mavx2", "-mfma"), "baseline": ()}
OTHER = {"baseline": ()}


class KernelHook(BuildHookInterface):
    """Compiles the kernels before a wheel, editable or not, is put together."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile, and say that the wheel is of this platform; or leave it pure."""
        del version
        folder = Path(self.root) / NATIVE
        for stale in folder.glob("kernels-*.so"):
            stale.unlink()
        compiler = _compiler()
        if compiler is None:
            self.app.display_warning("No C++ compiler: the portable path will run instead.")
            return
        sets = X86 if platform.machine().lower() in ("x86_64", "amd64") else OTHER
        for name, flags in sets.items():
            self._compile(compiler, flags, folder / f"kernels-{name}.so")
        if not list(folder.glob("kernels-*.so")):
            return
        build_data["artifacts"].append(f"{NATIVE}/kernels-*.so")
        build_data["pure_python"] = False
        build_data["tag"] = (
            f"py3-none-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
        )

    def _compile(self, compiler: str, flags: tuple[str, ...], target: Path) -> None:
        files = sorted((target.parent / "source").iterdir())
        digest = hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()
        sources = [str(path) for path in files if path.suffix == ".cpp"]
        unfinished = target.with_suffix(".part")
        made_from = f'-DFAULTPATH_SOURCES="{digest}"'
        command = [compiler, *FLAGS, *flags, made_from, *sources, "-o", str(unfinished)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            self.app.display_warning(f"{target.name} was not built: {done.stderr[-2000:]}")
            return
        unfinished.replace(target)


def _compiler() -> str | None:
    for name in (os.environ.get("CXX"), "c++", "g++", "clang++"):
        if name and shutil.which(name):
            return name
    return None
