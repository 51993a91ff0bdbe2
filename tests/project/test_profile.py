"""A profile of the toy's audit: what a fault's text, an effect and a question pass on their way."""

import ast
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest

import faultpath
from faultpath.analyses.facts import ComparisonFacts
from faultpath.analyses.model import AuditResult
from faultpath.cli.main import main
from faultpath.faults import Fault, FaultText, Intervention, resolve
from faultpath.loop.corruption import Corruption
from faultpath.report.effects import effect_rows
from faultpath.run.question import AuditCall, AuditQuestion
from faultpath.stats.effects import success_effect

pytestmark = pytest.mark.slow  # all together

ROOT = Path(__file__).resolve().parents[2]
SOURCE = str(ROOT / "src" / "faultpath")
SCENES = 11
"""So many that an effect is a number which nothing else is."""
MOST = 100
"""Instances of a class that are looked into: what carries an effect or a question has few."""
QUESTIONS = (AuditCall, AuditQuestion, ComparisonFacts)
"""They keep the text and the faults for whoever reads the run."""
READ, RESOLVED = FaultText.read.__func__.__code__, resolve.__code__  # pyright: ignore[reportFunctionMemberAccess]


class Profile:
    """Classes of instances that carry something, and calls of functions."""

    def __init__(self, carries: Callable[[Any], bool], rooms: tuple[str, ...] = ("",)) -> None:
        self.carries, self.rooms = carries, tuple(f"{SOURCE}/{room}" for room in rooms)
        self.counted: dict[object, bool] = {}
        self.classes: set[type] = set()
        self.calls = Counter[object]()
        self.seen = Counter[type]()

    def __call__(self, frame: FrameType, event: str, result: Any) -> None:
        code = frame.f_code
        if (counted := self.counted.get(code)) is None:
            counted = self.counted[code] = code.co_filename.startswith(self.rooms)
        if not counted:
            return
        if event == "call":
            self.calls[code] += 1
        elif event == "return":
            for value in (frame.f_locals.get("self"), *members(result)):
                kind = type(value)
                if not is_ours(value) or kind in self.classes or self.seen[kind] > MOST:
                    continue
                self.seen[kind] += 1
                if self.carries(value):
                    self.classes.add(kind)


def is_ours(value: Any) -> bool:
    """Return whether a value is an instance of a class of faultpath."""
    return type(value).__module__.startswith("faultpath") and not isinstance(value, type)


def members(value: Any) -> Iterator[Any]:
    """Yield a value, or the entries of a tuple."""
    yield from value if isinstance(value, tuple) else (value,)


def fields(value: Any) -> list[Any]:
    """Return what an instance holds."""
    slots = (getattr(value, slot, None) for slot in getattr(type(value), "__slots__", ()))
    entries = value if isinstance(value, tuple) else ()
    return [*slots, *getattr(value, "__dict__", {}).values(), *entries]


def numbers(value: Any, depth: int = 0) -> Iterator[float]:
    """Yield the numbers in a value, however deep in other instances of ours."""
    if isinstance(value, float):
        yield value
    elif depth < 7:
        inside = fields(value) if is_ours(value) else ()
        inside = value.values() if isinstance(value, Mapping) else inside
        inside = value if isinstance(value, list | tuple) and not is_ours(value) else inside
        for part in list(inside)[:200]:
            yield from numbers(part, depth + 1)


def carries_fault(value: Any) -> bool:
    parts = (part for field in (value, *fields(value)) for part in members(field))
    return any(isinstance(part, Fault | FaultText | Intervention) for part in parts)


def is_question(value: Any) -> bool:
    names = getattr(value, "__dict__", {})
    return (names.get("baseline"), names.get("repair")) == ("calibrated", "blind")


def audited(folder: Path, *profiles: Profile, **question: Any) -> AuditResult:
    """Run the toy's audits with their reports in these profiles, and return the last result."""

    def observe(*event: Any) -> None:
        for profile in profiles:
            profile(*event)

    sys.setprofile(observe if profiles else None)
    try:
        runs = faultpath.api.audits(
            f"{ROOT / 'examples' / 'toy.py'}:create",
            baseline="calibrated",
            repair="blind",
            library="carts",
            workers=0,
            progress=False,
            signals=False,
            folder=folder,
            **question,
        )
    finally:
        sys.setprofile(None)
    return runs[-1].record


@pytest.mark.parametrize(
    ("fault", "resolved", "interventions"),
    [
        ("gain:scale=0.6,0.8@observer", 2, 1),
        ("gain:scale=0.6 & velocity:freeze", 2, 2),
    ],
)
def test_a_fault_s_text_is_read_once_resolved_once_and_passes_five_classes(
    fault: str, resolved: int, interventions: int, tmp_path: Path
) -> None:
    profile = Profile(carries_fault)
    audited(tmp_path, profile, fault=fault, scenes=2)
    assert profile.calls[READ] == 1
    assert profile.calls[RESOLVED] == resolved  # a size, or a part, each
    kinds = {kind for kind in profile.classes if issubclass(kind, Intervention)}
    assert len(kinds) == interventions
    others = profile.classes - kinds - {*QUESTIONS}
    assert len(others) + 1 <= 5, others


def test_an_effect_passes_eight_classes_and_a_question_four(tmp_path: Path) -> None:
    """From the outcomes to the page, those included that hold what holds it."""
    options: dict[str, Any] = {"fault": "gain:scale=0.6", "scenes": SCENES}
    record = audited(tmp_path / "first", **options)
    (value,) = (effect.value for effect in record.effects if effect.condition == "observer")
    rooms = ("stats", "analyses", "report", "api", "cli")
    effect = Profile(lambda part: value in numbers(part), rooms)

    def question(holder: Any) -> bool:
        return any(is_question(part) for part in (holder, *fields(holder)))

    questions = Profile(question, rooms)
    audited(tmp_path / "second", effect, questions, **options)
    assert {"Contrast", "Effect", "AuditResult"} <= {kind.__name__ for kind in effect.classes}
    assert len(effect.classes) <= 8, effect.classes
    assert {AuditCall, AuditQuestion} <= questions.classes
    assert len(questions.classes) <= 4, questions.classes


def given(frame: FrameType) -> set[int]:
    """Return which objects are arguments of a call, alone or in a tuple or a dictionary."""
    code, flags = frame.f_code, (0x4, 0x8)  # *args and **kwargs
    count = code.co_argcount + code.co_kwonlyargcount + sum(bool(code.co_flags & f) for f in flags)
    arguments = [frame.f_locals.get(name) for name in code.co_varnames[:count]]
    inside = [part for part in arguments if isinstance(part, tuple)]
    inside += [tuple(part.values()) for part in arguments if isinstance(part, dict)]
    several = [*arguments, *(part for parts in inside for part in parts)]
    return {id(p) for p in several if is_ours(p) or (isinstance(p, str | tuple | dict) and p)}


def test_at_most_18_functions_hand_on_what_they_got_between_command_and_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On the calls from the command to a tap, to a computed effect, and to its row in the page."""
    ends = {Corruption.apply.__code__, success_effect.__code__, effect_rows.__code__}
    stacks: dict[CodeType, list[tuple[CodeType, set[int]]]] = {}

    def observe(frame: FrameType, event: str, result: Any) -> None:
        if event != "call" or frame.f_code not in ends or frame.f_code in stacks:
            return
        stack, outer = stacks.setdefault(frame.f_code, []), frame
        while outer:
            if outer.f_code.co_filename.startswith(SOURCE):
                stack.insert(0, (outer.f_code, given(outer)))
            outer = outer.f_back

    options = "--baseline calibrated --repair blind --library carts --fault gain:scale=0.6"
    system = f"{ROOT / 'examples' / 'toy.py'}:create"
    more = ("--scenes", "3", "--workers", "0", "--no-signals", "--out", str(tmp_path))
    monkeypatch.setattr(sys, "argv", ["faultpath", "audit", system, *options.split(), *more])
    sys.setprofile(observe)
    try:
        with suppress(SystemExit):
            main()
    finally:
        sys.setprofile(None)
    assert stacks.keys() == ends
    passed = {code for stack in stacks.values() for code, _ in stack}
    handing = {
        code
        for stack in stacks.values()
        for (code, mine), (_, of_next) in pairwise(stack)
        if mine & of_next
    }
    assert main.__code__ in passed
    assert len(handing) <= 18, sorted(code.co_qualname for code in handing)


def test_a_class_has_at_most_fifteen_fields() -> None:
    sizes: dict[str, int] = {}
    for file in Path(SOURCE).rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.ClassDef):
                fields = [part for part in node.body if isinstance(part, ast.AnnAssign)]
                fields = [part for part in fields if "ClassVar" not in ast.unparse(part.annotation)]
                sizes[f"{file.name}: {node.name}"] = len(fields)
    assert not {name: size for name, size in sizes.items() if size > 15}
