"""Evidence on recorded windows: flights under correct inputs, and what models make of them."""

from faultpath_quadrotor.evidence.measuring import measure

__all__ = ["measure"]
