"""Fill the marked blocks of README and docs from reference runs, so that no number is typed.

    python tools/readme.py                          fill the blocks in
    python tools/readme.py --check                  exit 1 when a block or a picture is stale
    python tools/readme.py --take NAME=RUN_FOLDER   make a run folder the reference run NAME first
    python tools/readme.py --paper RUN_FOLDER       ship a run of the whole paper first
    python tools/readme.py --conclude               decide all reference runs anew first
    python tools/readme.py --images                 make the pictures too, with Chromium

A block stands between `<!-- begin:KIND:ARGUMENT -->` and `<!-- end:KIND:ARGUMENT -->`, each on a
line of its own; `FILLERS` in `blocks.py` lists the kinds. `docs/reference/README.md` says what a
reference run is.
"""

import argparse
import os
import re
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from blocks import FILLERS, REFERENCE, ROOT, Wrong, code, load, missing, times
from paper_blocks import load as load_paper
from paper_blocks import paper
from paper_blocks import take as take_paper
from pictures import IMAGES, digest, made_from, make_images

from faultpath.cli.pages import MADE_FROM

TAKEN = (*MADE_FROM, "provenance.json", "report.html", "table.md", "table.tex")
"""All that `faultpath report` reads of a run folder and writes there."""

BLOCK = re.compile(
    r"^<!-- begin:(?P<name>\S+) -->\n(?P<body>.*?)^<!-- end:(?P=name) -->$",
    flags=re.MULTILINE | re.DOTALL,
)
MARKER = re.compile(r"^<!-- (?:begin|end):\S+ -->$", flags=re.MULTILINE)


def documents() -> list[Path]:
    """Return the documents that may have blocks."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def fill(name: str, document: Path) -> str:
    """Return what belongs into the block `name` of a document."""
    kind, *arguments = name.split(":")
    if kind == "code":
        text = code(*arguments)
    elif kind == "paper":
        text = paper(*arguments)
    elif kind == "times":
        text = times(arguments)
    elif kind in FILLERS:
        run = load(arguments[0])
        text = FILLERS[kind](run, *arguments[1:]) if run else ""
        if run is None and kind == "table":  # once is enough
            text = missing(arguments[0])
    else:
        kinds = ", ".join((*FILLERS, "paper", "times"))
        raise Wrong(f"there is no kind of block '{kind}': use {kinds} or code")
    for word, folder in (("{images}", IMAGES), ("{reference}", REFERENCE)):
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


def stale() -> Iterator[str]:
    """Yield what is not up to date, in words."""
    for document in documents():
        text = document.read_text("utf-8")
        wanted = filled(text, document)
        blocks = zip(BLOCK.finditer(text), BLOCK.finditer(wanted), strict=True)
        for now, then in blocks:
            if now["body"] != then["body"]:
                yield f"{document.relative_to(ROOT)}: block {now['name']}"
    made = made_from()
    for run, part in pictures():
        name = f"{run}-{part}.png"
        if not (IMAGES / name).is_file() or made.get(name) != digest(run):
            yield f"docs/images/{name}: make it with --images"


def pictures() -> list[tuple[str, str]]:
    """Return the run and part of every picture that documents show and that a run is there for."""
    texts = [path.read_text("utf-8") for path in documents()]
    names = [m["name"].split(":") for text in texts for m in BLOCK.finditer(text)]
    runs = {(name[1], name[2]) for name in names if name[0] == "picture" and load(name[1])}
    drawn = {("paper", name[2]) for name in names if name[:2] == ["paper", "picture"]}
    return sorted(runs | (drawn if load_paper() else set()))


def take(what: str) -> None:
    """Make a run folder a reference run, from `NAME=FOLDER`."""
    name, separator, folder = what.partition("=")
    absent = [file for file in TAKEN if not (Path(folder) / file).is_file()]
    if not separator or not name or absent:
        raise Wrong(f"--take {what}: give NAME=FOLDER of a finished run, with {', '.join(TAKEN)}")
    target = REFERENCE / name
    target.mkdir(parents=True, exist_ok=True)
    for file in TAKEN:
        shutil.copyfile(Path(folder) / file, target / file)
    run = load(name)
    if run is not None and run.provenance.dirty:
        print(f"{name} was made with uncommitted changes, and the documents will say so.")


def main() -> int:
    """Do what was asked; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="exit 1 when something is stale")
    parser.add_argument("--images", action="store_true", help="make the pictures too")
    parser.add_argument("--conclude", action="store_true", help="decide stored runs anew first")
    parser.add_argument("--paper", type=Path, metavar="RUN_FOLDER")
    parser.add_argument("--take", action="append", default=[], metavar="NAME=RUN_FOLDER")
    asked = parser.parse_args()
    try:
        if asked.check:
            found = list(stale())
            print("\n".join([*found, "Run python tools/readme.py."] if found else ["Up to date."]))
            return 1 if found else 0
        for what in asked.take:
            take(what)
        if asked.paper is not None:
            take_paper(asked.paper, REFERENCE)
        if asked.conclude:
            from conclude import conclude_all

            conclude_all(print)
            load.cache_clear()
            load_paper.cache_clear()
        for document in documents():
            document.write_text(filled(document.read_text("utf-8"), document), "utf-8")
        if asked.images:
            make_images(pictures())
    except Wrong as wrong:
        print(f"readme.py: {wrong}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
