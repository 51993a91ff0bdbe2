"""The JSON Schemas that the package brings are those of its models, and fit what is written."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import schema_files

ROOT = Path(__file__).resolve().parents[2]
RESULTS = [
    path
    for name in ("record", "map", "scan")
    for path in sorted((ROOT / "docs" / "reference").glob(f"*/{name}.json"))
]
VERSIONS = {"baseline": "old", "repair": "new"}
FITTING = [
    (
        "audit-question",
        VERSIONS | {"fault": "gain:scale=0.6", "seeds": [0, 1], "thresholds": "1,2"},
    ),
    ("map-question", VERSIONS | {"fault": "gain", "against": ["controller", "observer"]}),
    ("scan-question", {"variant": "old", "fault": ["gain:scale=1.2"], "seeds": "0,1"}),
    ("judge-question", VERSIONS | {"columns": {"scene": "episode"}}),
    ("judge-row", {"variant": "old", "scene": 7, "success": True, "reward": 0.5}),
]
WRONG = [
    ("audit-question", VERSIONS),
    ("audit-question", VERSIONS | {"fault": "gain:scale=0.6", "scene": 4}),
    ("map-question", VERSIONS | {"fault": "gain"}),
    ("scan-question", {"variant": "old", "trials": "no"}),
    ("judge-question", VERSIONS | {"cluster": "model"}),
    ("judge-row", {"variant": "old", "scene": 7}),
]


def validator(name: str) -> Any:
    path = schema_files.FOLDER / f"{name}.schema.json"
    schema = json.loads(path.read_text("utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_there_is_none_that_no_model_has() -> None:
    """Their contents are compared with the models as every generated document is."""
    assert set(schema_files.FOLDER.iterdir()) == set(schema_files.files())


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: path.parent.name)
def test_stored_results_fit(path: Path) -> None:
    result = json.loads(path.read_text("utf-8"))
    validator(path.stem).validate(result)
    assert not validator(path.stem).is_valid({**result, "format": "none"})


@pytest.mark.parametrize(
    ("name", "content", "fits"), [*((*c, True) for c in FITTING), *((*c, False) for c in WRONG)]
)
def test_what_is_taken_fits_and_nothing_else(name: str, content: Any, fits: bool) -> None:
    assert validator(name).is_valid(content) is fits
