"""Fault text: what it means, and the sentence for every mistake."""

from typing import Any

import pytest
from fault_toys import INTERFACE, calibration

from faultpath.core.errors import UserError
from faultpath.faults import (
    Bias,
    Delay,
    Drift,
    Dropout,
    Erase,
    Fault,
    FaultText,
    Freeze,
    Hold,
    Noise,
    Offset,
    Quantise,
    Scale,
    UniformScale,
    parse_fault,
    resolve,
)


def parse(text: str) -> tuple[Fault, ...]:
    return parse_fault(text, INTERFACE, {"calibration": calibration}, 0.05)


@pytest.mark.parametrize(
    ("text", "intervention"),
    [
        ("mass:scale=1.1", Scale(factor=1.1)),
        ("mass:scale=-1e-1", Scale(factor=-0.1)),
        ("mass:uniform_scale=0.2", UniformScale(half_range=0.2)),
        ("wind:offset=1/-2/0", Offset(by=(1.0, -2.0, 0.0))),
        ("wind:noise=0.1", Noise(std=0.1)),
        ("wind:noise=0.1,relative", Noise(std=0.1, relative=True)),
        ("wind:noise=0.1,relative=false", Noise(std=0.1)),
        ("mass:drift=0.1", Drift(rate_per_s=0.1)),
        ("mass:drift,walk_per_sqrt_s=0.1", Drift(walk_per_sqrt_s=0.1)),
        ("mass:bias=0.1,relative", Bias(std=0.1, relative=True)),
        ("wind:bias=0.1/0/0,time_constant_s=2", Bias(std=(0.1, 0.0, 0.0), time_constant_s=2.0)),
        ("wind:delay=5", Delay(steps=5)),
        ("wind:hold=4", Hold(every=4)),
        ("wind:freeze", Freeze()),
        ("wind:erase", Erase()),
        ("wind:erase=2", Erase(default=2.0)),
        ("wind:dropout=0.2", Dropout(probability=0.2)),
        ("wind:dropout=0.2,substitute=erase", Dropout(probability=0.2, substitute=Erase())),
        ("wind:quantise=0.5", Quantise(step_size=0.5)),
    ],
)
def test_one_channel(text: str, intervention: object) -> None:
    channel = text.partition(":")[0]
    fault = Fault.model_validate({"channel": channel, "intervention": intervention})
    assert parse(text) == resolve((fault,), INTERFACE)


def test_a_group_stands_for_its_channels() -> None:
    late, cause = Delay(steps=3), "calibration:delay"
    both = [Fault(channel=c, intervention=late, cause=cause) for c in ("mass", "thrust")]
    assert parse("calibration:delay=3") == resolve(both, INTERFACE)


@pytest.mark.parametrize(
    "text",
    [
        "mass:freeze,onset=20,for=40,recover=5@observer+predictor.trim",
        "mass:freeze@observer+predictor.trim,recover_s=0.25,for_s=2,onset_s=1.0",
        " mass:freeze @ observer + predictor.trim + observer, onset=20, for=40, recover=5",
    ],
)
def test_time_and_readers(text: str) -> None:
    assert parse(text) == (
        Fault(
            channel="mass",
            intervention=Freeze(),
            readers=("predictor.trim", "observer.wind_map"),
            onset_step=20,
            duration_steps=40,
            recovery_steps=5,
            cause="mass:freeze",
        ),
    )


def test_joined_faults_reach_each_its_own_readers() -> None:
    mass, wind = parse("mass:scale=1.1@observer & wind:freeze@predictor")
    assert mass.readers == ("observer.wind_map",)
    assert {reader.partition(".")[0] for reader in wind.readers} == {"predictor"}


def test_joined_faults_have_one_cause_and_each_its_loading() -> None:
    text = "mass:bias=0.1,relative,loading=-0.7,onset=3 & wind:bias=0.5 & calibration=0.2"
    faults = parse(text)
    assert {fault.cause for fault in faults} == {"mass:bias & wind:bias & calibration"}
    assert [(fault.channel, fault.loading, fault.onset_step) for fault in faults] == [
        *(("mass", -0.7, 3), ("wind", 1.0, 0)),
        *(("mass", 1.0, 0), ("thrust", 1.0, 0)),
    ]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "the text is empty"),
        ("mass:freeze,,", "something is missing between commas"),
        ("calibraton=1", "unknown preset 'calibraton'; did you mean 'calibration'?"),
        ("calibration", "'calibration' needs a size"),
        ("calibration=x", "'calibration' needs a number, not 'x'"),
        ("calibration=inf", "'calibration' needs a finite number, not 'inf'"),
        ("calibration=-1", "calibration=-1 leaves no positive mass or thrust"),
        ("calibration=0.1,relative", "unknown option 'relative'; known: for, for_s"),
        ("wind=3", "says nothing about what happens to 'wind'"),
        ("wid:freeze", "unknown channel 'wid'; did you mean 'wind'?"),
        ("wind:dely=5", "unknown kind 'dely'; did you mean 'delay'?"),
        ("wind:sequence", "unknown kind 'sequence'"),
        ("wind:saturate=1", "a kind of another package is known once that is installed"),
        ("wind:delay", "'delay' needs a value (steps)"),
        ("wind:delay=x", "'delay' needs a number, not 'x'"),
        ("wind:delay=1_0", "'delay' needs a number, not '1_0'"),
        ("wind:delay=٣", "'delay' needs a number, not '٣'"),
        ("wind:offset=1/٣/0", "'offset' needs a number, or several as 0.01/0, not '٣'"),
        ("mass:scale=1e-400", "'scale' needs 0, or a number that does not round to it"),
        ("mass:scale=1e-400..1/3", "'from' needs 0, or a number that does not round to it"),
        ("mass:scale=1..2/٣", "a range cannot be read"),
        ("wind:delay=5.5", "steps is 5.5, and must be a whole number"),
        ("wind:delay=-1", "steps is -1, and must be a number of at least 0"),
        ("wind:delay=1,2", "several sizes, and this takes one"),
        ("wind:noise=-1", "std must not be negative"),
        ("wind:freeze=3", "'freeze' takes no value"),
        ("mass:scale=1,factors=2", "unknown option 'factors'"),
        ("mass:scale=1,onset=1,onset=2", "option 'onset' appears twice"),
        ("mass:scale=1,onset=1,onset_s=1", "'onset' is given in steps and in seconds"),
        ("mass:scale=1,onset=x", "'onset' needs control steps, not 'x'"),
        ("mass:scale=1,onset=2.5", "onset=2.5 is not a whole number of steps, at least 0"),
        ("mass:scale=1,for=0", "for=0 is not a whole number of steps, at least 1"),
        ("mass:scale=1,for_s=0.07", "for_s=0.07 is not a whole number of steps of 0.05 s each"),
        ("mass:scale=1,onset=1e300", "onset=1e300 is not a whole number of steps"),
        ("mass:scale=1,recover=3", "'recover' needs an end to recover from"),
        ("mass:freeze@", "'@' needs a module or reader after it"),
        ("mass:freeze@a+", "'@' needs a module or reader after it"),
        ("mass:freeze@a,onset=1@b", "'@' appears twice"),
        ("wind:freeze@observer", "'observer' does not read it; its readers: predictor"),
        ("wind:freeze@predict", "unknown reader 'predict'; did you mean 'predictor'?"),
        ("mass:freeze & wind:freeze@observer", "'observer' does not read it"),
        ("mass:freeze &", "something is missing beside '&'"),
        ("mass:bias=1,2 & wind:bias=1", "joined faults take one size each"),
        ("mass:bias=1,loading=2 & wind:bias=1", "a loading is a number from -1 to 1"),
        ("mass:scale=2,loading=1 & wind:bias=1", "and of errors that are drawn"),
        ("mass:bias=1,loading=0.5", "unknown option 'loading'"),
        ("mass:offset=1/2", "offset has 2 numbers, and the reading of one scene has one number"),
        ("wind:offset=[1,2,3]", "written with '/' and without brackets, as in 0.01/0"),
        ("wind:offset=1 2 3", "'offset' needs a number, or several as 0.01/0, not '1 2 3'"),
        ("spare:freeze", "no module reads 'spare'; they read: mass, thrust, wind"),
        ("seen_wind:freeze", "modules read 'seen_wind' as 'wind'; write wind:freeze"),
    ],
)
def test_a_mistake_is_one_sentence_that_quotes_the_text(text: str, sentence: str) -> None:
    with pytest.raises(UserError) as caught:
        parse(text)
    assert str(caught.value).startswith(f"fault '{text}': ")
    assert sentence in str(caught.value)


def test_a_preset_that_returns_no_faults_is_a_mistake_of_the_system() -> None:
    alone = Fault(channel="mass", intervention=Freeze())
    presets: Any = {"one": lambda size: alone}  # which a type checker would refuse
    with pytest.raises(UserError, match="'one=1': preset 'one' of the system has to return a tup"):
        parse_fault("one=1", INTERFACE, presets, 0.05)


@pytest.mark.parametrize(
    ("text", "texts"),
    [
        ("gain:scale=0.8,0.9", ("gain:scale=0.8", "gain:scale=0.9")),
        ("c=+0.1,-0.1", ("c=+0.1", "c=-0.1")),
        (
            "v:noise=0.1,0.2,relative,onset=3@p+q",
            ("v:noise=0.1,relative,onset=3@p+q", "v:noise=0.2,relative,onset=3@p+q"),
        ),
        ("v:noise=0.1@p,0.2", ("v:noise=0.1@p", "v:noise=0.2@p")),
        ("w:offset=1/0/0,0/1/0", ("w:offset=1/0/0", "w:offset=0/1/0")),
        ("w:freeze,onset=3", ("w:freeze,onset=3",)),
        ("c=-0.2..0.2/5", ("c=-0.2", "c=-0.1", "c=0", "c=0.1", "c=0.2")),
        ("c=+1..-1/2", ("c=1", "c=-1")),
        ("g:scale=.8..1/2@p,onset=3", ("g:scale=0.8,onset=3@p", "g:scale=1,onset=3@p")),
        ("g:scale=0.8..0.9/2,1.5", ("g:scale=0.8", "g:scale=0.9", "g:scale=1.5")),
    ],
)
def test_a_text_for_each_size(text, texts):
    assert tuple(map(str, FaultText.read(text).each())) == texts


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("gain:scale=0.8,0.80", "names a size twice"),
        ("gain:freeze,0.8", "0.8 is a further size, and there is no first"),
        ("gain:scale=0.8..0.9", "write FROM..TO/COUNT"),
        ("gain:offset=1/0/0..2/0/0/3", "write FROM..TO/COUNT"),
        ("gain:scale=0.8..0.9/1000000000", "a range takes 2 to 99"),
        ("gain:scale=0.8..0.8/3", "names a size twice"),
    ],
)
def test_lists_that_are_none(text, sentence):
    with pytest.raises(UserError, match=sentence):
        FaultText.read(text)
