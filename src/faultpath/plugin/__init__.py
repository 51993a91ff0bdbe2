"""Names for packages that bring a system, beyond those of `faultpath.loop`, `faultpath.run` etc.

A package imports from the engine only what these modules and the public rooms list in `__all__`.

- `system`: what runs in a trial
- `recording`: signals beside the readings of a recorded trial
- `training`: fits and their model cards
- `work`: the same work in several processes
- `data`: files that a package makes and keeps, and the state of the code behind them
- `commands`: verbs, their options and files
- `results`: estimates of a verb, with their tables and numbers

A result names every source that its system's imports reach. The names are therefore split by who
needs them: a trial that imports `system` and `training` depends on no verb, table or statistic.
"""
