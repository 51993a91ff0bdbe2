"""Where a source's reading becomes what a consumer gets."""

from faultpath.taps.errors import (
    IllegalRead,
    MalformedReading,
    NotDelivered,
    NotFinite,
    StruckElsewhere,
    TapError,
    UndeclaredReader,
    WrittenTo,
)
from faultpath.taps.reading import Query, Reading
from faultpath.taps.receipts import (
    Receipts,
    TapCount,
    added,
    check_delivered,
)
from faultpath.taps.taps import ModuleTaps, Taps
from faultpath.taps.trace import Read, Trace, TracedTaps, TraceEnded

__all__ = [
    "IllegalRead",
    "MalformedReading",
    "ModuleTaps",
    "NotDelivered",
    "NotFinite",
    "Query",
    "Read",
    "Reading",
    "Receipts",
    "StruckElsewhere",
    "TapCount",
    "TapError",
    "Taps",
    "Trace",
    "TraceEnded",
    "TracedTaps",
    "UndeclaredReader",
    "WrittenTo",
    "added",
    "check_delivered",
]
