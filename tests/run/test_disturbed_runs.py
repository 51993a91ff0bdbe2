"""Whatever stops, spoils or widens a run, the next one ends with the bytes of one left alone."""

from contextlib import suppress
from functools import cache
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, precondition, rule
from toy_plan import SCENES, plan, rows

from faultpath.core.errors import Stopped
from faultpath.run.execution.runner import RunResult, run_plan
from faultpath.run.plan import Plan
from faultpath.run.store.folder import RunFolder
from faultpath.run.work.executor import Progress

pytestmark = pytest.mark.slow  # all together

TABLES = ("outcomes.parquet", "traces.parquet", "deliveries.json")
ORDER = ("s07", "s02", "s09", "s00", "s05", "s01", "s08", "s03", "s06", "s04")
SPOILT = {
    "cut": lambda data, other: data[: len(data) // 2],
    "flipped": lambda data, other: data[:40] + bytes([data[40] ^ 1]) + data[41:],
    "another's": lambda data, other: other,
}


def run(folder: Path, asked: Plan, reached: int, **more: Any) -> RunResult:
    """Run a plan; one with looks stops when it has seen as many scenes as `reached`."""

    def stop(table) -> bool:
        return len({trial.outcome.scene for trial in table}) >= reached

    return run_plan(
        asked,
        folder,
        workers=0,
        recheck=False,
        stop=stop if asked.scenes_per_analysis else None,
        **more,
    )


def asked(look: int, scenes: tuple[str, ...], gate: Path) -> Plan:
    """Return a plan in which one scene fails while the file `gate` exists."""
    whole = plan(scenes, raises="s05", **{"while": str(gate)})
    return whole.model_copy(update={"scenes_per_analysis": look, "rows": rows()[::3]})


@cache
def left_alone(look: int, scenes: tuple[str, ...], reached: int, air: bool) -> list[bytes]:
    """Return the tables of a run that nothing disturbs."""
    with TemporaryDirectory() as place:
        (gate := Path(place, "no-air")).touch()
        gate.unlink() if air else None
        run(Path(place, "run"), asked(look, scenes, gate), reached)
        return [Path(place, "run", name).read_bytes() for name in TABLES]


class Disturbed(RuleBasedStateMachine):
    """A run folder with a plan of a fixed number of scenes.

    A process that is killed leaves what one leaves that is stopped, and at most a part of a file.
    """

    look, widths, reached = 0, (SCENES[:4], SCENES[2:9], SCENES[::-1]), (0,)
    some = st.integers(0, 2)

    def __init__(self) -> None:
        super().__init__()
        self.place = TemporaryDirectory()
        root = Path(self.place.name)
        self.folder, self.gate = root / "run", root / "no-air"
        self.gate.touch()
        self.spoilt: dict[Path, bytes] = {}

    def teardown(self) -> None:
        self.place.cleanup()

    def chosen(self, width: int, reached: int) -> tuple[tuple[str, ...], int]:
        return self.widths[width % len(self.widths)], self.reached[reached % len(self.reached)]

    def shards(self) -> dict[str, list[Path]]:
        return RunFolder(self.folder).list_shards()

    @rule(width=some, reached=some, blocks=st.integers(0, 9))
    def stops(self, width: int, reached: int, blocks: int) -> None:
        """Ctrl-C after some blocks, if there are as many."""
        scenes, until = self.chosen(width, reached)
        calls = count()

        def cut(progress: Progress) -> None:
            if next(calls) >= blocks:
                raise KeyboardInterrupt

        with suppress(Stopped):
            run(self.folder, asked(self.look, scenes, self.gate), until, progress=cut)

    @rule()
    @precondition(lambda self: self.gate.exists())
    def gets_air(self) -> None:
        self.gate.unlink()

    @rule(which=st.integers(0, 99), how=st.sampled_from(list(SPOILT)))
    @precondition(lambda self: len(self.shards()) > 1)
    def spoils(self, which: int, how: str) -> None:
        paths = sorted(path for paths in self.shards().values() for path in paths)
        path, other = paths[which % len(paths)], paths[which % len(paths) - 1]
        self.spoilt[path] = SPOILT[how](path.read_bytes(), other.read_bytes())
        path.write_bytes(self.spoilt[path])

    @rule()
    @precondition(lambda self: self.folder.is_dir())
    def is_killed_while_it_writes(self) -> None:
        (self.folder / "shards" / ".partial-left").write_bytes(b"half a shard")

    @rule(width=some, reached=some)
    def ends(self, width: int, reached: int) -> None:
        scenes, until = self.chosen(width, reached)
        before, failed = self.shards(), len(list(self.folder.glob("failures/*")))
        air, notices = not self.gate.exists(), list[str]()
        plan = asked(self.look, scenes, self.gate)
        result = run(self.folder, plan, until, notice=notices.append)
        tables = [(self.folder / name).read_bytes() for name in TABLES]
        assert tables == left_alone(self.look, scenes, until, air)
        new = len(self.shards().keys() - before.keys())
        assert new <= result.blocks_computed <= new + failed + len(self.spoilt)
        mended = [p for p, data in self.spoilt.items() if not p.exists() or p.read_bytes() != data]
        assert all(any(str(path) in said for said in notices) for path in mended)
        self.spoilt = {p: data for p, data in self.spoilt.items() if p not in mended}
        assert not (air and result.failures)
        left = len(list(self.folder.glob("failures/*")))
        assert left >= failed or any("that failed are tried again" in said for said in notices)
        assert not list(self.folder.rglob(".partial-*"))


class DisturbedWithLooks(Disturbed):
    """One with a plan that stops at a look."""

    look, widths, reached = 2, (ORDER[:4], ORDER), (4, 6, 99)


@pytest.mark.parametrize("kind", [Disturbed, DisturbedWithLooks])
def test_what_befalls_most_runs(kind: type[Disturbed]) -> None:
    """Whatever Hypothesis draws: a stop, a look, damage, and a failure that is then cured."""
    run, whole, few = kind(), (5, 1), (0, 0)
    try:
        run.stops(*whole, 3)
        run.ends(*few)
        run.is_killed_while_it_writes()
        run.spoils(1, "cut")
        run.ends(*whole)
        run.gets_air()
        run.ends(*whole)
        run.ends(*whole)
        run.ends(5, 2)
        run.ends(*whole)
    finally:
        run.teardown()


QUICK = settings(
    max_examples=8,
    stateful_step_count=6,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
TestDisturbed = Disturbed.TestCase
TestDisturbedWithLooks = DisturbedWithLooks.TestCase
TestDisturbed.settings = TestDisturbedWithLooks.settings = QUICK
