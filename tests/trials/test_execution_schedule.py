"""Who does what next."""

from faultpath.trials.arm import Arm
from faultpath.trials.declared import Library, SceneRef
from faultpath.trials.execution.schedule import Schedule, Task, Unit, plan

SCENES = tuple(SceneRef(f"s{i}", i) for i in range(10))
LIBRARY = Library("ten", SCENES, "hash")
ARMS = tuple(Arm(variant="v", seed=seed) for seed in range(3))


def _units(scenes: tuple[SceneRef, ...] = SCENES) -> tuple[Unit, ...]:
    return plan(ARMS, scenes, 4, LIBRARY, "fingerprint")


def test_blocks_are_places_in_the_library():
    assert [unit.scenes for unit in _units()[:: len(ARMS)]] == [
        ("s0", "s1", "s2", "s3"),
        ("s4", "s5", "s6", "s7"),
        ("s8", "s9"),
    ]
    part = _units(SCENES[2:9])
    assert [unit.scenes for unit in part[:: len(ARMS)]] == [
        ("s2", "s3"),
        ("s4", "s5", "s6", "s7"),
        ("s8",),
    ]
    shared = {unit.key for unit in part} & {unit.key for unit in _units()}
    assert shared == {unit.key for unit in part if unit.block == 1}


def test_a_key_names_everything_that_decides_a_result():
    (one,) = plan(ARMS[:1], SCENES[:1], 4, LIBRARY, "fingerprint")
    others = (
        *plan(ARMS[1:2], SCENES[:1], 4, LIBRARY, "fingerprint"),
        *plan(ARMS[:1], SCENES[1:2], 4, LIBRARY, "fingerprint"),
        *plan(ARMS[:1], SCENES[:1], 4, Library("ten", SCENES, "other"), "fingerprint"),
        *plan(ARMS[:1], SCENES[:1], 4, LIBRARY, "other"),
    )
    assert len({one.key, *(other.key for other in others)}) == 5
    assert plan(ARMS[:1], SCENES[:1], 1, LIBRARY, "fingerprint")[0].key == one.key


def _next(schedule: Schedule, worker: int) -> Task:
    task = schedule.take(worker)
    assert task is not None
    return task


def test_workers_keep_to_their_blocks_and_the_short_one_comes_last():
    schedule = Schedule(_units())
    blocks = [(_next(schedule, 0).unit.block, _next(schedule, 1).unit.block) for _ in ARMS]
    assert blocks == [(0, 1)] * 3
    assert _next(schedule, 1).unit.block == 2


def test_a_worker_without_a_block_of_its_own_helps():
    schedule = Schedule(_units(SCENES[:4]))
    assert [_next(schedule, worker).unit.arm.seed for worker in (0, 1, 0)] == [0, 1, 2]
    assert schedule.take(1) is None


def test_what_is_put_back_comes_next():
    schedule = Schedule(_units())
    first = _next(schedule, 0)
    singles = [Task(first.unit, (scene,)) for scene in first.scenes]
    schedule.put(singles)
    assert [_next(schedule, 0).scenes for _ in singles] == [task.scenes for task in singles]
