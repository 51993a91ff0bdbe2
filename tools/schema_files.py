"""JSON Schemas of results, questions and trials of other tools, which the package brings.

They follow from the models; descriptions of fields are those of the models or the texts that stand
below the fields in their classes.
"""

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from blocks import ROOT
from pydantic import TypeAdapter
from pydantic._internal._docs_extraction import extract_docstrings_from_cls
from pydantic.json_schema import GenerateJsonSchema

from faultpath.analyses.map.model import MapResult
from faultpath.analyses.model import AuditResult
from faultpath.analyses.scan.model import ScanResult
from faultpath.run.question import AuditQuestion, MapQuestion, ScanQuestion
from faultpath.run.received.question import JudgeQuestion, Row

FOLDER = ROOT / "src" / "faultpath" / "schemas"
DIALECT = "https://json-schema.org/draft/2020-12/schema"
SCHEMAS: Mapping[str, Any] = {
    "record": AuditResult,
    "map": MapResult,
    "scan": ScanResult,
    "audit-question": AuditQuestion,
    "map-question": MapQuestion,
    "scan-question": ScanQuestion,
    "judge-question": JudgeQuestion,
    "judge-row": Row,
}
"""What each describes, by the name of its file."""


def _own(model: type) -> Iterator[type]:
    """Yield the classes of ours that declare a model's fields, a field's last one last."""
    for base in reversed(model.__mro__):
        if base.__module__.partition(".")[0] == "faultpath":
            yield base


class _Described(GenerateJsonSchema):
    """Takes the text below a field for its description."""

    def model_schema(self, schema: Any) -> Any:
        json_schema = super().model_schema(schema)
        texts: dict[str, str] = {}
        for model in _own(schema["cls"]):
            texts |= extract_docstrings_from_cls(model, use_inspect=True)
        for name, field in json_schema.get("properties", {}).items():
            if name in texts:
                field.setdefault("description", " ".join(texts[name].split()))
        return json_schema


def files() -> Mapping[Path, str]:
    """Return the text of every schema, by its file."""
    texts: dict[Path, str] = {}
    for name, model in SCHEMAS.items():
        schema = TypeAdapter(model).json_schema(schema_generator=_Described)
        text = json.dumps({"$schema": DIALECT, **schema}, indent=1, ensure_ascii=False)
        texts[FOLDER / f"{name}.schema.json"] = f"{text}\n"
    return texts
