"""Check what a page names: files, the names of the project's code, commands and flags."""

import ast
import builtins
import re
import sys
from collections.abc import Collection, Iterator
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from keyword import kwlist
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import typer

from faultpath.cli.app import build

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("src", "quadrotor/src", "paper/src", "tools", "tests", "examples", "benchmarks")
BASES = ("", "src", "src/faultpath", "quadrotor/src/faultpath_quadrotor", "paper/src")
"""Folders that a path may start from, beside that of its page."""

EXEMPT = {
    "eta_R": "symbol of the paper",
    "eta_P": "symbol of the paper",
    "theta": "symbol of the paper",
    "path/to/file.py:factory": "stands for a user's file",
    "<!-- begin:KIND:ARGUMENT -->": "stands for any block",
    "-march=native": "option of compilers",
    "-ffast-math": "option of compilers",
    "not-run": "word after the language of a block of Markdown",
    "nodejs": "extra of pyright",
    "HATCH_BUILD_HOOK_ENABLE_CUSTOM=true": "variable of hatch",
}
"""Code on the pages that is neither Python nor a command of the project, with the reason."""
OF_PYTEST = {"--ignore"}

SPAN = re.compile(r"`([^`\n]+)`")
LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCED = re.compile(r"^```.*?^```$|^ {4,}(?=\S)[^\n]*$", re.M | re.S)
WORD = re.compile(r"[A-Za-z_]\w\w+(?:\.\w+)*")
NAME = re.compile(r"[A-Za-z_]\w*(?:\.\w+)*(?:\(\))?")
VALUE = re.compile(r"[a-z]+(?:[-+][a-z]+)+")
HASH = re.compile(r"[0-9a-f]{16}")
PATH = re.compile(r"[\w.-]*/[\w./-]*|[\w-]+\.(?:py|md|toml|txt|j2|json|yaml)")
PROGRAM = re.compile(r"(?:\.?[\w./-]*/)?(?:make|faultpath|python|pytest|pre-commit)\b(?= )")


def mistakes(page: str, folder: Path = ROOT, exempt: Collection[str] = EXEMPT) -> Iterator[str]:
    """Yield what a page names that is not there, in words."""
    text = re.sub(r"^<!-- begin:(\S+) -->.*?^<!-- end:\1 -->$", "", page, flags=re.M | re.S)
    blocks, prose = "\n".join(FENCED.findall(text)), FENCED.sub("", text)
    for target in LINK.findall(prose):
        if not target.startswith("https://") and not leads(target, page, folder):
            yield f"a link to {target}"
    for line in blocks.splitlines():
        if PROGRAM.match(line.strip()):
            yield from mistakes_of_command(line)
    for span in SPAN.findall(prose):
        if span in exempt or HASH.fullmatch(span):
            continue
        if PROGRAM.match(span) or span.startswith("--"):
            yield from mistakes_of_command(span)
        elif PATH.fullmatch(span):
            if not any((base / span).exists() for base in (folder, *map(ROOT.joinpath, BASES))):
                yield f"the path {span}"
        elif NAME.fullmatch(span):
            if not is_defined(span):
                yield f"the name {span}"
        elif VALUE.fullmatch(span):
            if span not in strings() and not is_installed(span):
                yield f"the value {span}"
        else:
            yield from (f"{word} in {span}" for word in WORD.findall(span) if not is_used(word))


def leads(target: str, page: str, folder: Path) -> bool:
    """Return whether the file of a link exists, and the heading that it names."""
    name, _, anchor = target.partition("#")
    place = folder / name
    if not anchor:
        return place.exists()
    text = place.read_text("utf-8") if name and place.is_file() else page
    headings = re.findall(r"^#+ (.+)$", text, re.M)
    slugs = (re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings)
    return place.exists() and anchor in slugs


def mistakes_of_command(line: str) -> Iterator[str]:
    """Yield the targets, verbs, flags and files of a command that do not exist."""
    command = line.partition("  #")[0]
    for target in re.findall(r"\bmake ([a-z-]+)", line):
        if target not in targets():
            yield f"make {target}"
    for verb in re.findall(r"\bfaultpath ([a-z]+)", line):
        if verb not in verbs():
            yield f"faultpath {verb}"
    for flag in re.findall(r"(?<![\w-])--[a-z][a-z-]*", line):
        if flag not in flags():
            yield f"the flag {flag}"
    for choice in re.findall(r"(?<![\w-])--[a-z-]+[ =]([a-z][\w-]*)(?![\w/-])", command):
        if choice not in strings():
            yield f"the value {choice}"
    for path in re.findall(r"(?<=[ =])(?:tests|tools|docs|examples)/[\w./-]*", command):
        if not (ROOT / path).exists():
            yield f"the path {path}"


@cache
def targets() -> set[str]:
    return set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text("utf-8"), re.M))


@cache
def verbs() -> set[str]:
    command: Any = typer.main.get_command(build())
    return set(command.commands)


@cache
def flags() -> set[str]:
    """Return the flags of all verbs, of the quadrotor, the tools and the tests."""
    lines = ((), ("audit", "quadrotor", "--help"))
    known = {flag for line in lines for flag in _flags(typer.main.get_command(build(line)))}
    own = [*(ROOT / "tools").glob("*.py"), ROOT / "tests" / "conftest.py"]
    parsed = (node for path in own for node in ast.walk(ast.parse(path.read_text("utf-8"))))
    return known | {text for text in _strings(*parsed) if text.startswith("--")} | OF_PYTEST


def _flags(command: Any) -> Iterator[str]:
    for parameter in command.params:
        yield from parameter.opts
    for part in getattr(command, "commands", {}).values():
        yield from _flags(part)


def is_defined(name: str) -> bool:
    """Return whether a name, dotted or followed by `()`, is defined in the project or imports."""
    plain = name.removesuffix("()")
    first, _, rest = plain.partition(".")
    if not rest:
        return plain in definitions() or (plain == name and name in strings())
    if first in members():
        return rest in members()[first]
    try:
        resolve_name(plain)
    except (ImportError, AttributeError):
        return plain in strings()
    return True


def is_used(word: str) -> bool:
    """Return whether a word of a formula or of a line of code is used in the project's code."""
    return is_defined(word) or word in uses()


def is_installed(name: str) -> bool:
    """Return whether a distribution of this name is installed."""
    try:
        return bool(distribution(name))
    except PackageNotFoundError:
        return False


@cache
def definitions() -> set[str]:
    files = {name for path in python_files() for name in (path.stem, path.parent.name)}
    language = {*dir(builtins), *kwlist, *sys.stdlib_module_names}
    return files | language | {name for node in nodes() for name in defined_by(node)}


@cache
def members() -> dict[str, set[str]]:
    """Return what each class defines, by its name."""
    members: dict[str, set[str]] = {}
    for node in nodes():
        if isinstance(node, ast.ClassDef):
            inside = {name for part in node.body for name in defined_by(part)}
            members.setdefault(node.name, set()).update(inside)
    return members


@cache
def strings() -> set[str]:
    return set(_strings(*nodes()))


@cache
def uses() -> set[str]:
    names = {node.id for node in nodes() if isinstance(node, ast.Name)}
    return names | {node.attr for node in nodes() if isinstance(node, ast.Attribute)}


@cache
def python_files() -> tuple[Path, ...]:
    """Return the project's code, without the tests of pages, which hold wrong names."""
    files = (path for source in SOURCES for path in sorted((ROOT / source).rglob("*.py")))
    return tuple(path for path in files if path.parent != Path(__file__).parent)


@cache
def nodes() -> tuple[ast.AST, ...]:
    trees = (ast.parse(path.read_text("utf-8")) for path in python_files())
    return tuple(node for tree in trees for node in ast.walk(tree))


def defined_by(node: ast.AST) -> tuple[str, ...]:
    """Return the names that a node gives to something."""
    match node:
        case ast.FunctionDef(name=name) | ast.ClassDef(name=name) | ast.arg(arg=name):
            return (name,)
        case ast.Name(id=name, ctx=ast.Store()) | ast.AnnAssign(target=ast.Name(id=name)):
            return (name,)
        case ast.alias(name=name, asname=other):
            return (other or name.rpartition(".")[2],)
        case _:
            return ()


def _strings(*nodes: ast.AST) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
