"""Many models: which, in which order, on how many processes, and what stops them."""

import signal
import subprocess
from pathlib import Path

import pytest
from faultpath_quadrotor.training import catalogue, trajectories
from faultpath_quadrotor.training.catalogue import ALL, GROUPS, FitJob, choose, stages
from faultpath_quadrotor.training.fitting import fit, journal_path
from faultpath_quadrotor.training.flight import EPISODES, recipe
from faultpath_quadrotor.training.jobs import missing_pools, run_jobs
from faultpath_quadrotor.training.pool import Provenance
from fitting_toys import Toy, entry

from faultpath.core.errors import Stopped, UserError
from faultpath.learning.model_card import encoded
from faultpath.run.work import processes as processes_of_work


def _run(tmp_path: Path, wanted: list[FitJob], workers: int = 0, told=lambda *_: None, **more):
    data, out = tmp_path / "data", tmp_path / "out"
    return run_jobs(wanted, data, out, workers, told, lambda _: None, **more)


def test_without_names_everything_comes_in_order_of_dependence() -> None:
    assert choose(["all"]) == choose([])
    stems = [job.stem for job in choose([])]
    assert len(stems) == len(set(stems)) == sum(len(entry.seeds) for entry in ALL)
    before: set[str] = set()
    for stage in stages(choose([])):
        assert all(set(job.entry.after) <= before for job in stage)
        before |= {job.entry.name for job in stage}
    assert before == {entry.name for entry in ALL}
    stems = [job.stem for job in choose(["gru+dcc", "wm-a"], [4, 0, 4])]
    assert stems == ["wm-a-4", "wm-a-0", "gru+dcc-4", "gru+dcc-0"]
    assert {job.entry for job in choose(["predictors", "wm-a"])} == set(GROUPS["predictors"])


def test_the_catalogue_asks_for_pools_that_can_be_collected() -> None:
    known = {*EPISODES, catalogue.CLEARANCE_POOL, catalogue.TRAJECTORY_POOL}
    assert {pool for each in ALL for pool in each.pools} == known


POOLS = {"wm-a": ("nominal", recipe), "gru-trajectory": ("trajectory", trajectories.recipe)}


@pytest.mark.parametrize("model", POOLS)
def test_a_pool_is_missing_until_it_is_there_and_one_of_other_code_is_refused(
    model: str, tmp_path: Path
) -> None:
    pool, recipe_of = POOLS[model]
    chosen = [job for job in choose([model, "clearance"]) if job.seed == 0]
    assert missing_pools(chosen, tmp_path) == (pool, "clearance")
    expected = recipe_of(pool) if pool == "nominal" else recipe_of()

    def put(code: str) -> None:
        made = {"code_sha256": code, "packages": {}, "faultpath_version": "0"}
        provenance = Provenance(**dict(expected) | made, content_sha256="")
        note = provenance.model_dump(mode="json")
        (tmp_path / f"{pool}.safetensors").write_bytes(encoded({}, note))

    put(expected.code_sha256)
    assert missing_pools(chosen, tmp_path) == ("clearance",)
    put("other")
    with pytest.raises(UserError, match=rf"{pool}\.safetensors was collected by other code"):
        missing_pools(chosen, tmp_path)


@pytest.mark.slow
def test_worker_processes_give_the_same_bits_and_fail_alone(tmp_path: Path) -> None:
    good, dies = (FitJob(entry(name), 0) for name in ("good", "dies"))
    (alone,) = _run(tmp_path / "0", [good])
    killed, beside = _run(tmp_path / "2", [dies, good], 2)
    assert alone.model_copy(update={"duration_s": beside.duration_s}) == beside
    assert killed.job.stem == "dies-0"
    assert "memory" in killed.error


def test_ctrl_c_ends_the_workers_and_keeps_their_epochs(tmp_path, monkeypatch):
    gate = tmp_path / "data" / "gate"
    gate.parent.mkdir()
    gate.touch()
    journal = journal_path(tmp_path / "out" / "slow-0.safetensors")
    processes: list[subprocess.Popen[bytes]] = []
    original = processes_of_work._Process.__init__

    def note(self) -> None:
        original(self)
        processes.append(self.popen)

    def stop(done: float, news: str) -> None:
        if journal.exists() and "slow-0 epoch" in news:
            raise KeyboardInterrupt

    monkeypatch.setattr(processes_of_work._Process, "__init__", note)
    with pytest.raises(Stopped, match="with 0 of 1 models finished"):
        _run(tmp_path, [FitJob(entry("slow"), 0)], 1, stop)
    assert [process.returncode for process in processes] == [-signal.SIGKILL]
    gate.unlink()
    _run(tmp_path, [FitJob(entry("slow"), 0)])
    task = Toy(epochs=30)
    task.name = "slow"
    whole = fit(task, tmp_path / "whole")
    assert (tmp_path / "out" / whole.name).read_bytes() == whole.read_bytes()
