"""Where a source's reading becomes what a consumer gets."""

from faultpath.taps.counts import TapCount, added
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
from faultpath.taps.query import Query
from faultpath.taps.reading import Reading
from faultpath.taps.receipts import Missed, Receipt, Receipts, StrikeReceipt, check_delivered
from faultpath.taps.tap import StrikeState
from faultpath.taps.taps import ModuleTaps, Taps

__all__ = [
    "IllegalRead",
    "MalformedReading",
    "Missed",
    "ModuleTaps",
    "NotDelivered",
    "NotFinite",
    "Query",
    "Reading",
    "Receipt",
    "Receipts",
    "StrikeReceipt",
    "StrikeState",
    "StruckElsewhere",
    "TapCount",
    "TapError",
    "Taps",
    "UndeclaredReader",
    "WrittenTo",
    "added",
    "check_delivered",
]
