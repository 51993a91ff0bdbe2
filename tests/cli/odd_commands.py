"""Commands whose files, folders and numbers are odd, by what they are asked of.

Each case puts its files into an empty folder and returns the line; `bases` makes what they alter.
"""

import json
import shutil
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import yaml
from cli_runs import ROOT, TOY, faultpath
from odd_inputs import (
    VALUES,
    alter_folder,
    altered,
    cells_of,
    json_text,
    lines_of,
    misspelt,
    sign,
    table_bytes,
    torn,
)

sys.path += [str(ROOT / "tests" / "api"), str(ROOT / "tests" / "quadrotor")]
from flight_logs import MAP, flown, write, write_ulog
from judged_files import inspect_log, lerobot, lm_eval

Case = Callable[[Path, Path, Random], list[object]]
"""Takes the bases, the folder and what is drawn; returns the line of a command."""

ARMS = ["--baseline", "calibrated", "--repair", "blind", "--library", "carts"]
RUN = [TOY, *ARMS, "--workers", 0]
JUDGE = ["--baseline", "old", "--repair", "new", "--out", "judged"]
WON = {"old": [n % 3 > 0 for n in range(8)], "new": [n % 4 > 0 for n in range(8)]}
ROWS: list[dict[str, Any]] = [
    {"arm": arm, "scene": f"s{n}", "seed": 0, "condition": at, "success": int(won), "reward": 0.5}
    for arm, each in WON.items()
    for at in ("nominal", "shared")
    for n, won in enumerate(each)
]
BOUNDS = {
    "isolated": "observer",
    "faults": [{"fault": "gain:scale", "size": [0.6, 1.4]}],
    "onset": [0, 40],
}
STUDY = {
    "faultpath_study": 1,
    "system": TOY,
    "baseline": "calibrated",
    "repair": "blind",
    "library": "carts",
    "scenes": 1,
    "seeds": [0],
    "audits": [{"name": "gain", "fault": "gain:scale=0.6"}],
}
MAP_FILE = yaml.safe_load(MAP)
COMMANDS = {
    "audit": ["audit", *RUN, "--scenes", 2, "--fault", "gain:scale=0.6"],
    "map": [
        *("map", *RUN, "--scenes", 1, "--fault", "gain"),
        *("--against", "controller,observer", "--up-to", 0.4),
    ],
    "search": ["search", *RUN, "--scenes", 2, "--candidates", 8, "--within", "bounds.yaml"],
    "sensitivity": [
        *("sensitivity", TOY, "--variant", "calibrated", "--fault", "gain:scale=1.4", "--fault"),
        *("velocity:offset=0.2", "--library", "carts", "--scenes", 1, "--workers", 0),
    ],
    "judge": ["judge", "all.csv", *JUDGE[:-2]],
}


def bases(folder: Path, kinds: tuple[str, ...]) -> None:
    """Make a run of each kind, and the logs of a flight."""
    (folder / "bounds.yaml").write_text(yaml.safe_dump(BOUNDS))
    (folder / "all.csv").write_bytes(_csv().encode())
    shutil.copytree(ROOT / "docs" / "reference" / "map-toy", folder / "map")
    for kind in kinds:
        files = {"bounds.yaml": folder / "bounds.yaml", "all.csv": folder / "all.csv"}
        line = [files.get(str(part), part) for part in COMMANDS[kind]]
        ended = faultpath(*line, "--out", folder / kind)
        assert ended.status in (0, 1), ended.err
    columns = {name: values[:2000:8] for name, values in flown(10.0).items()}
    for name in ("flight.csv", "flight.parquet"):
        write(folder / name, columns)
    write_ulog(folder / "flight.ulg", columns)


def _csv() -> str:
    head = ",".join(ROWS[0])
    return "\n".join([head, *(",".join(map(str, row.values())) for row in ROWS)]) + "\n"


def judge_table(suffix: str, base: Path, here: Path, rng: Random) -> list[object]:
    """Judge named columns."""
    path = here / f"all.{suffix}"
    if suffix == "parquet":
        table_bytes(pa.Table.from_pylist(ROWS), path, rng)
        if rng.random() < 0.15:
            path.write_bytes(torn(path.read_bytes(), rng))
    else:
        path.write_bytes(cells_of(_csv(), rng) if suffix == "csv" else lines_of(ROWS, rng))
    more = rng.choice(([], ["--metric", "reward"], ["--success-from", 0.5], ["--cluster", "task"]))
    label = rng.choice(("", "", "", "old=", "new@shared="))
    return ["judge", f"{label}all.{suffix}", *JUDGE, *more]


def judge_tool(kind: str, base: Path, here: Path, rng: Random) -> list[object]:
    """Judge what LeRobot, Inspect or lm-eval wrote, one of the two files altered."""
    odd, names, more = rng.choice(("old", "new")), list[str](), list[object]()
    for arm, won in WON.items():
        if kind == "inspect":
            folder = Path(inspect_log(here / arm, arm, won))
        elif kind == "lm-eval":
            folder = Path(lm_eval(here / arm, won).removeprefix("="))
            more = ["--column", f"success={rng.choice(('exact_match,strict-match', 'acc', 'x,y'))}"]
        else:
            folder = Path(lerobot(here / arm, won, kind == "episodes").removeprefix("="))
        (path,) = (each for each in folder.rglob("*") if each.is_file())
        if arm == odd:
            data = path.read_bytes()
            if kind == "lm-eval":
                path.write_bytes(lines_of(list(map(json.loads, data.splitlines())), rng))
            else:
                path.write_bytes(json_text(json.loads(data), rng))
        names.append(f"{arm}={folder.name}" if kind != "inspect" else folder.name)
    return ["judge", *names, *JUDGE, *more]


def report(kind: str, base: Path, here: Path, rng: Random) -> list[object]:
    """Write the pages of somebody's altered folder again."""
    shutil.copytree(base / kind, here / "run")
    alter_folder(here / "run", rng)
    if kind == "audit" and rng.random() < 0.2:
        shutil.copytree(base / kind, here / "other")
        return ["report", "run", "other", *rng.choice(([], ["--out", "page.html"], ["--json"]))]
    return ["report", "run"]


def replay(base: Path, here: Path, rng: Random) -> list[object]:
    """Run trials of an altered record again; the system is the toy, or no system at all."""
    shutil.copytree(base / "audit", here / "run")
    path = here / "run" / "record.json"
    content = json.loads(path.read_bytes())
    if rng.random() < 0.6:
        content["question"] = altered(content["question"], rng)
        if isinstance(content["question"], dict) and rng.random() < 0.2:
            named = rng.choice(("os:system", "nowhere:create", f"{TOY}x", "run:create", "a", ":"))
            content["question"] |= {"system": named, "options": {"command": "true"}}
        path.write_text(json.dumps(content))
        sign(here / "run")
    else:
        alter_folder(here / "run", rng)
    return ["replay", "run", *rng.choice(([], ["--signals"], ["--scene", rng.choice(VALUES)]))][:4]


def log(base: Path, here: Path, rng: Random) -> list[object]:
    """Read an altered log, or one by an altered map."""
    kind = rng.choice(("flight.csv", "flight.parquet", "flight.ulg"))
    path, said = here / kind, MAP
    shutil.copy(base / kind, path)
    which = rng.random()
    if which < 0.4:
        said = yaml.safe_dump(altered(yaml.safe_load(MAP), rng))
    elif which < 0.5:
        said = misspelt(MAP, rng)
    elif kind == "flight.csv":
        path.write_bytes(cells_of(path.read_text(), rng))
    elif kind == "flight.parquet" and rng.random() < 0.7:
        table_bytes(pq.read_table(path), path, rng)
    else:
        path.write_bytes(torn(path.read_bytes(), rng))
    (here / "map.yaml").write_text(said, "utf-8", "surrogatepass")
    where = ["px4", "--mass", 1.5] if kind.endswith("ulg") else ["map.yaml"]
    errors = rng.choice(("0.1", "0.1,-0.1", "1e-13", "0.999999", "1e308", "nan", ","))
    return ["log", kind, "--columns", *where, "--errors", errors, "--json"]


def study(base: Path, here: Path, rng: Random) -> list[object]:
    """Carry an altered study file out."""
    text = yaml.safe_dump(altered(json.loads(json.dumps(STUDY)), rng), allow_unicode=True)
    text = misspelt(text, rng) if rng.random() < 0.3 else text
    (here / "study.yaml").write_text(text, "utf-8", "surrogatepass")
    return ["audit", "--study", "study.yaml", "--out", "runs", "--workers", 0]


def search(base: Path, here: Path, rng: Random) -> list[object]:
    """Search within altered bounds."""
    text = yaml.safe_dump(altered(json.loads(json.dumps(BOUNDS)), rng), allow_unicode=True)
    text = misspelt(text, rng) if rng.random() < 0.3 else text
    (here / "bounds.yaml").write_text(text, "utf-8", "surrogatepass")
    return [*COMMANDS["search"], "--out", "searched"]


NUMBERS = ("0", "-0", "1", "-1", "1e308", "-1e308", "1e999", "5e-324", "1e-13", "nan", "٣", "1_0")
FAULTS = (
    *("gain:scale={}", "gain:scale={},onset={}", "velocity:offset={}", "velocity:noise={}"),
    *("velocity:bias={},relative", "gain:delay={}", "gain:hold={}", "velocity:quantise={}"),
    *("velocity:offset={}/{}", "gain:scale={}@observer", "gain:erase={}", "gain:scale={},for={}"),
    *("velocity:drift={}", "velocity:offset={} & gain:scale={}", "velocity:rotate={}/0/0", "{}"),
)


def numbers(verb: str, base: Path, here: Path, rng: Random) -> list[object]:
    """Ask with numbers at their extremes."""
    one = partial(rng.choice, NUMBERS)
    fault = rng.choice(FAULTS).format(one(), one())
    options = {
        "audit": {"--fault": fault}
        | {name: one() for name in ("--scenes", "--margin", "--thresholds", "--time-limit")},
        "plan": {"--fault": fault, "--scenes": one(), "--seeds": one()},
        "map": {
            "--up-to": one(),
            "--spread": f"{one()},{one()}",
            "--mean": f"{one()},{one()}",
            "--correlation": one(),
            "--points": one(),
        },
        "sensitivity": {"--points": one(), "--scenes": one(), "--seeds": one()},
        "judge": {"--success-from": one()},
    }[verb]
    (here / "all.csv").write_text(_csv())
    chosen = dict(rng.sample(sorted(options.items()), rng.choice((1, min(2, len(options))))))
    line = [*COMMANDS.get(verb, ["plan", TOY, *ARMS, "--fault", "gain:scale=0.6"])]
    for option, value in chosen.items():
        if option in line:
            line[line.index(option) + 1] = value
        else:
            line += [option, value]
    line += ["--points", 25] if verb == "map" and "--points" not in line else []
    line += ["--no-signals"] if verb == "audit" else []
    return [*line, "--out", "made.yaml" if verb == "plan" else "made"]


def outputs(base: Path, here: Path, rng: Random) -> list[object]:
    """Write where files of somebody, or of another run, are."""
    for kind in ("audit", "judge"):
        shutil.copytree(base / kind, here / kind)
    (here / "mine").mkdir()
    names = [each.name for each in (here / "audit").iterdir() if each.is_file()]
    for name in rng.sample(sorted(names), 3):
        (here / "mine" / name).write_text(rng.choice(("mine", "{}", "<html>", "")))
    (here / "all.csv").write_text(_csv())
    folder = rng.choice(("mine", "audit", "judge", "mine", ".", "all.csv"))
    file = f"{folder}/{rng.choice([*names, 'new'])}"
    run = COMMANDS["audit"]
    return rng.choice(
        (
            [*COMMANDS["judge"], "--out", folder],
            [*run, "--no-signals", "--out", folder],
            [*COMMANDS["map"], "--points", 25, "--out", folder],
            [*run, "--no-signals", "--out", "made", "--junit", file],
            [*run, "--no-signals", "--out", "made", "--junit", "all.csv"],
            ["plan", TOY, *ARMS, "--fault", "gain:scale=0.6", "--out", file],
            ["report", "audit", "judge", "--out", file],
            ["report", "audit", "judge", "--dependent-failures", file],
        )
    )


TOOLS = ("episodes", "tasks", "inspect", "lm-eval")
CASES: dict[str, Case] = {
    **{f"judge {suffix}": partial(judge_table, suffix) for suffix in ("csv", "jsonl", "parquet")},
    **{f"judge {kind}": partial(judge_tool, kind) for kind in TOOLS},
    **{f"report {kind}": partial(report, kind) for kind in ("audit", "judge", "map")},
    "replay": replay,
    "log": log,
    "study": study,
    **{f"numbers {verb}": partial(numbers, verb) for verb in ("audit", "plan", "map", "judge")},
    "outputs": outputs,
}
"""Cases that the quick part tries too."""
LONG: dict[str, Case] = {
    **{f"report {kind}": partial(report, kind) for kind in ("search", "sensitivity")},
    "search": search,
    "numbers sensitivity": partial(numbers, "sensitivity"),
}
