"""Which scenes are shown in detail, and what of them is in the page."""

from dataclasses import replace
from typing import Any

import numpy as np
from page_reader import unpack, with_system, with_traces

from faultpath.analyses.pairs import read_pairs
from faultpath.interface import Provenance
from faultpath.report.html import report_page
from faultpath.report.inputs import ReportInput
from faultpath.report.viewer import pack, viewer_data
from faultpath.run.store.signals import IN_FORCE, Signal, decode_signals, encode_signals
from faultpath.run.store.tables import TrialAddress, traces_of


def _unpacked(source: ReportInput) -> tuple[dict[str, Any], list[Any]]:
    made = viewer_data(source, read_pairs(source.trials, source.record))
    assert made is not None
    return unpack(made.packed)


def test_every_trial_is_there_to_the_centimetre(three_seeds: ReportInput) -> None:
    data, series = _unpacked(three_seeds)
    traces, seen = traces_of(three_seeds.trials), 0
    for scene in data["scenes"]:
        for pair in scene["pairs"]:
            for role, variant in (("baseline", "gru"), ("repair", "gru-dcc")):
                at = TrialAddress(variant, pair["condition"], scene["seed"], scene["scene"])
                place = pair[role]["track"]
                if place is None:
                    assert at not in traces
                    continue
                kept = np.stack(series[place : place + 2], axis=1) / 100
                assert np.abs(kept - traces[at][:, :2]).max() < 0.0051
                seen += 1
    assert seen == len(traces)
    void = [p for s in data["scenes"] for p in s["pairs"] if p["void"]]
    assert len(void) == 1
    assert "no</b> candidate" in void[0]["void"]


def test_numbers_come_out_of_a_page_as_they_went_in() -> None:
    rng = np.random.default_rng(3)
    wild = rng.integers(-(2**31), 2**31 - 1, 50, dtype=np.int64).astype(np.int32)
    series = [wild, np.empty(0, np.int32), np.arange(-7, 7, dtype=np.int32)]
    content, found = unpack(pack({"said": "<ü>"}, series))
    assert content == {"said": "<ü>"}
    assert all(np.array_equal(a, b) for a, b in zip(series, found, strict=True))


def test_a_player_with_nothing_to_play_is_not_shown(one_seed: ReportInput) -> None:
    """Without positions only scenes of which signals were recorded can be played."""
    bare = with_traces(one_seed.trials, lambda track: None)
    still = replace(with_system(one_seed, plans={}), trials=bare)
    page = report_page(still)
    assert 'id="flights"' not in page
    assert 'href="#scene=' not in page
    scene = next(iter(one_seed.system.plans))
    steps = np.arange(5, dtype=np.float32)[:, None]
    heard = {TrialAddress("gru", "shared", 0, scene): (Signal("thrust", "thrust", "N", steps),)}
    data, _ = _unpacked(replace(still, signals=heard))
    assert [each["scene"] for each in data["scenes"]] == [scene]


def test_without_positions_the_player_opens_on_what_the_plant_measures(
    one_seed: ReportInput,
) -> None:
    """Not on an error, which is the fault itself, nor on what never moves within a trial."""
    steps = np.arange(5, dtype=np.float32)[:, None]
    signals = (
        Signal("mass error at predictor.trim", "mass error", "kg", steps * 0 + 0.1),
        Signal("mass_estimate", "mass", "kg", steps * 0 + 1),
        Signal("reconstructed_wind", "wind", "m/s", steps),
        Signal("velocity_estimate", "velocity", "m/s", steps),
    )
    measured = {"mass_estimate", "velocity_estimate"}
    sources = tuple(
        source.model_copy(update={"provenance": Provenance.MEASURED})
        if source.name in measured
        else source
        for source in one_seed.system.interface.sources
    )
    interface = one_seed.system.interface.model_copy(update={"sources": sources})
    scene = next(iter(one_seed.system.plans))
    still = replace(
        with_system(one_seed, interface=interface, plans={}),
        trials=with_traces(one_seed.trials, lambda track: None),
        signals={TrialAddress("gru", "shared", 0, scene): signals},
    )
    data, _ = _unpacked(still)
    assert data["plots"][0]["title"] == "mass error"
    assert data["plots"][data["plot"]]["title"] == "velocity"


def test_signals_are_plotted_beside_what_they_are_compared_with(one_seed: ReportInput) -> None:
    steps = np.arange(5, dtype=np.float32)[:, None]

    def told(variant: int) -> tuple[Signal, ...]:
        return (
            Signal("true_wind", "wind", "m/s", steps),
            Signal("wind_again", "wind", "m/s", steps),
            Signal("reconstructed_wind", "wind", "m/s", variant + steps / 2),
            Signal("goal", "goal", "m", steps * 0 + 3),
            Signal("wind error at a.b", "wind error", "m/s", steps * 0 + 1),
            Signal(IN_FORCE, IN_FORCE, "1", np.isin(steps, (1, 2, 4)).astype(np.float32)),
        )

    scene = next(iter(one_seed.system.plans))
    heard = {TrialAddress(v, "shared", 0, scene): told(i) for i, v in enumerate(("gru", "gru-dcc"))}
    again = decode_signals(encode_signals(heard))
    assert again.keys() == heard.keys()
    data, series = _unpacked(replace(one_seed, signals=again))
    lines = ["true_wind, wind_again", "reconstructed_wind"]
    assert data["plots"] == [
        {"title": "wind error", "unit": "m/s", "lines": ["wind error at a.b"], "zero": True},
        {"title": "wind", "unit": "m/s", "lines": lines, "zero": False},
    ]
    shown = next(s for s in data["scenes"] if s["scene"] == scene)
    trial = next(p for p in shown["pairs"] if p["condition"] == "shared")["repair"]
    assert trial["faulted"] == [[1, 3], [4, 5]]
    (_, _, place, low, level) = next(line for line in trial["lines"] if line[:2] == [1, 1])
    assert np.allclose(low + level * series[place], 1 + steps[:, 0] / 2, atol=1e-3)


def test_the_player_says_where_recorded_trials_part(one_seed: ReportInput) -> None:
    steps = np.arange(5, dtype=np.float32)[:, None]

    def heard(after: int) -> tuple[Signal, ...]:
        return (Signal("reconstructed_wind", "wind", "m/s", np.where(steps < after, 0, steps)),)

    scene = next(iter(one_seed.system.plans))
    at = [TrialAddress(name, "shared", 0, scene) for name in ("gru", "gru-dcc")]
    alone = TrialAddress("gru", "predictor", 0, scene)
    signals = {at[0]: heard(9), at[1]: heard(1), alone: heard(9)}
    data, _ = _unpacked(replace(one_seed, signals=signals))
    told = {
        (of["scene"], pair["condition"]): pair["parting"]
        for of in data["scenes"]
        for pair in of["pairs"]
        if pair["parting"]
    }
    assert set(told) == {(scene, "shared")}
    parting = told[scene, "shared"]
    assert "the wind that the predictor reads is 0 m/s in gru, 1 m/s in gru-dcc" in parting["said"]
    assert [1, "readings differ"] in parting["marks"]


def test_the_player_names_only_what_is_drawn(one_seed: ReportInput) -> None:
    drawn = "From above, to scale: the dot is the start, the ring the goal."
    bare = with_system(one_seed, plans={})
    assert drawn in report_page(one_seed)
    assert drawn not in report_page(bare)
    assert "Positions to scale" in report_page(bare)
