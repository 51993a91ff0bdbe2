"""A plan on a Ray cluster of this machine: what is lost comes back, and nothing else changes."""

import os
import re
import signal
import time
from collections import Counter
from functools import partial
from pathlib import Path

import pytest
from calls import alive, end_of
from cli_runs import until
from ray_nodes import cluster, node
from toy_plan import SYSTEM, UNITS, plan, plan_of
from written import written

import faultpath
from faultpath.core.errors import Notice, Stopped, UserError
from faultpath.run.execution.runner import run_plan
from faultpath.run.plan import SystemSpec
from faultpath.run.store.folder import RunFolder
from faultpath.run.work import ray_cluster
from faultpath.run.work.executor import Failed, Lost, Returned, elsewhere, send_message
from faultpath.run.work.ray_cluster import RayWorkers

UNRULY = Path(__file__).with_name("test_execution_failures.py")
OTHER = """
import os
Mine.fingerprint = lambda self: os.environ.get("PLACE", "there")
def create(**options) -> Mine:
    if options.get("needs") not in os.environ:
        raise OSError(f"{options['needs']} is not set")
    return Mine()
"""
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::FutureWarning")


@pytest.fixture(scope="module")
def head():
    pytest.importorskip("ray")
    with cluster() as started:
        yield started


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """The plan by processes of this machine."""
    return run_plan(plan(), tmp_path_factory.mktemp("here"), workers=0)


@pytest.mark.parametrize("lost", ["node", "worker"])
def test_a_plan_that_loses_a_node_or_a_worker_ends_with_the_same_bytes(head, here, tmp_path, lost):
    """All workers have begun a unit when the node of one, or the process of one, is killed."""
    nodes = [head.add_node(**node())] if lost == "node" else []
    gate, log, workers = tmp_path / "gate", tmp_path / "log", len(nodes) + 1
    gate.touch()
    log.touch()

    def kill(progress):
        begun = [int(line.split()[3]) for line in log.read_text().splitlines()]
        if gate.exists() and len(begun) == workers:
            for each in nodes:
                head.remove_node(each, allow_graceful=False)
            if not nodes:
                os.kill(begun[0], signal.SIGKILL)
            # Until a worker has noticed that its node is gone, it would go on and finish its unit.
            until(lambda: not all(map(alive, begun)), "a worker's end")
            gate.unlink()

    asked = plan(hang_while=str(gate), log=str(log))
    with RayWorkers(head.address, workers) as hands:
        there = run_plan(asked, tmp_path / "there", executor=hands, progress=kill, recheck=False)
        assert re.fullmatch(rf"Ray \S+, {workers} nodes?", hands.name)
    assert there.failures == ()
    assert there.outcomes_sha256 == here.outcomes_sha256
    pids = [line.split()[3] for line in log.read_text().splitlines()]
    assert len(pids) == UNITS + 1, "one unit was lost and run again"
    assert max(Counter(pids).values()) >= UNITS - 1


@pytest.mark.parametrize("error", ["OutOfMemoryError", "WorkerCrashedError"])
def test_workers_that_ray_stops_for_want_of_memory_are_waited_for(head, monkeypatch, error):
    """Others that do not start, such as those of another Python, are given up after some."""
    fetch, stopped = ray_cluster._ray.get, [getattr(ray_cluster._ray.exceptions, error)("")]
    monkeypatch.setattr(ray_cluster, "_FALSE_STARTS", 0)

    def get(reference):
        if stopped:
            raise stopped.pop()
        return fetch(reference)

    with RayWorkers(head.address, 1) as hands:
        monkeypatch.setattr(ray_cluster._ray, "get", get)
        if error == "OutOfMemoryError":
            monkeypatch.setattr(ray_cluster, "_PATIENCE_S", 0.0)
            with pytest.warns(Notice, match="no worker runs on the Ray cluster yet; waiting for"):
                assert list(hands.free()) == [0]
            assert not stopped
        else:
            with pytest.raises(UserError, match="workers do not start on the Ray cluster"):
                hands.free()


def test_an_audit_that_was_stopped_on_a_cluster_goes_on_there_to_the_same_bytes(
    head, tmp_path, monkeypatch
):
    asked = {"baseline": "plain", "repair": "observed", "library": "ten"}
    asked |= {"system": SYSTEM, "fault": "mass:scale=0.6", "progress": False}
    monkeypatch.setenv("RAY_ADDRESS", head.address)
    there = partial(faultpath.audit, folder=tmp_path / "there", executor="ray", workers=1, **asked)
    save = RunFolder.save_shard

    def stop(folder, *shard):
        save(folder, *shard)
        if len(folder.list_shards()) == 4:
            raise KeyboardInterrupt

    monkeypatch.setattr(RunFolder, "save_shard", stop)
    with pytest.raises(Stopped, match="the same again to resume"):
        there()
    monkeypatch.setattr(RunFolder, "save_shard", save)
    run, alone = there(), faultpath.audit(folder=tmp_path / "alone", workers=0, **asked)
    assert run.provenance.blocks_kept == 4
    assert run.provenance.blocks_computed > 0
    for table in ("outcomes.parquet", "traces.parquet"):
        assert (run.folder / table).read_bytes() == (alone.folder / table).read_bytes()
    assert run.record == alone.record
    assert (run.provenance.machine.workers, alone.provenance.machine.executor) == (1, "")
    assert run.provenance.machine.executor in (run.folder / "report.html").read_text()


@pytest.fixture(scope="module")
def hands(head):
    """The one worker that the cluster has room for: for the tests below alone."""
    with RayWorkers(head.address, 1) as workers:
        yield workers


def test_an_actor_is_a_worker_like_any_other(hands):
    heard = []
    assert end_of(hands, partial(send_message, "news"), heard.append) == Returned(None)
    assert heard == ["news"]
    first = end_of(hands, os.getpid)
    assert end_of(hands, os.getpid) == first, "a number stands for a memory that stays"
    assert end_of(hands, partial(os.getenv, "OMP_NUM_THREADS")) == Returned("1")
    assert end_of(hands, os.getcwd) == Returned(os.getcwd())
    assert end_of(hands, elsewhere).value.startswith("node ")
    failed = end_of(hands, partial(int, "none"))
    assert isinstance(failed, Failed)
    assert "Traceback" in failed.error.__notes__[0]
    lost = end_of(hands, partial(os._exit, 3))
    assert isinstance(lost, Lost)
    assert lost.how.startswith("the worker on node ")
    second = end_of(hands, os.getpid)
    assert second != first
    hands.submit(0, partial(time.sleep, 600))
    assert list(hands.free()) == []
    hands.cancel(0)
    assert end_of(hands, os.getpid) not in (first, second)
    assert elsewhere() == ""


@pytest.mark.parametrize(
    ("option", "says"),
    [
        ("PATH", r"is another one on node \S+ of the Ray cluster than here \(what fingerprint"),
        ("PLACE", r"on node \S+ of the Ray cluster: .*PLACE is not set.*every node needs the same"),
    ],
)
def test_a_node_with_another_system_is_named(hands, tmp_path, monkeypatch, option, says):
    monkeypatch.setenv("PLACE", "here")  # a node keeps the environment in which it was started
    system = written(tmp_path, base="weighed.ToySystem", create=OTHER)
    spec = SystemSpec(name=system, options={"needs": option})
    asked = plan().model_copy(update={"system": spec})
    with pytest.raises(UserError, match=says):
        run_plan(asked, tmp_path / "run", executor=hands)


@pytest.mark.parametrize(
    ("does", "scenes", "limit", "says"),
    [
        ("die", ("s00", "s05"), {}, "the worker on node .* of the Ray cluster was lost"),
        # Alone, since a busy machine may take seconds over any that has to end in time.
        ("hang", ("s05",), {"time_limit_s": 0.5}, "it was stopped at the time limit of 0.5 s"),
    ],
)
def test_a_unit_that_is_its_workers_end_or_takes_too_much_loses_itself_alone(
    hands, tmp_path, does, scenes, limit, says
):
    """One is killed in the moment in which its flight begins, each time."""
    trials = plan_of(f"{UNRULY}:unruly", scenes, does=does, where="s05", dies="s05")
    found = run_plan(trials, tmp_path, executor=hands, recheck=False, **limit)
    (failure,) = found.failures
    assert (failure.scene, found.blocks_computed) == ("s05", len(scenes))
    assert re.search(says, failure.error)
