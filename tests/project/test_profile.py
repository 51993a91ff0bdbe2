"""A profile of the toy's audit: what becomes of a fault's text on its way to the taps."""

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import faultpath
from faultpath.decisions.question import Question
from faultpath.faults import Fault, FaultText, Intervention, resolve
from faultpath.trials.question import AuditQuestion

ROOT = Path(__file__).resolve().parents[2]
SOURCE = str(ROOT / "src" / "faultpath")
QUESTIONS = (AuditQuestion, Question)
"""They keep the text and the faults for whoever reads the run."""
READ, RESOLVED = FaultText.read.__func__.__code__, resolve.__code__  # pyright: ignore[reportFunctionMemberAccess]


class Profile:
    """Classes of instances that are, or hold, a fault or its text; and calls of what makes them."""

    def __init__(self) -> None:
        self.classes: set[type] = set()
        self.calls = Counter[object]()

    def __call__(self, frame: FrameType, event: str, result: Any) -> None:
        if not frame.f_code.co_filename.startswith(SOURCE):
            return
        if event == "call":
            self.calls[frame.f_code] += 1
        elif event == "return":
            for value in (frame.f_locals.get("self"), *members(result)):
                kind = type(value)
                ours = kind.__module__.startswith("faultpath") and not isinstance(value, type)
                if ours and kind not in self.classes and carries(value):
                    self.classes.add(kind)


def members(value: Any) -> Iterator[Any]:
    """Yield a value, or the entries of a tuple."""
    yield from value if isinstance(value, tuple) else (value,)


def carries(value: Any) -> bool:
    own = [getattr(value, slot, None) for slot in getattr(type(value), "__slots__", ())]
    fields = (value, *own, *getattr(value, "__dict__", {}).values())
    parts = (part for field in fields for part in members(field))
    return any(isinstance(part, Fault | FaultText | Intervention) for part in parts)


@pytest.mark.parametrize(
    ("fault", "audits", "interventions"),
    [
        ("gain:scale=0.6,0.8@observer", 2, 1),
        ("gain:scale=0.6 & velocity:freeze", 1, 2),
    ],
)
def test_a_fault_s_text_is_read_once_resolved_once_and_passes_five_classes(
    fault: str, audits: int, interventions: int, tmp_path: Path
) -> None:
    profile = Profile()
    sys.setprofile(profile)
    try:
        faultpath.api.audits(
            f"{ROOT / 'examples' / 'toy.py'}:create",
            baseline="calibrated",
            repair="blind",
            library="carts",
            fault=fault,
            scenes=2,
            workers=0,
            progress=False,
            signals=False,
            folder=tmp_path,
        )
    finally:
        sys.setprofile(None)
    assert profile.calls[READ] == 1
    assert profile.calls[RESOLVED] == audits
    kinds = {kind for kind in profile.classes if issubclass(kind, Intervention)}
    assert len(kinds) == interventions
    others = profile.classes - kinds - {*QUESTIONS}
    assert len(others) + 1 <= 5, others
