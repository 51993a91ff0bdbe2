"""For a system with further signals of recorded trials, or that uses recordings itself."""

from faultpath.run.attempt import Done, taps_of
from faultpath.run.check.recording import Recording, Trial, Values, added, trials
from faultpath.run.store.signals import Signal

__all__ = ["Done", "Recording", "Signal", "Trial", "Values", "added", "taps_of", "trials"]
