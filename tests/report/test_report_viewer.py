"""Which scenes are shown in detail, and where two flights part."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from faultpath.report.inputs import ReportInput
from faultpath.report.pairing import Pair, read_pairs
from faultpath.report.viewer import choose, parting_step, viewer_data
from faultpath.trials import Outcome, Status


def test_most_telling_scenes_come_first(one_seed: ReportInput) -> None:
    pairs = read_pairs(one_seed.outcomes, one_seed.record)
    chosen = choose(one_seed.record, one_seed.traces, pairs)
    assert len(chosen) == 6
    assert [s.rank for s in chosen] == sorted(s.rank for s in chosen)
    first = chosen[0]
    shared = first.pairs["shared"].sign
    assert shared != 0
    assert -shared in first.pattern


def test_a_scene_is_told_by_what_happened_under_the_shared_fault(one_seed: ReportInput) -> None:
    """The repair's shared path may strike no more taps than one of its isolated ones."""
    record = one_seed.record
    widest = next(path for path in record.paths if path.name == "predictor")
    paths = [p.model_copy(update={"consumers": widest.consumers}) for p in record.paths]
    source = replace(one_seed, record=record.model_copy(update={"paths": tuple(paths)}))
    pairs = read_pairs(source.outcomes, source.record)
    for shown, told in zip(
        choose(source.record, source.traces, pairs),
        viewer_data(source.record, source.traces, source.plans, pairs)["scenes"],
        strict=True,
    ):
        shared = shown.pairs["shared"].sign
        assert ("with the fault shared" in told["why"]) == (shown.rank in (0, 2))
        assert shown.rank not in (0, 2) or shared != 0


def test_choice_is_fixed_and_never_repeats_a_scene(three_seeds: ReportInput) -> None:
    pairs = read_pairs(three_seeds.outcomes, three_seeds.record)
    chosen = choose(three_seeds.record, three_seeds.traces, pairs)
    scenes = [s.any_pair.scene for s in chosen]
    assert len(set(scenes)) == len(scenes) == 6
    assert [
        s.any_pair.scene for s in choose(three_seeds.record, three_seeds.traces, pairs[::-1])
    ] == scenes
    assert "doorways-017" not in scenes


def test_patterns_differ_where_they_can(one_seed: ReportInput) -> None:
    pairs = read_pairs(one_seed.outcomes, one_seed.record)
    patterns = [s.pattern for s in choose(one_seed.record, one_seed.traces, pairs)]
    assert len(set(patterns)) == len(patterns)


def test_without_disagreement_the_distance_decides(one_seed: ReportInput) -> None:
    pairs = [_concordant(p) for p in read_pairs(one_seed.outcomes, one_seed.record)]
    chosen = choose(one_seed.record, one_seed.traces, pairs)
    assert {s.rank for s in chosen} == {4}
    gaps = [s.gap_m for s in chosen]
    assert gaps == sorted(gaps, reverse=True)


def _concordant(pair: Pair) -> Pair:
    def failing(trial: Outcome | None) -> Outcome | None:
        return None if trial is None else replace(trial, status=Status.CRASH)

    if pair.void_reason is not None:
        return pair
    return replace(pair, baseline=failing(pair.baseline), repair=failing(pair.repair))


def test_fewer_scenes_than_places(make: Callable[..., ReportInput]) -> None:
    source = make(n_scenes=4, void=False)
    pairs = read_pairs(source.outcomes, source.record)
    assert len(choose(source.record, source.traces, pairs)) == 4


def test_tracks_are_kept_to_the_centimetre(one_seed: ReportInput) -> None:
    pairs = read_pairs(one_seed.outcomes, one_seed.record)
    shown = viewer_data(one_seed.record, one_seed.traces, one_seed.plans, pairs)["scenes"][0]
    pair = shown["pairs"][0]
    flown = one_seed.traces.positions["gru", pair["path"], shown["seed"], shown["scene"]]
    kept = np.array(pair["baseline"]["track_cm"]).reshape(-1, 3) / 100
    assert np.abs(kept - flown).max() < 0.0051


def test_parting_is_the_first_step_beyond_half_a_metre() -> None:
    a = np.zeros((10, 3), dtype=np.float32)
    b = a.copy()
    b[4, 0] = 0.5
    b[6:, 0] = 0.51
    assert parting_step(a, b) == 6
    assert parting_step(a, b[:6]) is None
    assert parting_step(a, a) is None
