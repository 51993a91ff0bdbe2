"""Where a run comes from."""

import hashlib
import subprocess
from datetime import UTC, datetime

from stale_toys import Mine

from faultpath.run.execution.runner import run_plan
from faultpath.run.provenance import checkout, run_provenance
from faultpath.run.work.processes import local


def _git(folder, *arguments):
    settings = ["-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false"]
    command = ["git", "-C", str(folder), *settings, *arguments]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def test_a_checkout_knows_its_commit_and_its_changes(tmp_path):
    package = tmp_path / "src" / "package"
    package.mkdir(parents=True)
    main = package / "__init__.py"
    main.write_text("a = 1\n")
    _git(tmp_path, "init", "-q")
    assert checkout(main, [package]) == (None, None)  # inside a repository, but not part of it
    _git(tmp_path, "add", ".")
    _git(tmp_path, "commit", "-qm", "one")
    commit = _git(tmp_path, "rev-parse", "HEAD")
    assert checkout(main, [package]) == (commit, False)
    (tmp_path / "notes").write_text("beside the package\n")
    assert checkout(main, [package]) == (commit, False)
    main.write_text("a = 2\n")
    assert checkout(main, [package]) == (commit, True)


def test_provenance_tells_the_run_its_repository_and_every_file_that_flew(tmp_path):
    mine = Mine(tmp_path / "mine")

    def told(name: str):
        result = run_plan(mine.plan(), tmp_path / name, workers=0)
        started = datetime.now(UTC)
        return run_provenance(tmp_path / name, [], result, started, ["faultpath"], local(0))

    untracked = told("untracked")
    assert (untracked.code.system_commit, untracked.code.system_dirty) == (None, None)
    assert untracked.command == ("faultpath",)
    assert untracked.machine.processor
    assert 0 < untracked.wall_s < 60
    assert untracked.started <= untracked.finished
    _git(tmp_path / "mine", "init", "-q")
    _git(tmp_path / "mine", "add", ".")
    _git(tmp_path / "mine", "commit", "-qm", "one")
    clean = told("clean")
    assert clean.code.system_commit == _git(tmp_path / "mine", "rev-parse", "HEAD")
    assert clean.code.system_dirty is False
    assert {"my.py", mine.helper.name, "faultpath"} <= clean.code.sources.keys()
    assert clean.code.sources["my.py"] == hashlib.sha256(mine.file.read_bytes()).hexdigest()
    assert clean.code.data.keys() == {"push.txt"}
    assert {"numpy", "pyarrow", "pydantic-core"} <= clean.machine.packages.keys()
    (tmp_path / "mine" / "notes").write_text("beside what flies")
    again = told("clean")
    assert again.code.system_dirty is False
    assert [(run.blocks_computed, run.blocks_kept) for run in (clean, again)] == [(3, 0), (0, 3)]
    mine.data.write_text("1.0")
    assert told("dirty").code.system_dirty is True
