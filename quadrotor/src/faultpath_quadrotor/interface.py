"""The information interface of the quadrotor: facts of deployment, and the ports of its modules."""

from collections.abc import Iterable
from functools import cache
from importlib.resources import files

from faultpath.interface import Interface
from faultpath.loop import Part, Port, interface_of
from faultpath_quadrotor.perception.module import Perception
from faultpath_quadrotor.planners.module import PlannerModule
from faultpath_quadrotor.plant.module import VehiclePlant
from faultpath_quadrotor.predictors.base import PLACES, ports
from faultpath_quadrotor.predictors.module import HistoryEncoder, PredictorModule
from faultpath_quadrotor.reconstruction import DisturbanceObserver
from faultpath_quadrotor.reconstruction.base import WindModule
from faultpath_quadrotor.reconstruction.network import READS


class _Declared(Part):
    """All that any module of a kind reads and writes."""

    def __init__(self, name: str, reads: Iterable[Port], *writes: str) -> None:
        self.name, self.reads, self.writes = name, frozenset(reads), writes


@cache
def quadrotor_interface() -> Interface:
    """Return the interface that training, audits and reports share."""
    reconstruction = (Port(*read) for read in (*DisturbanceObserver.reads, *READS))
    parts = (
        _Declared(
            PredictorModule.name, ports(PLACES), *PredictorModule.writes, *HistoryEncoder.writes
        ),
        _Declared(WindModule.name, reconstruction, *WindModule.writes),
        _Declared(Perception.name, Perception.reads, *Perception.writes),
        _Declared(PlannerModule.name, PlannerModule.reads, *PlannerModule.writes),
        _Declared(VehiclePlant.name, VehiclePlant.reads),
    )
    facts = files("faultpath_quadrotor").joinpath("interface.yaml").read_text("utf-8")
    return interface_of(facts, parts)
