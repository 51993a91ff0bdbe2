"""Write every document that is made from numbers, so that no number is typed.

    python tools/documents.py                          write what is stale
    python tools/documents.py --check                  exit 1 when something is
    python tools/documents.py --take NAME=RUN_FOLDER   make a run folder a reference run first
    python tools/documents.py --take paper=RUN_FOLDER  ship a run of the whole paper first
    python tools/documents.py --conclude               decide all reference runs anew first
    python tools/documents.py --images                 make the pictures too, with Chromium

A block stands between `<!-- begin:KIND:ARGUMENT -->` and `<!-- end:KIND:ARGUMENT -->`, each on a
line of its own. Macros of `templates` write most kinds, `BLOCKS` lists all; `PICTURES` are drawn.
`docs/reference/README.md` says what a reference run is.
"""

import argparse
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import api_blocks
import comparison
import film_openpilot
import film_quadrotor
import paper_blocks
import run_blocks
import schema_files
import studies
from blocks import IMAGES, REFERENCE, ROOT, RUNS, Picture, Wrong, copied, figures_of, kind_of, load
from faultpath_paper import central, facts
from faultpath_paper.claims import SUBJECTS
from faultpath_paper.report import words
from pictures import digest, made_from, make_images, name_of
from rendering import macros

from faultpath.report.sentences import phrases
from faultpath.report.tables import markdown_block, markdown_grid
from faultpath.run.store.signals import SIGNALS

sys.path.insert(0, str(ROOT))
from benchmarks import page, results

NAMES = {
    "block": markdown_block,
    "central": central,
    "comparison": comparison,
    "facts": facts,
    "figures_of": figures_of,
    "grid": markdown_grid,
    "load": load,
    "paper": paper_blocks,
    "measured": results,
    "performance": page,
    "phrases": phrases,
    "runs": run_blocks,
    "studies": studies,
    "subjects": SUBJECTS,
    "words": words,
}
FILTERS = {
    "load": load,
    "between": comparison.between,
    "means": comparison.means,
    "success": comparison.success,
}
"""What templates use, beside the filters of `rendering`."""
BLOCKS: Mapping[str, Callable[..., str]] = {
    **macros(NAMES, FILTERS),
    "api": api_blocks.signatures,
}
"""Functions that return the text of a block from the other words of its name, by its kind."""

PICTURES: Mapping[str, Callable[..., Picture]] = {
    "map:picture": run_blocks.map_picture_of,
    "scan:picture": run_blocks.scan_picture_of,
    "paper:picture": paper_blocks.picture,
    "film:quadrotor": film_quadrotor.film,
    "film:openpilot": film_openpilot.film,
}
"""Functions that return the picture that a block shows."""

PAGES: Sequence[Callable[[], Mapping[Path, str]]] = (
    paper_blocks.elsewhere,
    lambda: {paper_blocks.FACTS: BLOCKS["page:facts"]() + "\n"},
    schema_files.files,
)
"""Functions that return other files that follow from numbers, by their path."""

BLOCK = re.compile(
    r"^<!-- begin:(?P<name>\S+) -->\n(?P<body>.*?)^<!-- end:(?P=name) -->$",
    flags=re.MULTILINE | re.DOTALL,
)
MARKER = re.compile(r"^<!-- (?:begin|end):\S+ -->$", flags=re.MULTILINE)


def documents() -> list[Path]:
    """Return the documents that may have blocks."""
    places = ("README.md", "docs/*.md", "benchmarks/README.md", "experiments/*/README.md")
    return [path for place in places for path in sorted(ROOT.glob(place))]


def split(name: str) -> tuple[str, list[str]]:
    """Return the kind of a block, and the other words of its name; `Wrong` for an unknown kind."""
    words = name.split(":")
    for count in (1, 2):
        kind = ":".join(words[:count])
        if kind in BLOCKS or kind in PICTURES:
            return kind, words[count:]
    raise Wrong(
        f"there is no block '{words[0]}' in '{name}': use {', '.join([*BLOCKS, *PICTURES])}"
    )


def fill(name: str, document: Path) -> str:
    """Return the text of the block `name` of a document."""
    kind, words = split(name)
    text = PICTURES[kind](*words).shown if kind in PICTURES else BLOCKS[kind](*words)
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


def blocks_shown() -> list[tuple[str, list[str]]]:
    """Return kind and words of every block of all documents."""
    texts = [path.read_text("utf-8") for path in documents()]
    names = {match["name"] for text in texts for match in BLOCK.finditer(text)}
    return [split(name) for name in sorted(names)]


def photographs() -> list[tuple[str, str]]:
    """Return run and part of every picture that is taken of a report with a browser."""
    return [(words[0], words[1]) for kind, words in blocks_shown() if kind == "picture"]


def generated() -> Mapping[Path, str]:
    """Return every file that follows from numbers, by its path."""
    files = {path: filled(path.read_text("utf-8"), path) for path in documents()}
    drawn = (PICTURES[kind](*names) for kind, names in blocks_shown() if kind in PICTURES)
    for picture in drawn:
        files |= picture.files
    for files_of in PAGES:
        files |= files_of()
    return files


def leftover() -> list[Path]:
    """Return the pictures that no document shows."""
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    text = "".join(path.read_text("utf-8") for path in pages)
    return [path for path in sorted(IMAGES.glob("*.svg")) if f"/{path.name}" not in text]


def stale() -> Iterator[str]:
    """Yield each file, block or picture that is not up to date, in words."""
    for path, content in generated().items():
        text = path.read_text("utf-8") if path.is_file() else ""
        if text != content:
            pairs = zip(BLOCK.finditer(text), BLOCK.finditer(content), strict=False)
            names = [f"block {a['name']}" for a, b in pairs if a["body"] != b["body"]]
            yield ": ".join(filter(None, [str(path.relative_to(ROOT)), ", ".join(names)]))
    for path in leftover():
        yield f"{path.relative_to(ROOT)}: no document shows it"
    digests = made_from()
    for run, part in photographs():
        name = name_of(run, part)
        if not (IMAGES / name).is_file() or digests.get(name) != digest(run):
            yield f"docs/images/{name}: make it with --images"


def write() -> None:
    """Write what is stale, and delete pictures that no document shows."""
    for path, text in generated().items():
        if not path.is_file() or path.read_text("utf-8") != text:
            path.write_text(text, "utf-8")
    for path in leftover():
        path.unlink()


def take(argument: str) -> None:
    """Make a run folder a reference run, from `NAME=FOLDER`."""
    name, separator, folder = argument.partition("=")
    if not separator or not name:
        raise Wrong(f"--take {argument}: give NAME=FOLDER of a finished run")
    source = Path(folder)
    if name == "paper":
        paper_blocks.take(source)
        return
    signals = (SIGNALS,) if (source / SIGNALS).is_file() else ()
    copied((*RUNS[kind_of(source)][1], *signals), source, REFERENCE / name)
    load.cache_clear()
    if load(name).provenance.code.dirty:
        print(f"{name} was made with uncommitted changes, and the documents will say so.")


def main(arguments: Sequence[str] | None = None) -> int:
    """Carry out the command line; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="exit 1 when something is stale")
    parser.add_argument("--images", action="store_true", help="make the pictures too")
    parser.add_argument("--conclude", action="store_true", help="decide stored runs anew first")
    parser.add_argument("--take", action="append", default=[], metavar="NAME=RUN_FOLDER")
    options = parser.parse_args(arguments)
    try:
        if options.check:
            problems = list(stale())
            hint = "Run python tools/documents.py."
            print("\n".join([*problems, hint] if problems else ["Up to date."]))
            return 1 if problems else 0
        for argument in options.take:
            take(argument)
        if options.conclude:
            from conclude import conclude_all

            conclude_all(print)
            load.cache_clear()
            paper_blocks.load.cache_clear()
        write()
        if options.images:
            make_images(photographs())
    except Wrong as wrong:
        print(f"documents.py: {wrong}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
