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
from cli_runs import ROOT, TOY, faultpath
from odd_inputs import (
    VALUES,
    alter_folder,
    alter_table,
    altered,
    cells_of,
    json_text,
    lines_of,
    sign,
    torn,
)

sys.path += [str(ROOT / "tests" / "api"), str(ROOT / "tests" / "quadrotor")]
from judged_files import inspect_log, lerobot, lm_eval

Case = Callable[[Path, Path, Random], list[object]]
"""Takes the bases, the folder and what is drawn; returns the line of a command."""

VERSIONS = ["--baseline", "calibrated", "--repair", "blind", "--library", "carts"]
RUN = [TOY, *VERSIONS, "--workers", 0]
JUDGE = ["--baseline", "old", "--repair", "new", "--out", "judged"]
WON = {"old": [n % 3 > 0 for n in range(8)], "new": [n % 4 > 0 for n in range(8)]}
ROWS: list[dict[str, Any]] = [
    {
        "variant": variant,
        "scene": f"s{n}",
        "seed": 0,
        "condition": at,
        "success": int(won),
        "reward": 0.5,
    }
    for variant, each in WON.items()
    for at in ("nominal", "shared")
    for n, won in enumerate(each)
]
COMMANDS = {
    "audit": ["audit", *RUN, "--scenes", 2, "--fault", "gain:scale=0.6"],
    "map": [
        *("map", *RUN, "--scenes", 1, "--fault", "gain"),
        *("--against", "controller,observer", "--up-to", 0.4),
    ],
    "judge": ["judge", "all.csv", *JUDGE[:-2]],
}


def bases(folder: Path, kinds: tuple[str, ...]) -> None:
    """Make a run of each kind."""
    (folder / "all.csv").write_bytes(_csv().encode())
    for kind in ("map", "scan"):
        shutil.copytree(ROOT / "docs" / "reference" / f"{kind}-toy", folder / kind)
    for kind in kinds:
        line = [folder / part if part == "all.csv" else part for part in COMMANDS[kind]]
        ended = faultpath(*line, "--out", folder / kind)
        assert ended.status in (0, 1), ended.err


def _csv() -> str:
    head = ",".join(ROWS[0])
    return "\n".join([head, *(",".join(map(str, row.values())) for row in ROWS)]) + "\n"


def judge_table(suffix: str, base: Path, here: Path, rng: Random) -> list[object]:
    path = here / f"all.{suffix}"
    if suffix == "parquet":
        pq.write_table(pa.Table.from_pylist(ROWS), path)
        alter_table(path, rng)
        if rng.random() < 0.15:
            path.write_bytes(torn(path.read_bytes(), rng))
    else:
        path.write_bytes(cells_of(_csv(), rng) if suffix == "csv" else lines_of(ROWS, rng))
    more = rng.choice(([], ["--metric", "reward"], ["--success-from", 0.5], ["--cluster", "task"]))
    label = rng.choice(("", "", "", "old=", "new@shared="))
    return ["judge", f"{label}all.{suffix}", *JUDGE, *more]


def judge_tool(kind: str, base: Path, here: Path, rng: Random) -> list[object]:
    """Judge what LeRobot, Inspect or lm-eval wrote, one of the two files altered."""
    write: Callable[[str, list[bool]], str] = {
        "inspect": lambda variant, won: inspect_log(here / variant, variant, won),
        "lm-eval": lambda variant, won: variant + lm_eval(here / variant, won),
        "tasks": lambda variant, won: variant + lerobot(here / variant, won),
        "episodes": lambda variant, won: variant + lerobot(here / variant, won, single=True),
    }[kind]
    names = [write(variant, won) for variant, won in WON.items()]
    (path,) = (file for file in (here / rng.choice(("old", "new"))).rglob("*") if file.is_file())
    data = path.read_bytes()
    if kind == "lm-eval":
        path.write_bytes(lines_of(list(map(json.loads, data.splitlines())), rng))
    else:
        path.write_bytes(json_text(json.loads(data), rng))
    metric = rng.choice(("exact_match,strict-match", "acc", "x,y"))
    return ["judge", *names, *JUDGE, *(("--column", f"success={metric}") * (kind == "lm-eval"))]


def report(kind: str, base: Path, here: Path, rng: Random) -> list[object]:
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
    part = rng.choice(("question", "facts"))
    content[part] = altered(content[part], rng)
    if all(isinstance(content[n], dict) for n in ("question", "facts")) and rng.random() < 0.2:
        named = rng.choice(("os:system", "nowhere:create", f"{TOY}x", "run:create", "a", ":"))
        content["question"] |= {"options": {"command": "true"}}
        content["facts"] |= {"system": named}
    path.write_text(json.dumps(content))
    sign(here / "run")
    return [
        "replay",
        "run",
        *rng.choice(([], ["--signals"], ["--where"], ["--scene", rng.choice(VALUES)])),
    ]


CASES: dict[str, Case] = {
    **{f"judge {suffix}": partial(judge_table, suffix) for suffix in ("csv", "jsonl", "parquet")},
    **{f"judge {k}": partial(judge_tool, k) for k in ("episodes", "tasks", "inspect", "lm-eval")},
    **{f"report {kind}": partial(report, kind) for kind in ("audit", "judge", "map", "scan")},
    "replay": replay,
}
