"""A check passes what is sound, and names what is broken and nothing else."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from faultpath.errors import UserError
from faultpath.review.check import Asked, check_system
from faultpath.trials import SystemSpec, load_system

ROOT = Path(__file__).resolve().parents[2]
BROKEN = f"{Path(__file__).with_name('broken.py')}:create"
LOOPS = f"{Path(__file__).with_name('broken_loops.py')}:create"


def check(name: str = BROKEN, workers: int = 0, library: str = "any", **options: str):
    spec = SystemSpec(name=name, options=options)
    asked = Asked(workers=workers, library=library)
    return check_system(load_system(spec), spec, asked, lambda done, known: None)


def failed(report) -> dict[str, tuple[str, ...]]:
    return {check.name: check.failures for check in report.checks if check.status == "failed"}


NO_REPEAT = (
    "Variant 'bare' flown twice over the same scenes differs in 4 of 4, 'w0' for one (none ends "
    "otherwise, terminal_distance_m by up to N), first at step 1 in tap range -> pilot.approach, "
    "scene 'w0'; take random numbers from faultpath.streams, and look for threads, hash(), clocks "
    "and what is kept between calls."
)
SAID = {
    "raises": (
        "trials end",
        "Variant 'bare': ValueError: no air; let every trial end in an outcome, see it with "
        "`faultpath audit --workers 0`.",
    ),
    "never repeats": ("determinism", NO_REPEAT),
    "by place": (
        "scene independence",
        "Variant 'bare' flown in another order differs in 4 of 4, 'w3' for one (none ends "
        "otherwise, terminal_distance_m by up to N), first at step 1 in tap range -> "
        "pilot.approach, scene 'w3'; let nothing that scenes of one call of run() share decide a "
        "result, and draw by scene.",
    ),
    "crowded": (
        "scene independence",
        "Variant 'bare' flown without some of the scenes beside it differs in 2 of 2, 'w1' for one "
        "(1 end otherwise, terminal_distance_m by up to N), first at step 1 in tap range -> "
        "pilot.approach, scene 'w1'; let nothing that scenes of one call of run() share decide a "
        "result, and draw by scene.",
    ),
    "unpaired": (
        "pairing",
        "Bare under correct inputs and guarded under correct inputs are no pair in scene 'w0' "
        "(seed 0): their disturbances differ (disturbance_hash 'd4ffc498-bare' and "
        "'d4ffc498-guarded'); 3 more of their pairs are void for such a reason; draw what a scene "
        "meets by scene and seed, whatever the variant and the fault.",
    ),
    "hashless": (
        "pairing",
        "All 4 scenes carry the same hashes of initial state, disturbance and planner noise "
        "('none', 'none', 'none'), so nothing proves that two trials met the same conditions: hash "
        "what each scene begins with and meets.",
    ),
    "begins otherwise": (
        "pairing",
        "Source 'laser' begins otherwise in 'bare' and 'guarded' in scene 'w0', although their "
        "hashes agree; hash all that a scene begins with, and begin alike in every variant.",
    ),
    "deaf": (
        "declared reads",
        "Variant 'guarded' declares that guard.limit reads 'range', but it never did: take it out "
        "of the variant's consumers, or deliver the channel to it.",
    ),
    "nosy": (
        "declared reads",
        "Variant 'bare', tap range -> guard.limit: this variant has no such consumer; name it in "
        "the variant's consumers.",
    ),
    "of the future": (
        "declared reads",
        "Variant 'bare', tap range -> pilot.approach: the reading is of step 1, which is after "
        "step 0; deliver what is known by then.",
    ),
    "another source": (
        "declared reads",
        "Variant 'bare', tap range -> pilot.approach: the reading is of source 'sonar', but the "
        "channel is bound to 'laser'; deliver that one, or bind the channel in the variant.",
    ),
    "two readings": (
        "declared reads",
        "Variant 'guarded' gives pilot.approach and guard.limit different readings of channel "
        "'range' at step 0; deliver one reading to both, or declare a channel for each.",
    ),
    "keeps": (
        "fault delivery",
        "Tap range -> guard.limit of variant 'guarded', struck in 4 trials, delivered nothing, "
        "though it did without the fault; deliver at every step that reads, and keep nothing from "
        "one call of run() to the next.",
    ),
    "nan": (
        "shape and unit",
        "Variant 'bare': source 'laser' at step 10, read by pilot.approach, is not finite in scene "
        "'w0'; give a number at every step.",
    ),
    "shape": (
        "shape and unit",
        "tap range -> pilot.approach: the reading of one scene has the shape [1], but source "
        "'laser' is declared with []; mend one of the two.",
    ),
    "millimetres": (
        "shape and unit",
        "Source 'laser' declares a typical magnitude of 2 m, but its largest reading is "
        "2.78e+03; give it in m, or mend the declared unit or scale.",
    ),
    "fingerprint": (
        "fingerprint",
        "Built twice, the system differs in what fingerprint() returns; let fingerprint() and what "
        "the file does when it is loaded depend on nothing else.",
    ),
}


@pytest.mark.parametrize("broken", SAID)
def test_a_broken_system_fails_its_check_and_no_other(broken):
    found = failed(check(broken=broken))
    name, sentence = SAID[broken]
    assert set(found) == {name}, found
    said = [re.sub(r"by up to [0-9.e-]+", "by up to N", each) for each in found[name]]
    assert any(each.endswith(sentence) for each in said), said


@pytest.mark.parametrize(
    ("name", "library"),
    [(BROKEN, "any"), ("examples/toy.py:create", "carts"), ("examples/dock.py:create", "floors")],
)
def test_a_sound_system_passes(name, library):
    options = {"broken": ""} if name == BROKEN else {}
    report = check(name if name == BROKEN else f"{ROOT / name}", library=library, **options)
    assert failed(report) == {}
    assert {each.status for each in report.checks} == {"passed"}
    assert len(report.struck) == len({(e.variant, e.channel, e.consumer) for e in report.struck})
    assert all(0 < each.altered <= each.readings for each in report.struck)


def test_rounding_is_told_from_dependence_by_its_size():
    """A sum over scenes beside it may change a last digit; that is no shared state."""
    named = {each.name: each for each in check(broken="rounds").checks}
    assert (found := named["scene independence"]).status == "passed"
    assert re.search(r"differs by rounding alone, at most [1-9]e-1[5-7]", found.remarks[0])
    assert "the same to rounding" in found.says
    (told,) = failed(check(broken="barely crowded"))
    assert told == "scene independence"


def test_no_more_scenes_fly_together_than_the_system_takes():
    report = check(broken="one at a time")
    assert failed(report) == {}
    assert report.scenes == ("w0",)
    assert report.checks[0].says.endswith("its block_size is 1")
    (alone,) = (each for each in report.checks if each.name == "scene independence")
    assert alone.status == "not judged"


def test_a_consumer_that_ignores_its_reading_is_remarked_and_not_failed():
    report = check(broken="ignores")
    assert failed(report) == {}
    (remarks,) = (each.remarks for each in report.checks if each.remarks)
    assert remarks[0] == (
        "Tap mass -> pilot.thrust of variant 'bare', struck in 4 trials, changed nothing else, in "
        "no outcome and at no other tap; a consumer that is indifferent to it in these scenes "
        "looks like this, and so does one that uses something else than deliver() returned."
    )


@pytest.mark.parametrize(
    ("broken", "sentence"),
    [
        (
            "unused port",
            "Variant 'plain' hands 'wish' to pilot.spare, which never looks at it; take the port "
            "out of the module's reads, or use what comes there.",
        ),
        (
            "undeclared port",
            "module 'pilot' looked for channel 'place' at 'other', a port that it does not "
            "declare: add Port('place', 'other') to its reads.",
        ),
        (
            "undeclared truth",
            "module 'pilot' looked for the plant's truth 'truth', which it does not declare: add "
            "it to its truths.",
        ),
    ],
)
def test_a_modules_ports_are_what_it_looks_at(broken, sentence):
    found = failed(check(LOOPS, broken=broken))
    assert set(found) == {"declared reads"}
    assert any(each.endswith(sentence) for each in found["declared reads"]), found


def test_what_differs_from_process_to_process_takes_workers_to_see():
    assert failed(check(broken="hash of a text")) == {}
    assert set(failed(check(broken="hash of a text", workers=1))) == {"determinism"}
    found = failed(check(broken="reads a file", workers=1))
    assert set(found) == {"fingerprint"}
    (said,) = found["fingerprint"]
    assert said.endswith(
        "gains.txt is read and not named: a change there would not be noticed; name it in the "
        "property data_files."
    )


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (Asked(("bear",), workers=0), "unknown variant 'bear'; did you mean 'bare'?"),
        (Asked(scenes=7, workers=0), "cannot check 7 scenes of library 'selection': choose 1 to 6"),
    ],
)
def test_what_cannot_be_checked_is_refused(asked, said):
    spec = SystemSpec(name=BROKEN)
    with pytest.raises(UserError, match=re.escape(said)):
        check_system(load_system(spec), spec, asked, lambda done, known: None)


def _run(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from faultpath.cli.main import main; main()", "check"]
    return subprocess.run([*command, *arguments, "--workers", "0"], capture_output=True, text=True)


def test_the_command_says_it_in_lines_and_as_json():
    sound = _run(BROKEN)
    assert (sound.returncode, sound.stdout.splitlines()[-1]) == (0, "No check failed.")
    bad = _run(BROKEN, "--broken", "deaf", "--json", "--scenes", "2")
    assert bad.returncode == 1
    told = json.loads(bad.stdout)
    assert [len(each["failures"]) for each in told["checks"]] == [0, 0, 0, 0, 1, 0, 0, 0]
    assert told["struck"][0]["readings"] == 2 * 5
    assert _run(BROKEN, "--variants", "bear").returncode == 2
