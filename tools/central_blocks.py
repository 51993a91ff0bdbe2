"""The paper's central claim, its numbers and where it holds: a block, and a file of the package.

The file is what the page of a reproduction says of the claim beside its own run.
"""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import erring_blocks
import new_scenes
import paper_blocks
from blocks import TAKE_AGAIN, parsed

from faultpath.record import DecisionRecord
from faultpath.studies import shipped
from faultpath.studies.central import COLUMNS, ELSEWHERE, central, decided, of_run, state
from faultpath.tables import Line, Table
from faultpath.tables.markdown import block

_TIMES = {1: "At the paper's error", 2: "At twice the paper's error"}
"""By how large the error is, the paper's being 1."""
_PAPERS = 0.1
_FEW = "few-flights/held-out"


def files() -> Mapping[Path, str]:
    """Return the file of the package."""
    table = Table(columns=COLUMNS, lines=tuple(_besides()))
    return {ELSEWHERE: table.model_dump_json(indent=1) + "\n"}


def fill() -> str:
    """Return the block: the run of the paper that documents show, first."""
    platform = paper_blocks.present()
    if platform is None:
        return "*The paper has not been flown yet.*"
    found, _ = paper_blocks.load(platform)
    asked = found.ledger
    seeds = ", ".join(map(str, asked.seeds))
    own = of_run(found, f"At the paper's error, {asked.scenes} held-out scenes, seeds {seeds}")
    table = central([*([own] if own else []), *_besides()])
    return f"{block(table)}\n{state(asked, run='the shipped run')}"


def _besides() -> Iterator[Line]:
    for folder in new_scenes.folders():
        record = parsed(folder / new_scenes.DECIDED, DecisionRecord, TAKE_AGAIN)
        times = _TIMES[round(_size(record) / _PAPERS)]
        yield decided(record, f"{times}, {record.question.n_scenes} new scenes")
    if (erring_blocks.RUNS / erring_blocks.ERRORS).exists():
        found = parsed(erring_blocks.RUNS / erring_blocks.ERRORS, erring_blocks.Erring, TAKE_AGAIN)
        flights = erring_blocks.few_flights(found.flights)
        record = erring_blocks.record(_FEW)
        yield decided(
            record,
            f"{_TIMES[1]}, models of {flights} training flights, held-out scenes",
        )
    for platform in shipped.shipped():
        if platform != paper_blocks.present():
            line = of_run(paper_blocks.load(platform)[0], f"{_TIMES[1]}, platform {platform}")
            yield from [line] if line else []


def _size(record: DecisionRecord) -> float:
    found = re.search(r"=\+?([\d.]+)$", record.question.fault)
    assert found is not None
    return float(found[1])
