"""A check passes what is sound, and names what is broken and nothing else."""

import json
import os
import re

import pytest
from checked import BROKEN, LOOPS, ROOT, check, failed
from cli_runs import faultpath
from plain import composed
from written import written

from faultpath.core.errors import SystemMistake, UserError
from faultpath.loop import Taps
from faultpath.report.sentences.checks import describe, describe_read, remedy, summary
from faultpath.run.check.judging import ENOUGH, diverged, other_names, without_room
from faultpath.run.check.results import Checked, Diverged, Ends, Faulted, NoRoom, Reads, TwoNames
from faultpath.run.check.tracing import NeverRead
from faultpath.system import Outcome, Status, writes

INDEPENDENCE = "scene independence"
SAID = {
    "raises late": ("trials end", ") in scene 'w4'; correct the system"),
    "never repeats": ("determinism", "first at step 1 in range -> pilot.approach, scene 'w0'"),
    "by place": ("scene independence", "Variant 'bare' run in another order, without"),
    "crowded": ("scene independence", "without some of the scenes beside it, differs"),
    "barely crowded": ("scene independence", "differs in"),
    "network with batch norm": ("scene independence", "wrap a torch module in"),
    "unpaired": ("pairing", "their disturbances differ"),
    "hashless": ("pairing", "All 4 scenes carry the same hashes"),
    "deaf": ("declared reads", "Variant 'guarded' declares that guard.limit reads 'range'"),
    "nosy": ("declared reads", "tap range -> guard.limit: this variant has no such reader"),
    "of the future": ("declared reads", "the reading is of step 1, which is after step 0"),
    "another source": ("declared reads", "the reading is of source 'sonar'"),
    "keeps": (
        "fault delivery",
        "Injection point range -> guard.limit of variant 'guarded', faulted in 4",
    ),
    "nan": ("shape and unit", "source 'laser' at step 10, read by pilot.approach, is not finite"),
    "shape": ("shape and unit", "'laser' declares `shape: []`"),
    "whole": ("shape and unit", "Source 'laser' gives whole numbers (int64) of unit m: what is"),
    "millimetres": ("shape and unit", "its largest reading is 2.78e+03; give it in m"),
}
NONE_ENDS = ("of the future", "another source", "shape")
"""Ways to be broken in which no trial of any variant ends."""


@pytest.mark.parametrize("broken", SAID)
def test_a_broken_system_fails_its_check_and_no_other(broken):
    if "network" in broken:
        pytest.importorskip("torch")
    failures = failed(check(broken=broken))
    name, sentence = SAID[broken]
    failures.pop("trials end", None) if broken in NONE_ENDS else None
    failures.pop("determinism", None) if broken == "keeps" else None  # what it reads differs too
    assert set(failures) == {name}, failures
    assert any(sentence in failure for failure in failures[name]), failures[name]
    assert all(failure.endswith(".") for failure in failures[name])


@pytest.mark.parametrize(
    ("name", "library"),
    [
        (BROKEN, "any"),
        ("examples/toy.py:create", "carts"),
        ("examples/dock.py:create", "floors"),
        ("examples/boat.py:create", "training"),
    ],
)
def test_a_sound_system_passes(name, library):
    report = check(name if name == BROKEN else f"{ROOT / name}", library=library)
    assert failed(report) == {}
    assert {each.status for each in report.checks} == {"passed"}


def test_where_no_trial_ends_that_check_fails_and_names_the_one_to_see():
    trials, *others = check(broken="shape").checks
    assert {other.summary for other in others} == {"no variant ran to its end"}
    assert (trials.status, trials.summary) == ("failed", "none did; see *shape and unit*")
    (failure,) = trials.failures
    assert failure.startswith("No trial of any variant ended: correct first what *shape and unit*")


@pytest.mark.parametrize("also", [(), ("pilot.approach",)], ids=["instead", "too"])
def test_a_fault_that_alters_another_tap_is_seen_without_the_taps_own_counts(monkeypatch, also):
    attach = Taps._add

    def misplaced(self, faults, dt_s, seed):
        moved = {"readers": ("guard.limit", *also)}
        guarded = ("range", "guard.limit") in self._taps
        at = [
            fault.model_copy(update=moved)
            if guarded and fault.readers == ("pilot.approach",)
            else fault
            for fault in faults
        ]
        attach(self, at, dt_s, seed)

    monkeypatch.setattr(Taps, "_add", misplaced)
    monkeypatch.setattr(Taps, "verify", lambda self: None)
    lead = (
        "Injection point range -> pilot.approach of variant 'guarded', faulted in 4 trials, "
        "altered a reading"
    )
    failures = failed(check(broken=""))["fault delivery"]
    assert any(failure.startswith(f"{lead} at range -> guard.limit too") for failure in failures)


def test_an_error_is_told_with_its_line_and_an_if_on_a_reading_with_what_to_take():
    trials = check(broken="raises").checks[0]
    assert (trials.status, trials.summary) == ("failed", "none did")
    (failure,) = trials.failures
    where = r"\(\S*broken\.py, line \d+\) in scene 'w2'; correct the system"
    assert re.match(rf"Variant 'bare': ValueError: no air {where}", failure)
    assert "np.where" in remedy("ValueError: The truth value of an array is ambiguous")


def cart(units, **variants):
    return composed(
        variants,
        dict.fromkeys(units, "1"),
        lambda rng: {"speed": rng.uniform()},
        lambda state, push, rng: {"speed": state["speed"] + push},
    )


def test_a_source_that_nobody_writes_is_looked_up_where_a_module_reads_it():
    @writes("push")
    def controller(sped):
        return sped

    line = controller._function.__code__.co_firstlineno
    sentence = rf"test_checks_check\.py, line {line}: system 'cart': module 'controller': unknown "
    sentence += "source 'sped'; did you mean 'speed'"
    with pytest.raises(SystemMistake, match=sentence):
        cart(("speed", "push"), old=[controller])


def test_a_baseline_that_always_ends_alike_leaves_an_audit_no_room():
    def ends(count: int, *others: Status) -> list[Outcome]:
        statuses = (*[Status.SUCCESS] * (count - len(others)), *others)
        return [Outcome(f"w{i}", how, 1.0, "a", "b", "c") for i, how in enumerate(statuses)]

    crashes = ends(ENOUGH, *[Status.CRASH] * ENOUGH)
    above, below = without_room({"bare": ends(ENOUGH), "guarded": ends(ENOUGH), "lost": crashes})
    assert above == NoRoom(("bare", "guarded"), succeed=True, scenes=20)
    assert below == NoRoom(("lost",), succeed=False, scenes=20)
    assert describe(above).startswith("Variants 'bare', 'guarded' succeed in all of 20 checked sce")
    assert describe(below).startswith("Variant 'lost' succeeds in none of 20 checked scenes")
    assert without_room({"bare": ends(ENOUGH - 1)}) == ()  # too few to say so
    for odd in (Status.CRASH, Status.FAILED):
        assert without_room({"bare": ends(ENOUGH, odd)}) == ()


def test_one_of_a_kind_is_counted_as_one():
    """It was "1 trials", "1 injection points" and "the first 1 steps"."""
    ends = Ends(successes=(("bare", 1, 1),), under_fault=1)
    assert summary(Checked("trials", ends)).endswith("; 1 trial ended under the fault")
    assert summary(Checked("taps", Reads(1))) == "1 injection point declared and read"
    one = Faulted(taps=1, altered=1, elsewhere=0)
    assert summary(Checked("faults", one)) == (
        "1 injection point, each faulted alone: 1 reading altered, none elsewhere"
    )
    never = NeverRead(variant="bare", channel="gain", reader="one.gain", steps=1)
    assert "but in the first step it did not" in describe_read(never)


def test_a_check_sees_what_diverged():
    assert diverged({"height": (-2.0, 3.0)}) == ()
    assert diverged({"height": (-2e259, 1)}) == (Diverged("height", 2e259),)
    sentence = describe(Diverged("height", 2e259))
    assert sentence.startswith("Source 'height' gives readings of up to 2e+259: look")


def test_a_check_says_that_a_system_is_at_its_ceiling():
    name = f"{ROOT / 'examples/toy.py'}:create"
    trials = check(name, library="carts", scenes=ENOUGH, variants=("calibrated",)).checks[0]
    assert trials.status == "passed"
    assert trials.remarks[0].startswith("Variant 'calibrated' succeeds in all of 20 checked scenes")


def test_modules_that_stand_for_each_other_under_two_names_are_a_remark():
    def named(second: str):
        @writes("slope", name=second)
        def nominal(speed):
            return speed

        @writes("slope")
        def observer(speed):
            return 2 * speed

        @writes("push")
        def controller(slope):
            return -slope

        variants = {"old": [observer, controller], "new": [nominal, controller]}
        return cart(("speed", "slope", "push"), **variants)

    (remark,) = other_names(named("nominal"), ["old", "new"])
    assert remark == TwoNames(("observer", "old"), ("nominal", "new"), ("speed",), ("slope",))
    assert describe(remark).startswith(
        "Modules 'observer' of old and 'nominal' of new read speed and write"
    )
    assert other_names(named("observer"), ["old", "new"]) == ()


@pytest.mark.parametrize(
    ("kind", "status", "remark"),
    [
        ("rounds", "passed", "differs by rounding alone, by at most [1-9]e-1[5-7]"),
        ("last digit", "not judged", "rounding cannot be told from dependence"),
        ("network", "passed", "differs by rounding alone"),
        ("network row by row", "passed", "^$"),
    ],
)
def test_rounding_is_told_from_dependence_by_its_size(kind, status, remark):
    """A sum over scenes beside it may change a last digit; that is no shared state."""
    if "network" in kind:
        pytest.importorskip("torch")
    (independence,) = (
        result for result in check(broken=kind).checks if result.name == INDEPENDENCE
    )
    assert independence.status == status
    assert re.search(remark, " ".join(independence.remarks))


def test_a_system_that_takes_one_scene_at_a_time_runs_all_that_are_asked_for():
    report = check(broken="one at a time")
    assert failed(report) == {}
    assert len(report.scenes) == 4
    assert report.checks[0].summary.startswith("8 ")


def test_a_reader_that_ignores_its_reading_is_remarked_and_not_failed():
    report = check(broken="ignores")
    assert failed(report) == {}
    (remarks,) = (each.remarks for each in report.checks if each.remarks)
    assert "Injection point mass -> pilot.thrust of variant 'bare'" in remarks[0]


@pytest.mark.parametrize(
    ("broken", "sentence"),
    [
        ("undeclared port", "add Port('position', 'other') to its reads."),
        ("undeclared truth", "the plant's truth 'true_place'"),
    ],
)
def test_a_modules_ports_are_what_it_looks_at(broken, sentence):
    failures = failed(check(LOOPS, broken=broken))
    assert set(failures) == {"trials end", "declared reads"}
    assert any(
        "'pilot'" in failure and sentence in failure for failure in failures["declared reads"]
    ), failures


@pytest.mark.parametrize(
    ("question", "sentence"),
    [({"variants": ("bear",)}, "did you mean 'bare'"), ({"scenes": 7}, "1 to 6")],
)
def test_what_cannot_be_checked_is_refused(question, sentence):
    with pytest.raises(UserError, match=sentence):
        check(**question)


def test_the_command_says_it_in_lines_and_as_json():
    line = ("check", BROKEN, "--workers", 0)
    ended = faultpath(*line)
    assert (ended.status, ended.out.splitlines()[-1]) == (0, "No check failed; 1 remark.")
    ended = faultpath(*line, "--broken", "deaf", "--json", "--scenes", 2)
    assert ended.status == 1
    report = check(broken="deaf", library="selection", scenes=2)
    assert len(failed(report)) == 1
    assert json.loads(ended.out) == report.model_dump(mode="json")


def test_a_file_that_is_read_undeclared_fails_a_check_of_its_own(tmp_path) -> None:
    (tmp_path / "gain.txt").write_text("1")
    read = "Path(__file__).with_name('gain.txt').read_text()"
    system = written(
        tmp_path, f"def run(self, *asked):\n    {read}\n    return super().run(*asked)"
    )
    os.utime(tmp_path / "gain.txt", (0, 0))
    failures = failed(check(system, library="carts"))
    assert set(failures) == {"trials end", "data files"}
    (failure,) = failures["data files"]
    assert "reads gain.txt, which it does not declare" in failure
