"""Logs that inspect_ai wrote, read by it and decided here."""

from pathlib import Path

import pytest

import faultpath

log = pytest.importorskip("inspect_ai.log", reason="the extra inspect is not installed")
scorer = pytest.importorskip("inspect_ai.scorer")
WON = {"old": [n % 3 > 0 for n in range(12)], "new": [True] * 12}


def written(path: Path, model: str) -> str:
    """Write a log as the package does, of samples that this model answers well or not."""
    samples = [
        log.EvalSample(
            id=n,
            epoch=1,
            input=f"question {n}",
            target="4",
            scores={"match": scorer.Score(value="C" if won else "I")},
        )
        for n, won in enumerate(WON[model])
    ]
    about = log.EvalSpec(
        created="2026-01-02T03:04:05+00:00",
        task="sums",
        dataset=log.EvalDataset(),
        model=model,
        config=log.EvalConfig(),
    )
    log.write_eval_log(log.EvalLog(status="success", eval=about, samples=samples), str(path))
    return str(path)


@pytest.mark.parametrize("kind", ["eval", "json"])
def test_a_log_of_the_package_is_decided(kind: str, tmp_path: Path) -> None:
    logs = [written(tmp_path / f"{variant}.{kind}", variant) for variant in WON]
    run = faultpath.judge(
        logs, baseline="old", repair="new", folder=tmp_path / "run", progress=False
    )
    assert run.record.effects[0].won == ((4, 0),)
    data = Path(logs[0]).read_bytes()
    (tmp_path / "cut.eval").write_bytes(data[: len(data) // 2])
    with pytest.raises(faultpath.UserError, match="is no sound log of Inspect"):
        faultpath.judge(tmp_path / "cut.eval", baseline="old", repair="new", progress=False)
