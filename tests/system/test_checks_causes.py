"""A check finds what only a fault or another process shows, and says what the evidence says."""

import pytest
from checked import LOOPS, ROOT, check, failed

from faultpath.core.errors import SystemMistake, UserError
from faultpath.run.check.blocks import RecordedBlock, coarsest
from faultpath.run.check.reads import Read

pytestmark = pytest.mark.slow  # all together


@pytest.mark.parametrize(
    ("broken", "failing", "sentence"),
    [
        ("raises when near", ["trials end"], "ValueError: too near"),
        ("nan when near", ["trials end", "shape and unit"], "source 'laser' at step 1, read by"),
        ("shape when near", ["shape and unit"], "the reading of one scene has the shape [1]"),
    ],
)
def test_what_only_the_fault_brings_is_found_under_the_fault(broken, failing, sentence):
    assert failed(check(broken=broken)) == {}
    failures = failed(check(broken=broken, fault="range:scale=0.1"))
    assert list(failures) == failing
    (failure,) = failures[failing[-1]]
    assert failure.startswith("Variant 'bare', under the fault (pilot): ")
    assert sentence in failure


def test_a_fault_that_cannot_act_is_refused_and_one_that_changes_nothing_remarked():
    with pytest.raises(UserError, match="reaches neither 'bare'"):
        check(fault="range:scale=0.1@guard", variants=("bare",))
    report = check(fault="mass:scale=1")
    remarks = [remark for each in report.checks for remark in each.remarks]
    assert any("under the fault (pilot): it changed no reading" in remark for remark in remarks)


@pytest.mark.parametrize(
    ("broken", "cause"),
    [
        ("random", "every run differs: draw from the `rng` of `step` or from fa"),
        (
            "kept generator",
            "the second run in a process differs: keep what a module remembers in its `memory`",
        ),
        ("hash of a text", "processes differ: look for hash()"),
    ],
)
def test_the_cause_of_what_does_not_repeat_follows_from_runs_in_new_processes(broken, cause):
    report = check(broken=broken, workers=1, variants=("bare",), scenes=2)
    checks = {each.name: each for each in report.checks}
    (failure,) = checks["determinism"].failures
    assert cause in failure
    assert checks["pairing"].status == checks["scene independence"].status == "not judged"
    assert [name for name, each in checks.items() if each.failures] == ["determinism"]


def test_a_reader_that_has_its_value_from_elsewhere_fails_and_one_that_ignores_it_does_not():
    (failure,) = failed(check(LOOPS, broken="goes round"))["fault delivery"]
    lead = (
        "Injection point position -> pilot.feedback of variant 'plain', faulted in 4 trials, had no"
    )
    assert failure.startswith(
        f"{lead} effect, and 'pilot' wrote another order at step 1 in scene 'c'"
    )
    for broken in ("goes round, still", "ignores"):
        report = check(LOOPS, broken=broken)
        assert failed(report) == {}
        (remark,) = [remark for each in report.checks for remark in each.remarks]
        why = "effect because the output of 'pilot' never changed in any trial: order stayed what"
        assert remark.startswith(f"{lead} {why}")


def test_a_loop_of_ones_own_fails_where_an_estimator_reads_past_its_tap(tmp_path):
    text = (ROOT / "examples/dock.py").read_text("utf-8")
    mine = tmp_path / "mine.py"
    mine.write_text(
        text.replace("(before - measured)", "(before - distance)").replace(
            "step), measured", "step), distance"
        ),
        "utf-8",
    )
    (failure,) = failed(check(f"{mine}:create", library="floors"))["fault delivery"]
    assert "range -> speedometer.difference" in failure
    assert "'speedometer' wrote another range_rate" in failure


def test_scenes_are_drawn_from_the_whole_library():
    few = check(scenes=3, variants=("bare",))
    assert (len(few.scenes), few.of) == (3, 6)
    parts = [("w0", "w1"), ("w2", "w3"), ("w4", "w5")]
    assert all(scene in part for scene, part in zip(few.scenes, parts, strict=True))


def test_scenes_that_share_an_index_are_refused():
    with pytest.raises(SystemMistake, match="gives scenes 'w0' and 'w1' the index 0: number its"):
        check(broken="same index")


def test_readings_in_bfloat16_are_recorded_with_their_precision():
    torch = pytest.importorskip("torch")
    read = Read(0, "range", "pilot.approach", "laser", 0, ("a", "b"))
    value = torch.tensor([1.0, 2.5], dtype=torch.bfloat16)
    read.take(value, 2 * value)
    assert (read.low, read.high, read.altered) == (1.0, 2.5, 2)
    assert coarsest(RecordedBlock(reads=(read,))) == torch.finfo(torch.bfloat16).eps
