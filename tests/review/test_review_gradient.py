"""Autograd tells which tensors of the plant move an output past the taps, and where it cannot."""

from pathlib import Path

import pytest

from faultpath.review.tracing import trace_system
from faultpath.trials import SystemSpec, load_system

TORCHES = f"{Path(__file__).with_name('torch_loops.py')}:create"
TOY = f"{Path(__file__).resolve().parents[2] / 'examples' / 'toy.py'}:create"
PAST = "by a path that no tap sees; read it at a port, or declare it among the module's truths."


def trace(kind: str):
    spec = SystemSpec(name=TORCHES, options={"kind": kind})
    return trace_system(load_system(spec), spec, "plain", "any")


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("captured", "Source 'order' of module 'pilot' moves with the plant's 'true.mass'"),
        (
            "copied",
            "Source 'order' of module 'pilot' moves with its own 'memory', which holds the plant's "
            "'true.mass'",
        ),
        ("asked", "Source 'guess' of module 'guesser' moves with the plant's 'true.mass'"),
    ],
)
def test_a_tensor_that_came_past_the_taps_is_found(kind, said):
    found = trace(kind)
    past = [each.says for each in found.findings if PAST in each.says]
    assert past == [f"{said} {PAST}"]
    assert found.gradient is not None
    assert set(found.gradient.seen) == {"guesser", "pilot"}


@pytest.mark.parametrize("kind", ["", "declared"])
def test_what_comes_through_taps_or_is_declared_is_none(kind):
    found = trace(kind)
    assert (found.findings, found.gradient.failed) == ((), "")


def test_where_the_gradient_stops_it_says_so_and_numbers_are_not_seen():
    cut = trace("cut")
    assert (cut.findings, cut.gradient.unseen) == ((), ("pilot",))
    assert "The gradient stops in pilot: a path past its taps would not be seen." in (
        cut.gradient.words()
    )
    assert trace("numbers").findings == ()  # the limit that the documents name


def test_the_loop_is_left_as_it_was_and_without_torch_there_is_nothing_to_say():
    spec = SystemSpec(name=TORCHES, options={"kind": "captured"})
    system = load_system(spec)
    trace_system(system, spec, "plain", "any")
    assert not system.body.mass.requires_grad
    assert "start" not in vars(system.body)
    toy = SystemSpec(name=TOY)
    assert trace_system(load_system(toy), toy, "blind", "carts").gradient is None
