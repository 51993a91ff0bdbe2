"""Scenes to fly through: exact geometry, a baked distance field, frozen libraries.

Submodules are imported by name, so that drawing a floor plan never loads torch:

- `scene`: the frozen record of one scene
- `geometry`: exact signed distance, for contact and ray casting
- `field`: the distance baked on a lattice, for planners
- `library`: the three frozen libraries, and a user's own
- `draw`: a floor plan as plain shapes
"""
