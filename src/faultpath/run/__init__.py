"""Treatments run over identical scenes: plans, workers, the store, trials and their pairing.

A `question` becomes a `plan` in `faultpath.analyses`. From there `execution.runner` reads from top
to bottom: the plan's blocks (`plan.units_of`) go to workers (`execution.dispatch`, `work`), which
make an `attempt` at each; what comes back is stored (`execution.state`, `store`), and assembled as
one table of `trials`.
"""
