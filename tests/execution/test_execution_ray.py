"""A study on a Ray cluster of this machine: what is lost comes back, and nothing else changes."""

import os
import re
import time
from collections import Counter
from functools import partial
from pathlib import Path

import pytest
from ray_nodes import cluster, node
from toy_study import UNITS, study

import faultpath
from faultpath.errors import UserError
from faultpath.execution import run_study
from faultpath.trials import SystemSpec
from faultpath.work import Failed, Lost, Returned, elsewhere
from faultpath.work.executor import tell
from faultpath.work.ray_cluster import RayWorkers

TOY = Path(__file__).resolve().parents[2] / "examples" / "toy.py"
OTHER = """
import os
from toy_system import ToySystem

class Other(ToySystem):
    def fingerprint(self):
        return os.environ.get("PLACE", "there")

def create(**options):
    if options.get("needs") not in os.environ:
        raise OSError(f"{options['needs']} is not set")
    return Other()
"""
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::FutureWarning")


@pytest.fixture(scope="module")
def head():
    pytest.importorskip("ray")
    with cluster() as started:
        yield started


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """The study by processes of this machine."""
    return run_study(study(), tmp_path_factory.mktemp("here"), workers=0)


def end_of(executor, call, told=lambda message: None):
    (worker, *_) = executor.free()
    executor.submit(worker, call, told)
    limit = time.monotonic() + 120
    while time.monotonic() < limit:
        for ended, end in executor.completions(0.5):
            assert ended == worker
            return end
    raise AssertionError("waited in vain")


def test_a_study_that_loses_a_node_ends_with_the_same_bytes(head, here, tmp_path):
    """Two nodes of one CPU each hold a unit when one of them is killed."""
    lost = head.add_node(**node())
    gate, log = tmp_path / "gate", tmp_path / "log"
    gate.touch()
    log.touch()

    def kill(progress):
        if gate.exists() and len(log.read_text().splitlines()) == 2:
            head.remove_node(lost, allow_graceful=False)
            gate.unlink()

    asked = study(hang_while=str(gate), log=str(log))
    with RayWorkers(head.address, 2) as hands:
        there = run_study(asked, tmp_path / "there", executor=hands, progress=kill, recheck=False)
        assert re.fullmatch(r"Ray \S+, 2 nodes", hands.name)
    assert there.failures == ()
    assert there.outcomes_sha256 == here.outcomes_sha256
    flown = [line.split() for line in log.read_text().splitlines()]
    assert len(flown) == UNITS + 1, "one unit was lost with its node and flown again"
    assert max(Counter(pid for *_, pid in flown).values()) >= UNITS - 1


def test_an_actor_is_a_worker_like_any_other(head):
    with RayWorkers(head.address, 1) as hands:
        heard = []
        assert end_of(hands, partial(tell, "news"), heard.append) == Returned(None)
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


def test_an_audit_on_a_cluster_is_that_of_this_machine(head, tmp_path, monkeypatch):
    asked = {"baseline": "calibrated", "repair": "blind", "fault": "gain:scale=0.6"}
    asked |= {"library": "carts", "scenes": 6, "progress": False}
    alone = faultpath.audit(TOY, folder=tmp_path / "alone", workers=0, **asked)
    monkeypatch.setenv("RAY_ADDRESS", head.address)
    there = faultpath.audit(TOY, folder=tmp_path / "there", executor="ray", workers=1, **asked)
    assert there.provenance.outcomes_sha256 == alone.provenance.outcomes_sha256
    assert there.record == alone.record
    assert (there.provenance.workers, alone.provenance.executor) == (1, "")
    assert there.provenance.executor in (there.folder / "report.html").read_text()


@pytest.mark.parametrize(
    ("option", "says"),
    [
        ("PATH", r"is another one on node \S+ of the Ray cluster than here \(what fingerprint"),
        (
            "PLACE",
            r"on node \S+ of the Ray cluster: .*PLACE is not set.*every node needs the same",
        ),
    ],
)
def test_a_node_with_another_system_is_named(head, tmp_path, monkeypatch, option, says):
    monkeypatch.setenv("PLACE", "here")  # a node keeps the environment in which it was started
    file = tmp_path / "other.py"
    file.write_text(OTHER)
    spec = SystemSpec(name=f"{file}:create", options={"needs": option})
    asked = study().model_copy(update={"system": spec})
    with RayWorkers(head.address, 1) as hands, pytest.raises(UserError, match=says):
        run_study(asked, tmp_path / "run", executor=hands)
