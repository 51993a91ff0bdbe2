"""`faultpath plan` and `faultpath audit --study` from end to end."""

import json
import re
from pathlib import Path

import pytest
import yaml
from cli_runs import TOY, Ended, faultpath, flags

from faultpath.decisions.plan.plan import Plan
from faultpath.decisions.plan.study import read_study


def plan(*more: object, **options: object) -> Ended:
    asked: dict[str, object] = {
        "baseline": "calibrated",
        "repair": "blind",
        "fault": "gain:scale=1.25",
        "library": "carts",
        "scenes": 12,
    }
    return faultpath("plan", TOY, *flags(asked | options), *more)


def test_a_plan_is_told_written_flown_and_resumed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    ended = plan("--fault", "slope:offset=0.2")
    assert ended.status == 0
    assert "gain_estimate comes first: 2 readers, as speedometer" in " ".join(ended.out.split())
    assert "output of observer" in ended.out
    assert re.search(r"moves the commands most \(0\.\d+ of their", " ".join(ended.out.split()))
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
    line = ("--study=study.yaml", "--trust", "--workers", 0, "--out", "runs", "--json")
    again = faultpath("audit", *line)
    assert again.status == 0
    assert "Kept" in again.err
    for each, name in zip(json.loads(again.out), ("gain_estimate", "observed_slope"), strict=True):
        assert each["folder"] == f"runs/{name}"
        assert each["record"] == json.loads(Path("runs", name, "record.json").read_text())
    assert {path: path.stat().st_mtime_ns for path in Path("runs").rglob("shards/*")} == before


@pytest.mark.parametrize(
    ("condition", "role", "actual"),
    [
        ("correct", "repaired", "correct"),
        ("shared", "attribution", "shared"),
        ("controller", "shared", "attribution"),
        ("observer", "attribution", "repaired"),
    ],
)
def test_a_role_that_a_condition_does_not_have_is_refused(
    condition: str, role: str, actual: str
) -> None:
    assert plan("--out", "s.yaml").status == 0
    study = yaml.safe_load(Path("s.yaml").read_text())
    (arm,) = [arm for arm in study["audits"][0]["arms"] if arm["path"] == condition]
    assert arm["role"] == actual
    arm["role"] = role
    Path("s.yaml").write_text(yaml.safe_dump(study))
    ended = faultpath("audit", "--study", "s.yaml", "--trust", "--workers", 0)
    assert (ended.status, ended.err.count("\n")) == (2, 1)
    assert f"calls '{condition}' {role}, and it is {actual}" in ended.err
    assert not Path("runs").exists()


def test_json_is_the_plan_and_nothing_else_on_the_standard_output() -> None:
    ended = plan("--json", "--out", "p.yaml")
    assert ended.status == 0
    found = Plan.model_validate(json.loads(ended.out))
    assert found.study == read_study(Path("p.yaml"))
    assert found.candidates[0].rank == 1


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ({"repair": "bland"}, ("'bland'", "'blind'")),
        ({"fault": "odometer"}, ("'odometer'",)),
        ({"module": "nobody"}, ("'nobody'",)),
        ({"out": "."}, ("folder",)),
    ],
)
def test_a_mistake_is_one_sentence_and_leaves_nothing(
    options: dict[str, object], names: tuple[str, ...]
) -> None:
    plan(**options).refused(*names)
    assert not list(Path().glob("*"))
