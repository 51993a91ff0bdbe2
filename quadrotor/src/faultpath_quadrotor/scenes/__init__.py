"""Scenes to fly through: exact geometry, a baked distance field, frozen libraries.

Modules are imported by name, so that drawing a floor plan (`prisms`) never loads torch.
"""
