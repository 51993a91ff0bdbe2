"""`faultpath probe`: what it prints, what it leaves, and how mistakes about it end."""

import json
from pathlib import Path

import numpy as np
import pytest
from cli_runs import TOY, faultpath

from faultpath.evidence import EvidenceTable, Measured
from faultpath.store.evidence import read_evidence


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def instant(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Measure at once: every variant moves by the length of its name, in cm."""
    calls: list[object] = []

    def measure(measurements, scenes, folder, workers=1, progress=None):
        calls.append((tuple(measurements), scenes, folder, workers))
        folder.mkdir(parents=True, exist_ok=True)
        windows = tuple(f"s{i // 3}" for i in range(12)), np.arange(12)
        return EvidenceTable(
            {
                asked: Measured(*windows, np.full(12, len(asked.subject) / 100))
                for asked in measurements
            }
        )

    monkeypatch.setattr("faultpath.trials.load_measurer", lambda name: measure)
    return calls


PROBE = ("probe", "quadrotor", "--variants", "wm-a,wm-a+dcc")


def test_a_table_names_the_response_and_its_ratio_to_the_first(instant, tmp_path):
    ended = faultpath(*PROBE, "--set", "wind=L3", "--scenes", 4, "--seeds", "0,1", "--workers", 1)
    assert ended.status == 0, ended.err
    rows = [line.split() for line in ended.out.splitlines() if line.startswith("calibration")]
    assert rows[0] == ["calibration=+0.1", "wm-a", "4.0", "[4.0,", "4.0]", "–"]
    assert rows[1][1:3] == ["wm-a+dcc", "8.0"]
    assert rows[1][5:] == ["2.00", "[2.00,", "2.00]"]
    ((measurements, scenes, folder, workers),) = instant
    assert (scenes, str(folder), workers) == (4, "runs/probe", 1)
    assert len(measurements) == 4
    assert {m.recording.name for m in measurements} == {"selection:true-parameter:0:wind-L3"}
    assert len(read_evidence(tmp_path / "runs/probe/evidence.parquet")) == 4


def test_json_is_all_that_is_printed_and_is_what_the_folder_keeps(instant, tmp_path):
    wish = ("--perturb", "mass:scale=1.1", "--perturb", "history_code:shuffle")
    ended = faultpath(*PROBE, *wish, "--json", "--out", tmp_path / "kept")
    assert ended.err == ""
    probe = json.loads(ended.out)
    assert probe == json.loads((tmp_path / "kept/probe.json").read_text())
    assert [row["perturbation"] for row in probe["rows"][::2]] == list(wish[1::2])
    assert [row["response_cm"]["value"] for row in probe["rows"][:2]] == [4.0, 8.0]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("probe",), ["system", "probe --help"]),
        (("probe", TOY, "--variants", "a"), ["offers no measurements", "quadrotor"]),
        (("probe", "quadrotor", "--variants", ""), ["--variants", "empty"]),
        (("probe", "quadrotor", "--variants", "wm-a,wm-a"), ["'wm-a' twice"]),
        (("probe", "quadrotor", "--variants", "wm-x"), ["'wm-x'", "wm-a"]),
        ((*PROBE, "--perturb", "velocity:noise=1"), ["'velocity:noise=1'", "mass"]),
        ((*PROBE, "--perturb", "wnd:scale=2"), ["'wnd'", "did you mean"]),
        ((*PROBE, "--recorded-with", "oracle"), ["'oracle'", "true-parameter"]),
        ((*PROBE, "--library", "nowhere"), ["'nowhere'", "selection"]),
        ((*PROBE, "--scenes", "0"), ["0 scenes", "1 to 100"]),
        ((*PROBE, "--seeds", "x"), ["--seeds 'x'"]),
        ((*PROBE, "--set", "wind=L9"), ["'L9'"]),
    ],
    ids=lambda value: " ".join(value[1:]) if isinstance(value, tuple) else "",
)
def test_a_mistake_ends_in_one_sentence_and_leaves_nothing(arguments, says, tmp_path):
    sentence = faultpath(*arguments).refused()
    for part in says:
        assert part in sentence
    assert list(tmp_path.iterdir()) == []
