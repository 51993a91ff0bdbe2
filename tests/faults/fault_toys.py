"""A small interface with a reconstruction, for tests of faults."""

from faultpath.core.errors import UserError
from faultpath.faults import Fault, Scale
from faultpath.interface import read_interface

INTERFACE = read_interface("""
name: toy
sources:
- {name: mass_estimate, unit: kg, provenance: estimated, correlation_group: calibration}
- {name: thrust_estimate, unit: '1', provenance: estimated, correlation_group: calibration}
- {name: spare, unit: '1', provenance: measured}
- {name: seen_wind, unit: m/s, shape: [3], provenance: reconstructed}
channels:
- name: mass
  sources: [mass_estimate]
  readers: [predictor.dynamics, predictor.trim, observer.wind_map]
  erasure_default: 1.0
- {name: thrust, sources: [thrust_estimate], readers: [predictor.dynamics, observer.model]}
- name: wind
  sources: [seen_wind]
  readers: [predictor.wind_map]
  erasure_default: [0.0, 0.0, 1.0]
reconstructs: {observer: seen_wind}
""")


def calibration(error: float) -> tuple[Fault, ...]:
    if not -1 < error < 1:
        raise UserError(f"calibration={error:g} leaves no positive mass or thrust")
    return (
        Fault(channel="mass", intervention=Scale(factor=1 + error)),
        Fault(channel="thrust", intervention=Scale(factor=1 - error)),
    )
