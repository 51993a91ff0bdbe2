"""Contributing and the design notes name what is there, with the numbers of the code.

Links within the notes are checked where the site is built.
"""

import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pytest
import typer
import yaml
from faultpath_quadrotor.choices import PREDICTORS, DeviceName
from faultpath_quadrotor.models import predictor
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.perception import labels
from faultpath_quadrotor.planners import CostWeights
from faultpath_quadrotor.plant.wind import ELEVATION_DEG
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.corruption import DCC_HALF_RANGE
from faultpath_quadrotor.training.reconstruction_task import MODELS, ReconstructionTask
from faultpath_quadrotor.training.windows import COUNTS
from faultpath_quadrotor.vehicle import VehicleParameters

import faultpath
from faultpath.analyses.map.lattice import COARSE, UNITS
from faultpath.cli.app import build
from faultpath.learning.model_card import Schedule
from faultpath.stats import betting

ROOT = Path(__file__).resolve().parents[2]
DESIGN = ROOT / "docs" / "design"
PAGES = {path.stem: path for path in (ROOT / "CONTRIBUTING.md", *sorted(DESIGN.glob("*.md")))}
PROJECT: Any = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
SOURCES = ("src", "quadrotor/src", "paper/src", "tools", "tests", "examples", "benchmarks")
BASES = ("", "src", "src/faultpath", "quadrotor/src/faultpath_quadrotor", "paper/src")
"""Folders that a path may start from, beside that of its page."""
OF_OTHERS = {"eta_R", "eta_P", "theta", "path/to/file.py:factory", "-march=native", "-ffast-math"}
"""Symbols of the paper, a name of a user's file, and options of compilers."""

SPAN = re.compile(r"`([^`\n]+)`")
FENCED = re.compile(r"^```.*?^```$|^ {4,}(?=\S)[^\n]*$", re.M | re.S)
WORD = re.compile(r"\b[A-Za-z_]\w\w+")
PATH = re.compile(r"[\w.-]*/[\w./-]*|[\w-]+\.(?:py|md|toml|txt|j2|json|yaml)")
PROGRAM = re.compile(r"(?:\.?[\w./-]*/)?(?:make|faultpath|python|pytest|pre-commit)\b(?= )|--")
NAMES = ["zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"]
VALUES = {word: number for number, word in enumerate([*NAMES, "eleven", "twelve"])} | {"twenty": 20}
NUMBER = rf"(\d[\d,]*(?:\.\d+)?|\b(?:{'|'.join(VALUES)})\b)"


def mistakes(page: str, folder: Path = ROOT) -> Iterator[str]:
    """Yield what a page names that is not there."""
    text = re.sub(r"^<!-- begin:(\S+) -->.*?^<!-- end:\1 -->$", "", page, flags=re.M | re.S)
    spans = SPAN.findall(FENCED.sub("", text))
    lines = [line.strip() for block in FENCED.findall(text) for line in block.splitlines()]
    for command in filter(PROGRAM.match, (*lines, *spans)):
        yield from mistakes_of_command(command)
    for span in spans:
        if span in OF_OTHERS or PROGRAM.match(span):
            continue
        if not PATH.fullmatch(span):
            yield from (word for word in WORD.findall(span) if word not in words())
        elif not any((base / span).exists() for base in (folder, *map(ROOT.joinpath, BASES))):
            yield span


def mistakes_of_command(line: str) -> Iterator[str]:
    """Yield the targets, verbs, flags and files of a command that do not exist."""
    makefile = (ROOT / "Makefile").read_text("utf-8")
    for target in re.findall(r"\bmake ([a-z-]+)", line):
        if not re.search(rf"^{target}\b.*:", makefile, re.M):
            yield f"make {target}"
    flags = re.findall(r"(?<![\w-])--[a-z][a-z-]*", line)
    verbs = re.findall(r"\bfaultpath ([a-z]+)", line)
    yield from (name for name in (*flags, *verbs) if name not in options())
    for path in re.findall(r"(?<=[ =])(?:tests|tools|docs|examples)/[\w./-]*", line):
        if not (ROOT / path).exists():
            yield path


@cache
def options() -> set[str]:
    """Return the verbs and flags of the command, of the quadrotor, the tools and the tests."""
    known = {"--ignore"}  # of pytest
    for line in ((), ("audit", "quadrotor", "--help")):
        commands: dict[str, Any] = vars(typer.main.get_command(build(line)))["commands"]
        known |= {*commands}
        known |= {name for command in commands.values() for p in command.params for name in p.opts}
    own = [*(ROOT / "tools").glob("*.py"), ROOT / "tests" / "conftest.py"]
    return known.union(*(re.findall(r'"(--[a-z-]+)"', path.read_text("utf-8")) for path in own))


@cache
def words() -> set[str]:
    """Return the words of the project's code, without the tests of pages."""
    files = [path for source in SOURCES for path in (ROOT / source).rglob("*.py")]
    files = [path for path in files if path.parent != Path(__file__).parent]
    files += [ROOT / name for name in ("pyproject.toml", "quadrotor/pyproject.toml", "Makefile")]
    texts = (f"{path.stem} {path.parent.name} {path.read_text('utf-8')}" for path in files)
    return {word for text in texts for word in WORD.findall(text)}


STORED = yaml.safe_load(Path(__file__).with_name("numbers.yaml").read_text("utf-8"))
NUMBERS = [(page, text, of) for page, places in STORED.items() for text, of in places.items()]


def thousands(name: str) -> int:
    network: Any = predictor(name, None)
    return sum(part.numel() for part in network.network.parameters()) // 1000


def block(device: str) -> int:
    return Quadrotor(QuadrotorOptions(device=DeviceName(device))).block_size


def computed() -> Iterator[tuple[str, str, Any]]:
    """Yield pages, words around numbers, and numbers that are no constants of the code."""
    weak = {"mass_kg": 1 + PLATFORM.ranges.mass, "thrust_scale": 1 - PLATFORM.ranges.thrust_scale}
    weakest = VehicleParameters().model_copy(update=weak).thrust_to_weight
    distributions = len([*ROOT.glob("pyproject.toml"), *ROOT.glob("*/pyproject.toml")])
    fitted = ReconstructionTask("gru", 0, Path()).schedule
    yield "CONTRIBUTING", "# distributions in one", distributions
    yield "CONTRIBUTING", "Python # or newer", float(PROJECT["project"]["requires-python"][2:])
    yield "architecture", "# distributions - **", distributions
    yield "analyses", "starts with # by #", (2 * UNITS // COARSE + 1,) * 2
    yield "api", "# stand at the top", len(faultpath.__all__)
    yield "device", "Blocks hold # scenes instead of #", (block("cuda"), block("cpu"))
    yield "learning", "weights by #", Schedule().weight_decay
    yield "perception", "truncated to [-#, #] m", (-labels.LOWEST_M, labels.HIGHEST_M)
    yield "plant", "thrust-to-weight #.", round(VehicleParameters().thrust_to_weight, 2)
    yield "plant", "ranges has #,", round(weakest, 2)
    yield "plant", "within +-# degrees", ELEVATION_DEG
    yield "predictors", "# kinds behind", len({type(predictor(name, None)) for name in PREDICTORS})
    yield "predictors", "paper's #k and #k", (thousands("wm-a"), thousands("wm-u"))
    yield "reconstruction", "The # windows of the wind", COUNTS["wind"]
    yield "reconstruction", "batch #, # epochs", (fitted.batch_size, fitted.epochs)
    yield "reconstruction", "noise of # %", 100 * DCC_HALF_RANGE
    yield "statistics", "mean over # shares", len(betting._SHARES)


def text_of(page: str) -> str:
    return " ".join(PAGES[page].read_text("utf-8").split())


def value(number: str) -> float:
    return VALUES[number.lower()] if number.lower() in VALUES else float(number.replace(",", ""))


@pytest.mark.parametrize("page", PAGES)
def test_a_page_names_only_what_is_there(page: str) -> None:
    assert list(mistakes(PAGES[page].read_text("utf-8"), PAGES[page].parent)) == []


def differing(page: str, text: str, code: Any) -> str:
    """Return how a page differs from the code where it has such words; empty where it does not."""
    pattern = NUMBER.join(map(re.escape, text.split("#")))
    places = list(re.finditer(pattern, text_of(page), re.I))
    shown = [value(group) for place in places for group in place.groups()]
    code = [*code] if isinstance(code, tuple) else [code]
    return "" if shown == pytest.approx(code) else f"{page}, '{text}': {shown}, not {code}"


def test_numbers_on_pages_are_those_of_the_code() -> None:
    stored = ((page, text, resolve_name(of)) for page, text, of in NUMBERS)
    assert [wrong for each in (*stored, *computed()) if (wrong := differing(*each))] == []
    assert differing("api", "# stand at the top", 1) != ""


@pytest.mark.parametrize(
    ("sentence", "mistake"),
    [
        ("Look into `faults/nowhere.py`.", "faults/nowhere.py"),
        ("It is a `NoSuchClass`.", "NoSuchClass"),
        ("Call `System.no_such_member()`.", "no_such_member"),
        ("Run `make nothing`.", "make nothing"),
        ("Run `faultpath nothing --json`.", "nothing"),
        ("Give `--no-such-flag 1`.", "--no-such-flag"),
        ("Run:\n\n    make test ARGS=tests/nothing\n", "tests/nothing"),
        ("Run:\n\n```console\nfaultpath audit --nothing\n```\n", "--nothing"),
    ],
)
def test_what_is_not_there_is_reported(sentence: str, mistake: str) -> None:
    assert list(mistakes(sentence)) == [mistake]


def first_column(page: str, heading: str) -> list[str]:
    """Return the first cells of the table under a heading row that begins with a word."""
    rows = rf"^\| {heading} .*\n\|[-:| ]+\n((?:\|.*\n)+)"
    (table,) = re.findall(rows, PAGES[page].read_text("utf-8"), re.M)
    return [line.split("|")[1].strip(" `") for line in table.splitlines()]


def test_tables_have_a_line_for_each() -> None:
    contracts = PROJECT["tool"]["importlinter"]["contracts"]
    layers = [name for layer in contracts[0]["layers"] for name in layer.split(" | ")]
    assert first_column("CONTRIBUTING", "room of the engine") == layers
    assert first_column("reconstruction", "model") == list(MODELS)
    costs = CostWeights.model_fields.keys() - {"margin_m", "v_max_mps"}
    assert len(first_column("platform", "term")) == len(costs)
    listed = re.findall(r"\]\((\w+)\.md\)", PAGES["README"].read_text("utf-8"))
    assert {*listed} == {path.stem for path in DESIGN.glob("*.md")} - {"README"}
