"""Recorded flights of real vehicles: what a shared calibration error does to them."""

from faultpath.systems.flightlog.compensation import Combination, Compensation, compensation
from faultpath.systems.flightlog.flight import Flight, read_flight
from faultpath.systems.flightlog.reading import ColumnMap, read_columns

__all__ = [
    "ColumnMap",
    "Combination",
    "Compensation",
    "Flight",
    "compensation",
    "read_columns",
    "read_flight",
]
