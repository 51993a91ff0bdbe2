"""`faultpath.audits`: one audit for each size of a fault, in which no trial flies twice."""

import hashlib
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from faultpath.door.audit import audit
from faultpath.faults import each_size
from faultpath.trials import System

if TYPE_CHECKING:
    from faultpath.door.run import Run


def audits(
    system: str | PathLike[str] | System,
    *,
    fault: str,
    folder: str | PathLike[str] | None = None,
    **asked: Any,
) -> "tuple[Run, ...]":
    """Audit a repair under each size of a fault.

    What worker processes fly for one size, correct inputs for one, the others share. Each size is
    an audit with a record of its own, which holds within a size; `compare` decides all of them as
    one family.

    Args:
        system: As for `audit`.
        fault: With its sizes one after the other, `gain:scale=0.8,0.9,1.1`, or in a range,
            `calibration=-0.2..0.2/9`: nine sizes at equal distances, both ends among them.
        folder: In which each size gets a folder of its own; by default as for `audit`.
        asked: What else `audit` takes.

    Raises:
        UserError: As `audit`, and for a size given twice.
    """
    runs: list[Run] = []
    texts = each_size(fault)
    if folder is not None and len(texts) > 1:
        asked["share"] = asked.get("share") or Path(folder) / ".shared"
    for number, text in enumerate(texts, 1):
        place = folder if folder is None or len(texts) == 1 else Path(folder) / f"size-{number}"
        runs.append(audit(system, fault=text, folder=place, **asked))
    return tuple(runs)


def sweep_page(runs: "Sequence[Run]", folder: Path | None) -> Path:
    """Return where the page over all sizes belongs: in `folder`, else beside the runs' own."""
    if folder is not None:
        return folder / "sweep.html"
    first, names = runs[0].folder, "/".join(run.folder.name for run in runs)
    digest = hashlib.sha256(names.encode()).hexdigest()[:8]
    return first.with_name(f"{first.name}+{len(runs) - 1}-sizes-{digest}.html")
