"""Mistakes of a system's author, found where a reading becomes what a consumer gets."""

from faultpath.core.errors import SystemMistake


class TapError(SystemMistake):
    """A tap was used against what the interface declares; the sentence names the tap."""


class UndeclaredReader(TapError):
    """A consumer asked for a channel that it is not declared to read in this variant."""


class IllegalRead(TapError):
    """A reading came from another source, from a privileged one, or from the future."""


class MalformedReading(TapError):
    """A reading is not what its source declares, or steps ran backwards."""


class NotFinite(Exception):
    """The first reading at a tap is not finite. It costs its trial and not the study, because a
    fault further up may have brought it about."""


class WrittenTo(TapError):
    """A consumer wrote into what a tap gave it, and others may have read that."""


class NotDelivered(TapError):
    """A fault never reached a consumer that it names, although a scene ran past its onset."""


class FaultedElsewhere(TapError):
    """A consumer that no fault names got an altered reading."""
