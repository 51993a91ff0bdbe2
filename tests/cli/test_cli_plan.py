"""`faultpath plan` and `faultpath audit --study` from end to end."""

import json
import re
from pathlib import Path

import pytest
from cli_runs import TOY, Ended, faultpath, shards

from faultpath.decisions.plan.plan import Plan
from faultpath.decisions.plan.study import read_study


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")


def plan(*more: object, **changes: object) -> Ended:
    given = {
        "baseline": "calibrated",
        "repair": "blind",
        "fault": "gain:scale=1.25",
        "library": "carts",
        "scenes": 12,
    } | changes
    return faultpath("plan", TOY, *(p for k, v in given.items() for p in (f"--{k}", v)), *more)


def test_a_plan_is_told_written_flown_and_resumed() -> None:
    ended = plan("--fault", "slope:offset=0.2")
    assert ended.status == 0
    assert "gain_estimate comes first: 2 consumers, as speedometer" in " ".join(ended.out.split())
    assert "output of observer" in ended.out
    assert re.search(r"the largest known probe response \(0\.\d+\)", " ".join(ended.out.split()))
    assert "Written: study.yaml" in ended.out
    assert [each.name for each in read_study(Path("study.yaml")).audits] == [
        "gain_estimate",
        "observed_slope",
    ]
    flown = faultpath("audit", "--study", "study.yaml", "--trust", "--workers", 0, "--out", "runs")
    assert flown.status == 0
    assert "Fault gain:scale=1.25" in flown.out
    assert "Fault slope:offset=0.2" in flown.out
    before = {path: path.stat().st_mtime_ns for path in Path("runs").rglob("shards/*")}
    assert len(shards(Path("runs/gain_estimate"))) > 0
    again = faultpath(
        "audit", "--study=study.yaml", "--trust", "--workers", 0, "--out", "runs", "--json"
    )
    assert again.status == 0
    assert "Kept" in again.err
    for each, name in zip(json.loads(again.out), ("gain_estimate", "observed_slope"), strict=True):
        assert each["folder"] == f"runs/{name}"
        assert each["record"] == json.loads(Path("runs", name, "record.json").read_text())
    assert {path: path.stat().st_mtime_ns for path in Path("runs").rglob("shards/*")} == before


def test_json_is_the_plan_and_nothing_else_on_the_standard_output() -> None:
    ended = plan("--json", "--out", "p.yaml")
    assert ended.status == 0
    found = Plan.model_validate(json.loads(ended.out))
    assert found.study == read_study(Path("p.yaml"))
    assert found.candidates[0].rank == 1


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"repair": "calibrated"}, "name two different variants"),
        ({"repair": "bland"}, "did you mean 'blind'"),
        ({"fault": "gain:scale=1.1@observer"}, "faults every module by itself"),
        ({"fault": "odometer"}, "unknown"),
        ({"module": "nobody"}, "unknown module 'nobody'"),
        ({"scenes": 0}, "choose 1 to 100"),
        ({"seeds": "1,1"}, "each of them once"),
        ({"out": "."}, "cannot write . (it is a folder"),
    ],
)
def test_mistakes_are_a_sentence(changes: dict[str, object], said: str) -> None:
    assert said in plan(**changes).refused()
    assert not list(Path().glob("*"))


def test_a_study_takes_no_options_that_its_file_says() -> None:
    for line, idle in (
        ((TOY, "--study", "s.yaml"), TOY),
        (("--study=s.yaml", "--seeds", "0"), "--seeds"),
        (("--study", "s.yaml", "--fault=gain", "--details"), "--fault=gain and --details"),
    ):
        said = faultpath("audit", *line).refused()
        assert f"{idle} would do nothing beside --study" in said
    assert "cannot be read" in faultpath("audit", "--study", "s.yaml").refused()


def test_the_help_of_audit_names_study() -> None:
    ordinary, _ = faultpath("audit", "--help").out.split("Advanced")
    assert re.search("^│ --study ", ordinary, flags=re.MULTILINE)
    assert "--study" in faultpath("audit", "--study", "x", "--help").out
