"""Calibration noise for training (DCC), by the same taps and faults that an audit uses."""

from collections.abc import Collection, Iterable, Mapping

from torch import Tensor

from faultpath.faults import Coupled, Fault, UniformScale
from faultpath.quadrotor.interface import quadrotor_interface
from faultpath.quadrotor.training.replay import DeliveredInputs
from faultpath.quadrotor.vehicle import CONTROL_DT_S
from faultpath.taps import Reading, Taps

CALIBRATION = ("mass", "thrust_scale")
DCC_HALF_RANGE = 0.2  # paper, Section IV-B

_EPOCHS = 100_000
"""Seeds of the faults' random numbers lie this far apart from one model seed to the next."""


def dcc(consumers: Iterable[str], half_range: float = DCC_HALF_RANGE) -> Coupled:
    """Return independent uniform noise on mass and thrust scale at `consumers`.

    Each channel has its own cause: the two factors are independent, and all consumers of a
    channel get the same one (paper, Section IV-B and appendix). Consumers that read neither are
    left alone, and one may read one channel only.
    """
    interface = quadrotor_interface()
    noise = UniformScale(half_range=half_range)
    faults = tuple(
        Fault(channel=channel, intervention=noise, cause=f"dcc/{channel}")
        for channel in CALIBRATION
    )
    readers = {name for channel in CALIBRATION for name in interface.channel(channel).consumers}
    return Coupled(name="dcc", faults=faults).striking(*sorted(readers & set(consumers)))


class Corruption:
    """What the consumers of a model under training get of each window's readings.

    Windows are the scenes of the taps and an epoch is one control step: every window has one draw
    an epoch, held throughout it, keyed by its id, the seed and the epoch. The draws come from
    streams of the faults' own, so initial weights and the order of minibatches are untouched.

    Args:
        faults: What is done to the readings; none: every consumer gets the readings themselves.
        consumers: Consumers that the model under training has.
        windows: Ids, one a row of every reading.
        seed: Seed of the model.

    Raises:
        UserError: A name is unknown, or a fault strikes nobody here.
    """

    def __init__(
        self,
        faults: Iterable[Fault | Coupled],
        consumers: Collection[str],
        windows: tuple[str, ...],
        seed: int,
    ) -> None:
        self._interface = quadrotor_interface()
        self._faults = tuple(faults)
        self._consumers = frozenset(consumers)
        self._windows = windows
        self._seed = seed
        self._taps(0)

    def deliver(self, epoch: int, readings: Mapping[str, Tensor]) -> DeliveredInputs:
        """Return what each consumer gets in an epoch, by (channel, consumer), each `[W]`.

        `readings` `[W]` are the values by channel. Raises `NotDelivered` where a fault missed a
        consumer that it names.
        """
        taps = self._taps(epoch)
        delivered = {
            (channel, consumer): taps.deliver(
                channel, consumer, Reading(value, taps.bindings[channel], 0), 0
            )
            for channel, value in readings.items()
            for consumer in self._interface.channel(channel).consumers
            if consumer in self._consumers
        }
        taps.verify(last_step=0)
        return delivered

    def _taps(self, epoch: int) -> Taps:
        return Taps(
            self._interface,
            self._faults,
            scenes=self._windows,
            dt_s=CONTROL_DT_S,
            seed=_EPOCHS * self._seed + epoch,
            consumers=self._consumers,
        )
