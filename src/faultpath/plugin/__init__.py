"""Names for packages with a system of their own, beyond `faultpath.loop`, `faultpath.system` etc.

A package imports from the engine only what these modules and the public rooms list in `__all__`.

- `system`: code that runs in a trial
- `recording`: signals beside the readings of a recorded trial
- `training`: fits and their model cards
- `work`: the same work in several processes
- `data`: files that a package makes, and the state of the code that made them
- `commands`: verbs, their options and files
- `results`: estimates of a verb, with their tables and numbers

A result names all source files that its system imports. The names are therefore split by purpose: a
trial that imports `system` and `training` depends on no verb, table or statistic.
"""
