"""Where a source's reading becomes what a consumer gets."""

from faultpath.loop.taps.reading import (
    FaultedElsewhere,
    IllegalRead,
    MalformedReading,
    NotDelivered,
    NotFinite,
    Query,
    Reading,
    TapError,
    UndeclaredReader,
    WrittenTo,
)
from faultpath.loop.taps.receipts import (
    Receipts,
    TapCount,
    added,
    check_delivered,
)
from faultpath.loop.taps.tap import Observer
from faultpath.loop.taps.taps import ModuleTaps, Taps

__all__ = [
    "FaultedElsewhere",
    "IllegalRead",
    "MalformedReading",
    "ModuleTaps",
    "NotDelivered",
    "NotFinite",
    "Observer",
    "Query",
    "Reading",
    "Receipts",
    "TapCount",
    "TapError",
    "Taps",
    "UndeclaredReader",
    "WrittenTo",
    "added",
    "check_delivered",
]
