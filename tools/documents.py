"""Write every document that is made from numbers, so that no number is typed.

    python tools/documents.py                          write what is stale
    python tools/documents.py --check                  exit 1 when something is
    python tools/documents.py --take NAME=RUN_FOLDER   make a run folder a reference run first
    python tools/documents.py --paper RUN_FOLDER       ship a run of the whole paper first
    python tools/documents.py --conclude               decide all reference runs anew first
    python tools/documents.py --images                 make the pictures too, with Chromium

A block stands between `<!-- begin:KIND:ARGUMENT -->` and `<!-- end:KIND:ARGUMENT -->`, each on a
line of its own; `KINDS` lists the kinds. `PAGES` are the files that are made whole.
`docs/reference/README.md` says what a reference run is.
"""

import argparse
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import blocks
import carry_blocks
import found_blocks
import latent_blocks
import map_blocks
import model_blocks
import paper_blocks
import state_blocks
from blocks import REFERENCE, ROOT, Wrong, copied, load
from pictures import IMAGES, digest, made_from, make_images, name_of

from faultpath.api.folders import MADE_FROM, MAP
from faultpath.trials.store.signals import SIGNALS

sys.path.insert(0, str(ROOT))
from benchmarks import page as performance

TAKEN = (*MADE_FROM, "provenance.json", "report.html", "table.md")
"""All that `faultpath report` reads of a run folder and writes there."""

KINDS: Mapping[str, Any] = {
    **blocks.KINDS,
    "carry": carry_blocks.KIND,
    "audits": found_blocks.audits,
    "found": found_blocks.table,
    "latent": latent_blocks.KIND,
    "map": map_blocks.KIND,
    "central": {"answer": paper_blocks.central_answer, "table": paper_blocks.central_table},
    "models": model_blocks.table,
    "paper": paper_blocks.KIND,
    "performance": performance.KIND,
    "state": state_blocks.KIND,
}
"""Functions that fill a block from the other words of its name, by kind, or by kind and part."""

BLOCK = re.compile(
    r"^<!-- begin:(?P<name>\S+) -->\n(?P<body>.*?)^<!-- end:(?P=name) -->$",
    flags=re.MULTILINE | re.DOTALL,
)
MARKER = re.compile(r"^<!-- (?:begin|end):\S+ -->$", flags=re.MULTILINE)


PAGES: tuple[Callable[[], Mapping[Path, str]], ...] = (
    map_blocks.pictures,
    paper_blocks.pictures,
    paper_blocks.elsewhere,
    paper_blocks.fact_page,
    state_blocks.pictures,
)
"""Functions that return whole files, by their path."""


def documents() -> list[Path]:
    """Return the documents that may have blocks."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def fill(name: str, document: Path) -> str:
    """Return the text of the block `name` of a document."""
    filler, words = KINDS, name.split(":")
    while isinstance(filler, Mapping):
        kind, *words = words or [""]
        if kind not in filler:
            raise Wrong(
                f"{document.name}: there is no block '{kind}' in '{name}': use {', '.join(filler)}"
            )
        filler = filler[kind]
    text = filler(*words)
    folders = {"{docs}": ROOT / "docs", "{images}": IMAGES, "{reference}": REFERENCE}
    for word, folder in folders.items():
        text = text.replace(word, Path(os.path.relpath(folder, document.parent)).as_posix())
    return text


def filled(text: str, document: Path) -> str:
    """Return a document's text with every block filled; `Wrong` for a marker without a partner."""
    paired = 2 * len(BLOCK.findall(text))
    if len(MARKER.findall(text)) != paired:
        raise Wrong(f"{document.name}: a begin or end of a block stands alone")

    def replace(match: re.Match[str]) -> str:
        name = match["name"]
        return f"<!-- begin:{name} -->\n{fill(name, document)}\n<!-- end:{name} -->"

    return BLOCK.sub(replace, text)


def made() -> Mapping[Path, str]:
    """Return every file that follows from numbers, by its path."""
    files = {path: filled(path.read_text("utf-8"), path) for path in documents()}
    for make in PAGES:
        files |= make()
    return files


def stale() -> Iterator[str]:
    """Yield each file, block or picture that is not up to date, in words."""
    files = made()
    for path, content in files.items():
        text = path.read_text("utf-8") if path.is_file() else ""
        if text != content:
            pairs = zip(BLOCK.finditer(text), BLOCK.finditer(content), strict=False)
            names = [f"block {a['name']}" for a, b in pairs if a["body"] != b["body"]]
            yield ": ".join(filter(None, [str(path.relative_to(ROOT)), ", ".join(names)]))
    for path in leftover(files):
        yield f"{path.relative_to(ROOT)}: nothing was measured for it"
    drawn = made_from()
    for run, part in pictures():
        name = name_of(run, part)
        if not (IMAGES / name).is_file() or drawn.get(name) != digest(run):
            yield f"docs/images/{name}: make it with --images"


def write() -> None:
    """Write what is stale, and delete pictures of what is no longer measured."""
    files = made()
    for path, text in files.items():
        if not path.is_file() or path.read_text("utf-8") != text:
            path.write_text(text, "utf-8")
    for path in leftover(files):
        path.unlink()


def leftover(files: Mapping[Path, str]) -> list[Path]:
    """Return the drawn pictures that no measurement gives."""
    pages = {IMAGES / name_of(*picture) for picture in pictures()}
    pages |= {IMAGES / name for name in made_from()}
    drawn = ("paper-figure-2.svg", "latent-camera-strip.svg")
    kept = {*IMAGES.glob("fault-*.svg"), *(IMAGES / name for name in drawn)}
    return sorted(set(IMAGES.glob("*.svg")) - set(files) - pages - kept)


def pictures() -> list[tuple[str, str]]:
    """Return the run and part of every picture that documents show and that a run is there for."""
    texts = [path.read_text("utf-8") for path in documents()]
    names = [m["name"].split(":") for text in texts for m in BLOCK.finditer(text)]
    return sorted({(n[1], n[2]) for n in names if n[0] == "picture"})


def take(what: str) -> None:
    """Make a run folder a reference run, from `NAME=FOLDER`."""
    name, separator, folder = what.partition("=")
    if not separator or not name:
        raise Wrong(f"--take {what}: give NAME=FOLDER of a finished run")
    if (Path(folder) / MAP).is_file():
        map_blocks.take(name, Path(folder))
        return
    if (Path(folder) / carry_blocks.CELLS).is_file():
        carry_blocks.take(name, Path(folder))
        return
    signals = (SIGNALS,) if (Path(folder) / SIGNALS).is_file() else ()
    copied((*TAKEN, *signals), Path(folder), REFERENCE / name)
    load.cache_clear()
    if load(name).provenance.dirty:
        print(f"{name} was made with uncommitted changes, and the documents will say so.")


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry out the command line; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="exit 1 when something is stale")
    parser.add_argument("--images", action="store_true", help="make the pictures too")
    parser.add_argument("--conclude", action="store_true", help="decide stored runs anew first")
    parser.add_argument("--paper", type=Path, metavar="RUN_FOLDER")
    parser.add_argument("--take", action="append", default=[], metavar="NAME=RUN_FOLDER")
    options = parser.parse_args(arguments)
    try:
        if options.check:
            problems = list(stale())
            hint = "Run python tools/documents.py."
            print("\n".join([*problems, hint] if problems else ["Up to date."]))
            return 1 if problems else 0
        for what in options.take:
            take(what)
        if options.paper is not None:
            paper_blocks.take(options.paper)
        if options.conclude:
            from conclude import conclude_all

            conclude_all(print)
            load.cache_clear()
            paper_blocks.load.cache_clear()
        write()
        if options.images:
            make_images(pictures())
    except Wrong as wrong:
        print(f"documents.py: {wrong}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
