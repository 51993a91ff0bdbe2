"""Trials that runs into several folders share: only what would have been flown just so."""

from pathlib import Path

from toy_study import SCENES, study

from faultpath.trials.arm import Study
from faultpath.trials.execution import RunResult, run_study


def run(asked: Study, folder: Path, store: Path, told: list[str] | None = None) -> RunResult:
    notice = (told if told is not None else []).append
    return run_study(asked, folder, workers=1, notice=notice, share=store)


def kept(store: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in store.rglob("*.parquet")}


def test_what_runs_have_in_common_flies_once(tmp_path: Path) -> None:
    store, told = tmp_path / "store", []
    whole = study(SCENES[:4])
    first = run(whole, tmp_path / "first", store)
    assert len(kept(store)) == first.blocks_computed > 0

    second = run(whole.model_copy(update={"name": "other"}), tmp_path / "second", store, told)
    assert second.blocks_computed == 0
    assert second.outcomes_sha256 == first.outcomes_sha256
    assert second.flown_again, "a sample is flown again all the same"
    assert f"{second.blocks_kept} of {second.blocks_kept} blocks are those of other runs" in told[0]
    same = (tmp_path / folder / "outcomes.parquet" for folder in ("first", "second"))
    assert len({path.read_bytes() for path in same}) == 1

    victim = next(store.rglob("*.parquet"))
    sound = kept(store)
    victim.write_bytes(b"damaged")
    third = run(whole, tmp_path / "third", store, told)
    assert third.blocks_computed == 1
    assert third.outcomes_sha256 == first.outcomes_sha256
    assert any("is damaged" in each for each in told)
    assert kept(store) == sound, "what was damaged is whole again"


def test_other_options_other_trials_and_failed_ones_are_not_shared(tmp_path: Path) -> None:
    store = tmp_path / "store"
    failing = run(study(SCENES[4:7], raises="s05"), tmp_path / "failing", store)
    assert failing.failures
    assert not kept(store)
    run(study(SCENES[:2]), tmp_path / "sound", store)
    assert kept(store)
    other = run(study(SCENES[:2], raises="s05"), tmp_path / "other", store)
    assert other.blocks_kept == 0, "of other options, though of the same code"
    unwritable = tmp_path / "a file"
    unwritable.write_text("")
    told: list[str] = []
    run(study(SCENES[:2]), tmp_path / "third", unwritable, told)
    assert any("Trials are not shared with other runs" in each for each in told)
