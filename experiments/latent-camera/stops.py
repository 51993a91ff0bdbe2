"""Say how many scenes sequential audits took, and from which share of trials with the fault on
their repair is ahead.

    python experiments/latent-camera/stops.py RUN [RUN ...] > selection-stops.json
"""

import json
import sys

from faultpath import open_run


def row(folder: str) -> dict:
    """Return what one audit came to; `until` is what it was to stop at."""
    record = open_run(folder).record
    shares = {share.condition: share.words for share in record.break_even}
    return {
        "repair": record.question.repair,
        "until": record.question.stop_when,
        "scenes": record.stopped.scenes,
        "reached": record.stopped.reached,
        "break_even": shares,
    }


print(json.dumps([row(folder) for folder in sys.argv[1:]], indent=1))
