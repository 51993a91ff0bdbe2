"""Study files: what is written is what is flown, and nothing else."""

import json
from pathlib import Path

import pytest
import yaml

import faultpath
from faultpath.api.checks import Planned, audit_study
from faultpath.core.errors import UserError
from faultpath.decisions.plan.study import read_study

SYSTEMS = Path(__file__).resolve().parent / "declared_toy.py"


@pytest.fixture(scope="module")
def planned() -> Planned:
    return faultpath.api.plan(
        f"{SYSTEMS}:logged",
        baseline="calibrated",
        repair="logged",
        library="carts",
        scenes=20,
        progress=False,
    )


@pytest.fixture
def file(planned: Planned, tmp_path: Path) -> Path:
    return planned.write(tmp_path / "study.yaml")


def changed(file: Path, change) -> Path:
    data = yaml.safe_load(file.read_text())
    change(data)
    file.write_text(json.dumps(data, indent=1))  # JSON is YAML
    return file


def fly(file: Path, folder: Path | None = None) -> tuple[faultpath.Run, ...]:
    return audit_study(read_study(file), folder=folder, workers=0, progress=False, trust=True)


def test_a_file_reads_back_as_what_was_written(planned, file):
    assert read_study(file) == planned.plan.study
    assert read_study(file).faultpath_study == 1


def test_a_file_of_ones_own_is_not_written_over(planned, file, tmp_path):
    assert planned.write(file) == file  # the same text
    file.write_text(file.read_text() + "# mine\n")
    with pytest.raises(UserError, match="is there already, and not a file that this may replace"):
        planned.write(file)
    with pytest.raises(UserError, match="it is a folder, not a file"):
        planned.write(tmp_path)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda d: d["audits"][0]["arms"].pop(), "plan anew"),
        (lambda d: d["audits"][0]["arms"][1].update(repair=[]), "what the system now has"),
        (lambda d: d.update(library_hash="other"), "library 'carts' has changed since"),
        (lambda d: d.update(faultpath_study=2), "faultpath_study: is 2, and must be 1"),
        (lambda d: d.update(audits=d["audits"] + d["audits"]), "two audits have the name"),
        (
            lambda d: d.update(audits=[d["audits"][0] | {"name": f"a{i}"} for i in range(201)]),
            "200",
        ),
        (lambda d: d["audits"][0].update(arms=2 * d["audits"][0]["arms"]), "have the path 'co"),
        (lambda d: d.update(scenes=True), "line .*scenes: .*a whole number"),
        (lambda d: d.update(seeds=[0, True]), "seeds: True is not a seed"),
        (lambda d: d.update(seeds=[10**4000]), "out of range"),
        (lambda d: d.update(seeds=[1, 1]), "each of them once"),
        (lambda d: d["audits"][0].update(name="../out"), r"audits\[0\].name"),
        (lambda d: d["audits"][0].update(fault="gian:scale=2"), "unknown channel 'gian'"),
    ],
)
def test_what_the_system_does_not_have_is_refused_before_anything_flies(
    file, tmp_path, change, said
):
    with pytest.raises(UserError, match=said):
        fly(changed(file, change), tmp_path / "runs")
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"- 1\n", "and must be a group of fields"),
        (b"a: 2001-99-99", "a: is no field"),
        (b"a: !!python/name:os.system x", "tags are not read"),
    ],
)
def test_files_that_are_no_studies(tmp_path, text, said):
    path = tmp_path / "study.yaml"
    path.write_bytes(text)
    with pytest.raises(UserError, match=said):
        read_study(path)


@pytest.mark.parametrize("name", ["nowhere.yaml", "/dev/zero"])
def test_places_that_are_no_files(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError, match="study file"):
        read_study(Path(name))
