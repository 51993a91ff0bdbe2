"""Where a run comes from."""

import subprocess

from toy_study import UNITS, study

from faultpath.execution import Stopwatch, run_provenance, run_study
from faultpath.execution.provenance import checkout


def _git(folder, *arguments):
    settings = ["-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false"]
    command = ["git", "-C", str(folder), *settings, *arguments]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def test_a_checkout_knows_its_commit_and_its_changes(tmp_path):
    package = tmp_path / "src" / "package"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("a = 1\n")
    _git(tmp_path, "init", "-q")
    assert checkout(package) == (None, None)  # inside a repository, but not part of it
    _git(tmp_path, "add", ".")
    _git(tmp_path, "commit", "-qm", "one")
    commit = _git(tmp_path, "rev-parse", "HEAD")
    assert checkout(package) == (commit, False)
    (tmp_path / "notes").write_text("beside the package\n")
    assert checkout(package) == (commit, False)
    (package / "__init__.py").write_text("a = 2\n")
    assert checkout(package) == (commit, True)


def test_provenance_tells_the_run(tmp_path):
    stopwatch = Stopwatch()
    result = run_study(study(), tmp_path, workers=0)
    told = run_provenance(result, stopwatch, ["faultpath", "audit"], workers=0)
    assert (told.blocks_computed, told.blocks_kept) == (UNITS, 0)
    assert told.outcomes_sha256 == result.outcomes_sha256
    assert told.command == ("faultpath", "audit")
    assert {"numpy", "pyarrow"} <= told.packages.keys()
    assert told.processor
    assert 0 < told.wall_s < 60
    assert told.started <= told.finished
