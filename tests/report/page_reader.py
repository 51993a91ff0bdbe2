"""A page as its reader has it: what stands in it, and what its script unpacks."""

import json
import re
import zlib
from base64 import b64decode
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from io import StringIO
from typing import Any

import numpy as np
from rich.console import Console, RenderableType

from faultpath.report.inputs import ReportInput
from faultpath.run.store.tables import Trace
from faultpath.run.trials import Trial, Trials


class Page(HTMLParser):
    """Tags with attributes, cells of tables, and the text that a reader sees."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.rows: list[list[str]] = []
        self.words: list[str] = []
        self._inside: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag in ("script", "style", "title", "desc"):
            self._inside.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self._inside.append("cell")

    def handle_endtag(self, tag: str) -> None:
        if tag in ("script", "style", "title", "desc", "td", "th"):
            self._inside.pop()

    def handle_data(self, data: str) -> None:
        if self._inside and self._inside[-1] == "cell":
            self.rows[-1][-1] += data
        if not self._inside or self._inside[-1] == "cell":
            self.words.append(data)

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.words))

    @property
    def ids(self) -> list[str]:
        return [a["id"] for _, a in self.tags if a.get("id")]


def printed(shown: RenderableType, width: int = 160) -> str:
    """Return what a terminal of this width shows."""
    text = StringIO()
    Console(file=text, width=width, force_terminal=False).print(shown)
    return text.getvalue()


def with_record(source: ReportInput, **changed: object) -> ReportInput:
    return replace(source, record=source.record.model_copy(update=changed))


def with_facts(source: ReportInput, **changed: object) -> ReportInput:
    return with_record(source, facts=source.record.facts.model_copy(update=changed))


def with_system(source: ReportInput, **changed: object) -> ReportInput:
    return replace(source, system=source.system.model_copy(update=changed))


def unpack(packed: str) -> tuple[dict[str, Any], list[np.ndarray]]:
    """Return the content and the series of what the viewer's `pack` made, as its script does."""
    content = json.loads(zlib.decompress(b64decode(packed)))
    return content, [np.cumsum(np.cumsum(steps)) for steps in content.pop("series")]


def with_traces(outcomes: Trials, change: Callable[[Trace], Trace | None]) -> Trials:
    """Return the trials with other positions."""
    rows: list[Trial] = []
    for row in outcomes:
        trace = row.outcome.trace
        changed = None if trace is None else change(trace)
        rows.append(replace(row, outcome=replace(row.outcome, trace=changed)))
    return Trials.of(rows)
