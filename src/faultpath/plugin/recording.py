"""For a system with further signals of recorded trials, or that uses recordings itself."""

from faultpath.run.attempt import Done, taps_of
from faultpath.run.check.recording import RecordedTrial, Recording, Values, added, trials
from faultpath.run.store.signals import Signal

__all__ = ["Done", "RecordedTrial", "Recording", "Signal", "Values", "added", "taps_of", "trials"]
