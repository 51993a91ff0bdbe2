"""Which sources may err, by how much, and which of them comes first."""

import pytest
from still import Still

from faultpath.analyses.scan.ranking import ranked
from faultpath.analyses.scan.sources import Candidate, candidates
from faultpath.core.errors import UserError
from faultpath.faults import Fault, FaultText, Scale
from faultpath.interface import read_interface
from faultpath.system import System, Variant

FACTS = """
name: sized
sources:
- {name: mass, unit: kg, provenance: estimated, correlation_group: calibration, UNSURE: 0.1}
- {name: thrust, unit: '1', provenance: estimated, correlation_group: calibration, UNSURE: 0.1}
- {name: gyro, unit: rad/s, provenance: measured, uncertainty: {std: 0.02}}
- {name: odometer, unit: m, provenance: measured, uncertainty: {half_range: 0.5}}
- {name: exact, unit: m, provenance: measured, uncertainty: {std: 0}}
- {name: twice, unit: m, provenance: measured, uncertainty: {std: 1}}
- {name: a, unit: m, provenance: measured, correlation_group: mixed, uncertainty: {std: 1}}
- {name: b, unit: m, provenance: measured, correlation_group: mixed, uncertainty: {std: 2}}
- {name: silent, unit: m, provenance: measured}
- {name: unread, unit: m, provenance: measured, uncertainty: {std: 1}}
- {name: goal, unit: m, provenance: commanded}
- {name: truth, unit: m, provenance: privileged}
channels:
- {name: mass, sources: [mass], readers: [model.mass, planner.mass]}
- {name: thrust, sources: [thrust], readers: [model.mass]}
- {name: rate, sources: [gyro], readers: [model.rate]}
- {name: place, sources: [odometer, truth], readers: [planner.place]}
- {name: exact, sources: [exact], readers: [planner.place]}
- {name: one, sources: [twice], readers: [planner.place]}
- {name: two, sources: [twice], readers: [model.rate]}
- {name: a, sources: [a], readers: [model.rate]}
- {name: b, sources: [b], readers: [model.rate]}
- {name: silent, sources: [silent], readers: [model.rate, planner.place]}
- {name: unread, sources: [unread], readers: [logger.file]}
- {name: goal, sources: [goal], readers: [planner.place]}
""".replace("UNSURE: 0.1", "uncertainty: {half_range: 0.1, relative: true}")


def calibration(size: float) -> tuple[Fault, ...]:
    scale = Scale(factor=1.0 + size)
    return tuple(Fault(channel=name, intervention=scale) for name in ("mass", "thrust"))


READ = frozenset({"model.mass", "model.rate", "planner.mass", "planner.place"})


class Sized(Still):
    name, interface, scenes = "sized", read_interface(FACTS), 1
    variants = {  # noqa: RUF012 - never changed
        "all": Variant("all", "", READ),
        "less": Variant("less", "", READ - {"planner.mass"}),
        "told": Variant("told", "", READ, {"place": "truth"}, frozenset({"truth"})),
    }


class Preset(Sized):
    fault_presets = {"calibration": calibration}  # noqa: RUF012 - never changed


def found(system: System, *given: str, variants=("less", "all")) -> dict[str, Candidate]:
    pair = [system.variants[name] for name in variants]
    return {
        each.name: each
        for each in candidates(system, pair, [FaultText.read(text) for text in given])
    }


def test_faults_are_as_large_as_what_is_declared():
    by_name = found(Sized())
    assert {name: each.fault for name, each in by_name.items() if each.fault} == {
        "calibration": "calibration:scale=1.1",
        "gyro": "rate:offset=0.02",
        "odometer": "place:offset=0.5",
    }
    assert found(Preset())["calibration"].fault == "calibration=+0.1"
    assert by_name["silent"].unsized == "declares no uncertainty"
    assert by_name["exact"].unsized == "declares that it has no error"
    assert "different uncertainties" in by_name["mixed"].unsized
    assert "feeds one and two" in by_name["twice"].unsized
    assert not {"unread", "goal", "truth"} & set(by_name)


def test_a_size_at_one_reader_leaves_the_others_theirs():
    by_name = found(Sized(), "calibration:scale=1.3@planner", "silent:offset=2@model")
    assert by_name["calibration"].fault == "calibration:scale=1.1"
    assert by_name["calibration"].at == {"planner": "calibration:scale=1.3@planner"}
    assert (by_name["silent"].fault, [*by_name["silent"].at]) == ("", ["model"])
    assert found(Sized(), "goal:offset=1@planner")["goal"].at == {
        "planner": "goal:offset=1@planner"
    }
    with pytest.raises(UserError, match="at planner has been given an error already"):
        found(Sized(), "mass:scale=1.2@planner", "mass:scale=1.3@planner.mass")


def test_a_given_error_takes_the_place_of_a_declared_one():
    by_name = found(Sized(), "rate:scale=1.5", "silent:offset=3", "mass:scale=1.2")
    assert by_name["gyro"].fault == "rate:scale=1.5"
    assert by_name["silent"].fault == "silent:offset=3"
    assert (by_name["mass"].fault, by_name["mass"].channels) == ("mass:scale=1.2", ("mass",))
    assert by_name["calibration"].fault == "calibration:scale=1.1"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("rate:scale=1.1,1.2", "needs one size"),
        ("rate:delay=2", "two signs"),
        ("rate:scale=1.1 & mass:scale=1.1", "one source"),
        ("place:scale=1.1@model", "does not read it"),
        ("unread:scale=2", "reaches no module"),
        ("rat:scale=2", "did you mean 'rate'"),
    ],
)
def test_wrong_errors_are_refused(text, said):
    with pytest.raises(UserError, match=said):
        found(Sized(), text)


UNSIZED = {"fault": "", "unsized": "declares none"}


def candidate(name: str, count: int, response: float | None = None, **more) -> Candidate:
    readers = tuple(f"m{i}.x" for i in range(count))
    given = {"fault": f"{name}:scale=2"} | more
    same = {"sources": (name,), "channels": (name,), "readers": readers}
    return Candidate(name=name, response=response, **(same | given))


def test_readers_come_first_then_the_probe():
    order = ranked(
        [
            candidate("few", 1, 9.0),
            candidate("weak", 2, 0.1),
            candidate("same", 2, 0.1),
            candidate("blank", 2),
            candidate("open", 7, **UNSIZED),
            candidate("strong", 2, 0.2),
        ]
    )
    ranks = {each.name: each.rank for each in order}
    assert ranks == {"open": 1, "strong": 2, "weak": 3, "same": 3, "blank": 5, "few": 6}
    assert list(ranks) == sorted(ranks, key=lambda name: ranks[name])
    order = ranked([candidate("late", 2, **UNSIZED), candidate("sized", 2)])
    assert [(each.name, each.rank) for each in order] == [("sized", 1), ("late", 1)]
