"""Contributing and the design notes name what is there, with the numbers of the code.

Links within the notes are checked where the site is built.
"""

import re
import tomllib
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pytest
import typer
from faultpath_quadrotor.choices import DeviceName
from faultpath_quadrotor.models import PREDICTORS, predictor
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.perception import labels
from faultpath_quadrotor.planners import CostWeights
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.corruption import DCC_HALF_RANGE
from faultpath_quadrotor.training.reconstruction_task import MODELS, ReconstructionTask
from faultpath_quadrotor.training.windows import COUNTS
from faultpath_quadrotor.vehicle import VehicleParameters
from test_files import MAX_LINES

import faultpath
from faultpath.analyses.map.lattice import COARSE, UNITS
from faultpath.cli.app import build
from faultpath.learning.model_card import Schedule

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


def distributions() -> int:
    return len([*ROOT.glob("pyproject.toml"), *ROOT.glob("*/pyproject.toml")])


def lightest() -> float:
    """Return thrust over weight of the weakest vehicle within the ranges."""
    ranges = PLATFORM.ranges
    weak = {"mass_kg": 1 + ranges.mass, "thrust_scale": 1 - ranges.thrust_scale}
    return round(VehicleParameters().model_copy(update=weak).thrust_to_weight, 2)


def thousands(name: str) -> int:
    network: Any = predictor(name, None)
    return sum(part.numel() for part in network.network.parameters()) // 1000


def block(device: str) -> int:
    return Quadrotor(QuadrotorOptions(device=DeviceName(device))).block_size


def gru() -> tuple[float, ...]:
    schedule = ReconstructionTask("gru", 0, Path()).schedule
    return schedule.batch_size, schedule.epochs


def bets() -> int:
    return len(resolve_name("faultpath.stats.betting:_SHARES"))


Number = str | Callable[[], Any]
NUMBERS: list[tuple[str, str, Number]] = [
    ("CONTRIBUTING", "a test fails at # lines", lambda: MAX_LINES),
    ("CONTRIBUTING", "# distributions in one", distributions),
    ("CONTRIBUTING", "Python # or newer", lambda: float(PROJECT["project"]["requires-python"][2:])),
    ("architecture", "# distributions - **", distributions),
    ("analyses", "multiples of 1/#", "faultpath.analyses.map.lattice:UNITS"),
    ("analyses", "starts with # by #", lambda: (2 * UNITS // COARSE + 1,) * 2),
    ("analyses", "# joint resamples", "faultpath.analyses.map.surface:RESAMPLES"),
    ("api", "# stand at the top", lambda: len(faultpath.__all__)),
    ("claims", "estimate of at least # scenes;", "faultpath_paper.claims.rules:POINT_SCENES"),
    ("claims", "estimate of at least # scenes meets", "faultpath_paper.claims.rules:POINT_SCENES"),
    ("claims", "fewer than # give no answer", "faultpath_paper.claims.rules:POINT_SCENES"),
    ("claims", "or fewer than # scenes |", "faultpath_paper.claims.rules:POINT_SCENES"),
    ("claims", "Fewer than # give no interval", "faultpath.stats.contrast:MIN_SCENES"),
    ("claims", "above # pp", "faultpath_paper.quantities.differences:TELLING_PP"),
    ("claims", "less than # % success", "faultpath_paper.quantities.summaries:PEAK_PERCENT"),
    ("claims", "# predictors in free space", "faultpath_paper.claims.statement:ALL_SEEDS"),
    ("conventions", "a multiple of #;", "faultpath_quadrotor.state:LANE_MULTIPLE"),
    ("conventions", "planner's # candidates", lambda: PLATFORM.planner.sampler.candidates),
    ("conventions", "gravity # m/s", "faultpath_quadrotor.vehicle:GRAVITY_MPS2"),
    ("device", "checked every # steps", "faultpath_quadrotor.plant.module:LOOK_EVERY"),
    ("device", "Blocks hold # scenes instead of #", lambda: (block("cuda"), block("cpu"))),
    ("execution", ": # scenes of one unit", "faultpath.run.execution.recheck:SAMPLE"),
    ("execution", "the first # trials", "faultpath.run.execution.state:FEW"),
    ("kernels", "rolls # candidates", lambda: PLATFORM.planner.sampler.candidates),
    ("kernels", "more than # hidden units", "faultpath_quadrotor.predictors.compiled:MOST_HIDDEN"),
    ("learning", "weights by #", lambda: Schedule().weight_decay),
    ("perception", "range (# m)", "faultpath_quadrotor.perception.camera:RANGE_M"),
    ("perception", "; # x 36", "faultpath_quadrotor.perception.camera:WIDTH"),
    ("perception", "64 x # pixels", "faultpath_quadrotor.perception.camera:HEIGHT"),
    ("perception", "truncated to [-#, #] m", lambda: (-labels.LOWEST_M, labels.HIGHEST_M)),
    ("perception", "# candidates of 20", lambda: PLATFORM.planner.sampler.candidates),
    ("perception", "of # steps are evaluated", lambda: PLATFORM.planner.sampler.horizon),
    ("perception", "a code of # numbers", "faultpath_quadrotor.perception.clearance:CODE"),
    ("perception", "fixed groups of #", "faultpath_quadrotor.perception.clearance:_GROUP"),
    ("plant", "# kg, ", "faultpath_quadrotor.vehicle:NOMINAL_MASS_KG"),
    ("plant", "# m arms", "faultpath_quadrotor.vehicle:ARM_LENGTH_M"),
    ("plant", "# N a motor", "faultpath_quadrotor.vehicle:MOTOR_THRUST_MAX_N"),
    ("plant", "thrust-to-weight #.", lambda: round(VehicleParameters().thrust_to_weight, 2)),
    ("plant", "ranges has #,", lightest),
    ("plant", "draws below #", "faultpath_quadrotor.vehicle:MIN_THRUST_TO_WEIGHT"),
    ("plant", "`hypot(mean, # m/s)`", "faultpath_quadrotor.plant.wind:CRUISE_MPS"),
    ("plant", "within +-# degrees", lambda: PLATFORM.winds.levels["L3"].elevation_deg),
    ("plant", "has # error states", "faultpath_quadrotor.estimators.kalman:SIZE"),
    ("platform", "a length scale of # m", lambda: PLATFORM.winds.length_m),
    ("predictors", "# kinds behind", lambda: len({type(m.build()) for m in PREDICTORS.values()})),
    ("predictors", "embedding of #", "faultpath_quadrotor.predictors.network:ACTION_EMBEDDING"),
    ("predictors", "paper's #k and #k", lambda: (thousands("wm-a"), thousands("wm-u"))),
    (
        "predictors",
        "linear bound of # m",
        "faultpath_quadrotor.predictors.anchored:LINEAR_BOUND_MPS2",
    ),
    ("predictors", "last # intervals", "faultpath_quadrotor.predictors.history:STEPS"),
    ("reconstruction", ": # completed intervals", "faultpath_quadrotor.predictors.history:STEPS"),
    ("reconstruction", "The # windows of the wind", lambda: COUNTS["wind"]),
    ("reconstruction", "batch #, # epochs", gru),
    ("reconstruction", "noise of # %", lambda: 100 * DCC_HALF_RANGE),
    ("scenes", "a lattice of # m", "faultpath_quadrotor.scenes.soundness:CELL_M"),
    ("scenes", "(radius # m", "faultpath_quadrotor.vehicle:COLLISION_RADIUS_M"),
    ("statistics", "mean over # shares", bets),
    ("statistics", "p at most #,", "faultpath.stats.estimate:ALPHA"),
    ("studies", "A window is # steps", "faultpath_quadrotor.predictors.history:STEPS"),
    ("studies", "at least # control steps", "faultpath_paper.evidence.recording:STRIDE"),
    ("systems", "faulted for # steps", "faultpath.run.check.check:_AFTER"),
    ("systems", "matters # times as much", "faultpath.run.check.judging:_SEVERAL"),
    ("verdict", "succeed below # %", "faultpath.analyses.effects:FLOOR_PERCENT"),
    ("verdict", "or above # %, the", "faultpath.analyses.effects:CEILING_PERCENT"),
]
"""Page, words around a number (`#`), and the constant or function that gives it."""


def text_of(page: str) -> str:
    return " ".join(PAGES[page].read_text("utf-8").split())


def value(number: str) -> float:
    return VALUES[number.lower()] if number.lower() in VALUES else float(number.replace(",", ""))


@pytest.mark.parametrize("page", PAGES)
def test_a_page_names_only_what_is_there(page: str) -> None:
    assert list(mistakes(PAGES[page].read_text("utf-8"), PAGES[page].parent)) == []


@pytest.mark.parametrize(("page", "text", "number"), NUMBERS)
def test_a_number_on_a_page_is_that_of_the_code(page: str, text: str, number: Number) -> None:
    pattern = NUMBER.join(map(re.escape, text.split("#")))
    (place,) = re.finditer(pattern, text_of(page), re.I)
    code = resolve_name(number) if isinstance(number, str) else number()
    code = code if isinstance(code, tuple) else (code,)
    assert tuple(map(value, place.groups())) == pytest.approx(code)


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
