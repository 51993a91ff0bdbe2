"""Measure the trained models on validation windows, and write the page about them.

    python tools/learning_quality.py measure --data data   measure, into docs/reference
    python tools/learning_quality.py write                 fill the page and draw its pictures
    python tools/learning_quality.py check                 exit 1 when page or picture is stale

A block stands between `<!-- begin learning:NAME -->` and `<!-- end learning:NAME -->`. The word
`learning` keeps it apart from the blocks that `readme.py` fills, which say `begin:KIND`.
"""

import argparse
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import torch
from learning_blocks import ABSENT, BLOCKS
from learning_figures import PICTURES
from pydantic import ValidationError

from faultpath.errors import UserError
from faultpath.quadrotor.training.quality import measure
from faultpath.quadrotor.training.quality_results import Quality
from faultpath.store import atomic

DOCS = Path(__file__).resolve().parents[1] / "docs"
BLOCK = re.compile(
    r"^<!-- begin learning:(?P<name>\S+) -->\n(?P<body>.*?)^<!-- end learning:(?P=name) -->$",
    flags=re.MULTILINE | re.DOTALL,
)
MARKER = re.compile(r"^<!-- (?:begin|end) learning:\S+ -->$", flags=re.MULTILINE)
PICTURE = "picture-"


def result_path(docs: Path) -> Path:
    """Return where the measurement stands."""
    return docs / "reference" / "learning-quality.json"


def read(docs: Path) -> Quality:
    """Return the measurement; `UserError` when there is none or it is of another version."""
    path = result_path(docs)
    try:
        return Quality.model_validate_json(path.read_bytes())
    except (OSError, ValidationError):
        raise UserError(
            f"{path} is missing or of another version: run `learning_quality.py measure`."
        ) from None


def expected(docs: Path) -> dict[Path, str]:
    """Return the contents of the page and of every picture that can be drawn."""
    quality = read(docs)
    page = docs / "learning-quality.md"
    drawn = {name: draw(quality) for name, (_, draw) in PICTURES.items()}
    pictures = {
        docs / "images" / f"learning-{name}.svg": f"{markup}\n"
        for name, markup in drawn.items()
        if markup is not None
    }
    return {page: _filled(page.read_text("utf-8"), quality, set(pictures)), **pictures}


def stale(docs: Path) -> Iterator[str]:
    """Yield what is not as the measurement gives it."""
    wanted = expected(docs)
    for path, text in wanted.items():
        if not path.is_file() or path.read_text("utf-8") != text:
            yield str(path.relative_to(docs.parent))
    for path in _leftover(docs, wanted):
        yield f"{path.relative_to(docs.parent)}: nothing was measured for it"


def write(docs: Path) -> None:
    """Fill the page and draw the pictures; pictures of nothing measured go."""
    wanted = expected(docs)
    (docs / "images").mkdir(exist_ok=True)
    for path, text in wanted.items():
        atomic.write(path, text.encode())
    for path in _leftover(docs, wanted):
        path.unlink()


def main(arguments: Sequence[str] | None = None, docs: Path = DOCS) -> int:
    """Do what was asked; return the exit status."""
    asked = _parser().parse_args(arguments)
    try:
        if asked.verb == "measure":
            torch.set_num_threads(1)
            quality = measure(asked.data, asked.checkpoints, lambda text: print(text, flush=True))
            atomic.write(result_path(docs), quality.encode())
            print(f"Missing: {', '.join(quality.missing) or 'nothing'}.")
        elif asked.verb == "write":
            write(docs)
        else:
            found = list(stale(docs))
            hint = "Run python tools/learning_quality.py write."
            print("\n".join([*found, hint] if found else ["Up to date."]))
            return 1 if found else 0
    except UserError as error:
        print(f"learning_quality.py: {error}", file=sys.stderr)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    verbs = parser.add_subparsers(dest="verb", required=True)
    measured = verbs.add_parser("measure", help="measure the checkpoints on validation windows")
    measured.add_argument("--data", type=Path, default=Path("data"), help="folder of the pools")
    measured.add_argument("--checkpoints", type=Path, help="folder; by default the package's")
    verbs.add_parser("write", help="fill the page and draw its pictures")
    verbs.add_parser("check", help="exit 1 when page or picture is stale")
    return parser


def _filled(text: str, quality: Quality, pictures: set[Path]) -> str:
    """Return the page with every block filled; `UserError` for a marker that has no partner."""
    if len(MARKER.findall(text)) != 2 * len(BLOCK.findall(text)):
        raise UserError("learning-quality.md: a begin or end of a block stands alone; pair it.")
    there = {path.name for path in pictures}

    def replace(match: re.Match[str]) -> str:
        name = match["name"]
        body = _body(name, quality, there)
        return f"<!-- begin learning:{name} -->\n{body}\n<!-- end learning:{name} -->"

    return BLOCK.sub(replace, text)


def _body(name: str, quality: Quality, pictures: set[str]) -> str:
    if name in BLOCKS:
        return BLOCKS[name](quality)
    picture = name.removeprefix(PICTURE)
    if picture not in PICTURES or picture == name:
        known = ", ".join([*BLOCKS, *(PICTURE + each for each in PICTURES)])
        raise UserError(f"learning-quality.md: there is no block '{name}'; choose from {known}.")
    file = f"learning-{picture}.svg"
    return f"![{PICTURES[picture][0]}](images/{file})" if file in pictures else ABSENT


def _leftover(docs: Path, wanted: dict[Path, str]) -> list[Path]:
    return sorted(set((docs / "images").glob("learning-*.svg")) - set(wanted))


if __name__ == "__main__":
    sys.exit(main())
