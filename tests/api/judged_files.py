"""Results as other tools write them, made from who succeeded where."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import faultpath

Successes = Mapping[str, Sequence[bool]]
"""By variant, scene by scene."""
HEADER = "variant,scene,seed,condition,success,initial\n"


def judged(results: object, folder: Any, **more: Any) -> faultpath.Run:
    """Ask which of the versions `old` and `new` is better."""
    question = {"baseline": "old", "repair": "new", "folder": folder, "progress": False} | more
    return faultpath.judge(results, **question)  # pyright: ignore[reportArgumentType] - mistakes too


def table(path: Path, conditions: Mapping[str, Successes]) -> Path:
    """Write the successes of each condition as CSV, with a hash for each scene."""
    lines = [
        f"{variant},s{n},0,{condition},{int(won)},h{n}"
        for condition, variants in conditions.items()
        for variant, each in variants.items()
        for n, won in enumerate(each)
    ]
    path.write_text(HEADER + "\n".join(lines) + "\n")
    return path


def lerobot(folder: Path, won: Sequence[bool], single: bool = False) -> str:
    """Write an `eval_info.json`: of two tasks, or of one environment as before there were tasks."""
    half = len(won) // 2
    metrics = [
        {"sum_rewards": [0.5] * half, "max_rewards": [1.0] * half, "successes": list(part)}
        for part in (won[:half], won[half:])
    ]
    info: dict[str, Any] = {
        "per_task": [
            {"task_group": "libero_10", "task_id": n, "metrics": each}
            for n, each in enumerate(metrics)
        ]
    }
    if single:
        info = {
            "per_episode": [
                {"episode_ix": n, "sum_reward": 0.5, "success": each, "seed": 1000 + n}
                for n, each in enumerate(won)
            ]
        }
    folder.mkdir()
    (folder / "eval_info.json").write_text(json.dumps(info))
    return f"={folder}"


def samples(won: Sequence[bool]) -> list[dict[str, Any]]:
    return [
        {
            "id": n,
            "epoch": 1,
            "input": [{"role": "user", "content": f"question {n}", "id": str(id(won))}],
            "target": "4",
            "scores": {"match": {"value": "C" if each else "I"}},
        }
        for n, each in enumerate(won)
    ]


def inspect_log(path: Path, model: str, won: Sequence[bool]) -> str:
    """Write a log of Inspect as JSON, named as Inspect does, in a folder of its own."""
    about = {"version": 2, "status": "success", "eval": {"task": "sums", "model": model}}
    path.mkdir()
    log = path / "2026-01-02T03-04-05-00-00_sums_kW3.json"
    log.write_text(json.dumps({**about, "samples": samples(won)}))
    return str(path)


def lm_eval(folder: Path, won: Sequence[bool]) -> str:
    """Write the samples of lm-eval, under two filters, in a folder of their model's."""
    (folder / "model").mkdir(parents=True)
    lines = [
        {"doc_id": n, "doc_hash": f"h{n}", "filter": name, "metrics": ["exact_match"], **score}
        for n, each in enumerate(won)
        for name, score in (
            ("strict-match", {"exact_match": float(each)}),
            ("flexible-extract", {"exact_match": 1.0}),
        )
    ]
    file = folder / "model" / "samples_gsm8k_2026-01-02T03-04-05.678901.jsonl"
    file.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return f"={folder}"
