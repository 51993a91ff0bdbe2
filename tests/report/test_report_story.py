"""The first screen tells what was faulted and decided, and nothing else."""

import re
from collections.abc import Callable

import pytest
from page_reader import with_facts, with_record, with_system

from faultpath.analyses.model import Condition
from faultpath.faults import Fault, Scale
from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput
from faultpath.report.taps import Fork, fork_panel, forks

IMPERATIVE = re.compile(r"\b(Ask|Do not|Don't|Choose|Prefer|Use|Take|Compare|Deploy|Keep)\b")
EQUAL = dict.fromkeys(("correct", "predictor", "reconstruction", "shared"), (0.5, 0.5))


def screen(source: ReportInput, until: str = "frequency") -> str:
    """Return the words of the page above a section: the first screen, and who gets the fault."""
    page = report_page(source)
    found = page[page.index("<h1") : page.index(f'<section aria-labelledby="{until}"')]
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", found))


def states(fork: Fork) -> list[list[str]]:
    return [[f"{r.module}: {r.state}" for r in readers] for _, _, readers in fork.variants]


def with_conditions(source: ReportInput, change: Callable[[Condition], Condition]) -> ReportInput:
    return with_record(source, conditions=tuple(map(change, source.record.conditions)))


def test_each_condition_shows_who_gets_the_fault(one_seed: ReportInput) -> None:
    told = {fork.title: fork for fork in forks(one_seed)}
    assert list(told) == ["Predictor only", "Reconstruction only", "Shared fault"]
    alone = ["predictor: correct readings", "reconstruction: wrong readings"]
    assert states(told["Reconstruction only"]) == [alone, alone]
    both = ["predictor: wrong readings", "reconstruction: wrong readings"]
    assert states(told["Shared fault"]) == [both, both]
    assert [fork.everywhere for fork in told.values()] == [False, False, True]
    assert "wrong for all" in fork_panel(told["Shared fault"])


@pytest.mark.parametrize("readers", [("*",), ("predictor.trim",)])
def test_the_fault_is_in_words_whoever_gets_it(one_seed: ReportInput, readers) -> None:
    fault = Fault(channel="mass", readers=readers, intervention=Scale(factor=0.6))
    assert "mass scaled by 0.6</" in report_page(with_facts(one_seed, faults=(fault,)))


SCREENS = {
    "a reversal": {},
    "three trainings": {"seeds": (0, 1, 2)},
    "four scenes": {"n_scenes": 4},
    "ties": {"n_scenes": 40, "chances": EQUAL},
    "no pair where the fault is shared": {"n_scenes": 40, "lost": "shared"},
}


@pytest.mark.parametrize("name", SCREENS)
def test_the_first_screen_is_what_was_approved(name: str, make, approved) -> None:
    source = make(**{"void": False, "library": "held-out"} | SCREENS[name])
    approved(name, screen(source, "pairs").strip().replace(". ", ".\n"))


def test_each_number_stands_once_on_the_first_screen(one_seed: ReportInput) -> None:
    said = screen(one_seed)
    open_ = said[: said.index("what would change this")]
    for effect in one_seed.record.effects:
        shown = f"[{effect.low or 0.0:.1f}, {effect.high or 0.0:.1f}]".replace("-", "−")
        assert open_.count(shown) == 1
        assert open_.count(f"{effect.value:+.1f}".replace("-", "−")) <= 2


def test_a_module_that_does_not_read_the_fault_is_grey_and_says_why(one_seed: ReportInput) -> None:
    baseline, repair = one_seed.system.variants
    kept = tuple(name for name in repair.readers if name != "reconstruction.head")
    blind = with_system(one_seed, variants=(baseline, repair.model_copy(update={"readers": kept})))

    def untouched(condition: Condition) -> Condition:
        update = {
            "readers": tuple(c for c in condition.readers if c in kept),
            "faulted": tuple(tap for tap in condition.faulted if tap.reader in kept),
        }
        return condition.model_copy(update=update)

    blind = with_conditions(blind, untouched)
    (_, alone, shared) = forks(blind)
    assert states(alone)[1] == ["predictor: correct readings", "reconstruction: does not read it"]
    assert shared.everywhere
    assert 'class="absent"' in fork_panel(alone)


def test_the_delivery_log_decides_what_is_drawn_as_faulted(one_seed: ReportInput) -> None:
    def silent(condition: Condition) -> Condition:
        taps = tuple(tap.model_copy(update={"altered_steps": 0}) for tap in condition.faulted)
        return condition.model_copy(update={"faulted": taps[:3], "baseline_faulted": ()})

    shared = forks(with_conditions(one_seed, silent))[-1]
    assert not shared.everywhere
    assert states(shared) == [
        ["predictor: correct readings", "reconstruction: correct readings"],
        ["predictor: gets it unchanged", "reconstruction: correct readings"],
    ]
    some = with_conditions(one_seed, lambda p: p.model_copy(update={"faulted": p.faulted[:3]}))
    assert states(forks(some)[-1])[1][0] == "predictor: partly wrong"


@pytest.mark.parametrize("n", [1, 2, 4])
@pytest.mark.parametrize("ties", [False, True])
def test_with_too_few_scenes_the_screen_says_so_and_asks_for_nothing(
    n: int, ties: bool, make: Callable[..., ReportInput]
) -> None:
    source = make(
        void=False, n_scenes=n, library="held-out", **({"chances": EQUAL} if ties else {})
    )
    said = screen(source)
    assert "Too few scenes" in said
    assert said.count("too few scenes") == len(source.record.conditions)
    assert "succeeds more often" not in said
    assert "What follows" not in said
    assert not IMPERATIVE.search(said)
