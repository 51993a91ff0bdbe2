"""Contributing and the design notes name what is there, with the numbers of the code."""

import re
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pytest
from faultpath_quadrotor.choices import PREDICTORS, DeviceName
from faultpath_quadrotor.models import predictor
from faultpath_quadrotor.options import QuadrotorOptions
from faultpath_quadrotor.perception import labels
from faultpath_quadrotor.planners import CostWeights
from faultpath_quadrotor.platform import PLATFORM
from faultpath_quadrotor.system import Quadrotor
from faultpath_quadrotor.training.corruption import DCC_HALF_RANGE
from faultpath_quadrotor.training.reconstruction_task import MODELS, ReconstructionTask
from faultpath_quadrotor.training.windows import COUNTS
from faultpath_quadrotor.vehicle import VehicleParameters
from project_names import EXEMPT, ROOT, mistakes
from test_files import MAX_LINES

import faultpath
from faultpath.analyses.map.lattice import COARSE, UNITS
from faultpath.learning.model_card import Schedule

DESIGN = ROOT / "docs" / "design"
PAGES = {path.stem: path for path in (ROOT / "CONTRIBUTING.md", *sorted(DESIGN.glob("*.md")))}
PROJECT: Any = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))

SMALL = ["zero", "one", "two", "three", "four", "five", "six"]
WORDS = [*SMALL, "seven", "eight", "nine", "ten", "eleven", "twelve"]
VALUES = {word: number for number, word in enumerate(WORDS)} | {"twenty": 20}
NUMBER = rf"(\d[\d,]*(?:\.\d+)?|\b(?:{'|'.join(VALUES)})\b)"
THINGS = "names|modules|rooms|distributions|predictors|kinds|verbs|commands|libraries|lines|models"
COUNTED = re.compile(rf"\b(?:\d+|{'|'.join(WORDS[3:])})(?: [a-z]+)? (?:{THINGS})\b", re.I)


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
    (
        "predictors",
        "# kinds behind",
        lambda: len({type(predictor(name, None)) for name in PREDICTORS}),
    ),
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


def matches(words: str, text: str) -> list[re.Match[str]]:
    pattern = NUMBER.join(map(re.escape, words.split("#")))
    return list(re.finditer(pattern, text, re.I))


def value(number: str) -> float:
    return VALUES[number.lower()] if number.lower() in VALUES else float(number.replace(",", ""))


def other_numbers(words: str, number: Number, text: str) -> str:
    """Say how a text differs from the code where it has `words`; empty where it does not."""
    places = matches(words, text)
    if len(places) != 1:
        return f"'{words}' is {len(places)} times on the page"
    code = resolve_name(number) if isinstance(number, str) else number()
    code = code if isinstance(code, tuple) else (code,)
    shown = tuple(value(group) for group in places[0].groups())
    return "" if shown == pytest.approx(code) else f"{shown} on the page, {code} in the code"


def uncompared(page: str, text: str) -> Iterator[str]:
    """Yield counts of the project's things that no line of `NUMBERS` compares."""
    compared = [
        match.span() for of, words, _ in NUMBERS if of == page for match in matches(words, text)
    ]
    for count in COUNTED.finditer(text):
        if not any(start <= count.start() < end for start, end in compared):
            yield count[0]


@pytest.mark.parametrize("page", PAGES)
def test_a_page_names_only_what_is_there(page: str) -> None:
    assert list(mistakes(PAGES[page].read_text("utf-8"), PAGES[page].parent)) == []
    assert list(uncompared(page, text_of(page))) == []


def test_each_exemption_is_needed() -> None:
    pages = "".join(path.read_text("utf-8") for path in PAGES.values())
    assert [span for span in EXEMPT if f"`{span}`" not in pages] == []
    assert [span for span in EXEMPT if not list(mistakes(f"`{span}`", exempt=()))] == []


@pytest.mark.parametrize(("page", "words", "number"), NUMBERS)
def test_a_number_on_a_page_is_that_of_the_code(page: str, words: str, number: Number) -> None:
    assert other_numbers(words, number, text_of(page)) == ""


@pytest.mark.parametrize(
    ("sentence", "mistake"),
    [
        ("See [there](docs/nowhere.md).", "a link to docs/nowhere.md"),
        ("See [there](CONTRIBUTING.md#no-such-part).", "a link to CONTRIBUTING.md#no-such-part"),
        ("Look into `faults/nowhere.py`.", "the path faults/nowhere.py"),
        ("Look into `nowhere.py`.", "the path nowhere.py"),
        ("It is a `NoSuchClass`.", "the name NoSuchClass"),
        ("Call `no_such_function()`.", "the name no_such_function()"),
        ("Call `System.no_such_member()`.", "the name System.no_such_member()"),
        ("Call `faultpath.api.no_such_name`.", "the name faultpath.api.no_such_name"),
        ("Fly `gru+nothing`.", "the value gru+nothing"),
        ("It is `scale * no_such_value`.", "no_such_value in scale * no_such_value"),
        ("Run `make nothing`.", "make nothing"),
        ("Run `faultpath nothing --json`.", "faultpath nothing"),
        ("Give `--no-such-flag 1`.", "the flag --no-such-flag"),
        ("Give `--device no-such`.", "the value no-such"),
        ("    indented\n\nA `NoSuchClass`.", "the name NoSuchClass"),
        ("Run:\n\n    make test ARGS=tests/nothing\n", "the path tests/nothing"),
        ("Run:\n\n```console\nfaultpath audit --nothing\n```\n", "the flag --nothing"),
    ],
)
def test_what_is_not_there_is_reported(sentence: str, mistake: str) -> None:
    assert list(mistakes(sentence)) == [mistake]


def test_a_wrong_number_is_reported() -> None:
    words, names = "# stand at the top", lambda: 12
    assert other_numbers(words, names, "Twelve stand at the top.") == ""
    assert other_numbers(words, names, "12 stand at the top.") == ""
    assert "(11,) on the page" in other_numbers(words, names, "Eleven stand at the top.")
    assert "0 times" in other_numbers(words, names, "Many stand at the top.")
    assert list(uncompared("api", "Twelve stand at the top, in 14 public modules.")) == [
        "14 public modules"
    ]


def first_column(page: str, heading: str) -> list[str]:
    """Return the first cells of the table under a heading row that begins with a word."""
    table = re.search(
        rf"^\| {heading} .*\n\|[-:| ]+\n((?:\|.*\n)+)", PAGES[page].read_text("utf-8"), re.M
    )
    assert table is not None
    return [line.split("|")[1].strip(" `") for line in table[1].splitlines()]


def test_tables_have_a_line_for_each() -> None:
    contracts = PROJECT["tool"]["importlinter"]["contracts"]
    layers = [name for layer in contracts[0]["layers"] for name in layer.split(" | ")]
    assert first_column("CONTRIBUTING", "room of the engine") == layers
    assert first_column("reconstruction", "model") == list(MODELS)
    costs = [name for name in CostWeights.model_fields if name not in ("margin_m", "v_max_mps")]
    assert len(first_column("platform", "term")) == len(costs)
    listed = re.findall(r"\]\((\w+)\.md\)", PAGES["README"].read_text("utf-8"))
    assert sorted(listed) == sorted(
        path.stem for path in DESIGN.glob("*.md") if path.stem != "README"
    )


def test_the_platform_is_the_one_that_flies() -> None:
    assert f"`{PLATFORM.hash}`" in text_of("platform")
