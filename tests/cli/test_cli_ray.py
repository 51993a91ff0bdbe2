"""What `--executor ray` says where there is no cluster to fly on."""

import sys
from threading import Thread
from unittest.mock import patch

import pytest
from cli_runs import audit

pytestmark = pytest.mark.filterwarnings("ignore::FutureWarning", "ignore::ResourceWarning")


@pytest.mark.parametrize(
    ("executor", "workers", "name"),
    [
        ("slurm", 1, "'slurm'"),
        ("ray", 0, "1 or more"),
        ("ray:ray://head:10001", 1, "'ray://head:10001'"),
        ("ray:127.0.0.1:1", 1, "'127.0.0.1:1'"),
    ],
)
def test_a_cluster_that_is_not_there_is_a_sentence(executor, workers, name):
    pytest.importorskip("ray")
    audit(executor=executor, workers=workers, out="run").refused(name)


def test_a_missing_extra_is_a_sentence():
    with patch.dict(sys.modules, {"ray": None}):
        sys.modules.pop("faultpath.run.work.ray_cluster", None)
        audit(executor="ray", workers=1, out="run").refused("pip install '.[ray]'")


def test_another_version_on_the_cluster_is_a_sentence():
    pytest.importorskip("ray")
    message = "Version mismatch: The cluster was started with:\n    Ray: 2.1\n    Python: 3.9\n"
    with patch("ray.init", side_effect=RuntimeError(message)):
        ended = audit(executor="ray:auto", workers=1, out="run")
    ended.refused("Version mismatch: The cluster was started with: Ray: 2.1")


def test_without_a_cluster_one_is_started_here_with_as_many_cpus_as_workers(monkeypatch):
    pytest.importorskip("ray")
    monkeypatch.delenv("RAY_ADDRESS", raising=False)
    calls = []

    def init(address, **more):
        calls.append((address, more.get("num_cpus")))
        raise ConnectionError("none runs") if address == "auto" else Exception("no room\n")

    with patch("ray.init", side_effect=init):
        ended = audit(executor="ray", workers=3, out="run")
    assert calls == [("auto", None), ("local", 3)]
    ended.refused("no room")


def test_what_rays_threads_print_is_no_output_of_ours(capsys):
    pytest.importorskip("ray")
    from faultpath.run.work.ray_cluster import _WithoutNews

    output = _WithoutNews(sys.stdout)
    print("ours", file=output)
    thread = Thread(target=lambda: print("theirs", file=output), name="ray_listen_error_messages")
    thread.start()
    thread.join()
    assert capsys.readouterr() == ("ours\n", "theirs\n")
