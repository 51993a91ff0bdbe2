"""A user's system in a folder of its own: a file, a helper that it imports late, and data."""

from itertools import count
from pathlib import Path

from toy_plan import plan_of
from written import written

from faultpath.run.plan import Plan

_NUMBERS = count()
_RUN = """data_files = ("push.txt",)
def run(self, variant, scenes, taps, seed):
    import {helper}
    push = {helper}.PUSH + float(Path(__file__).with_name("push.txt").read_text())
    outcomes = super().run(variant, scenes, taps, seed)
    return [replace(o, metrics={{"distance": o.metrics["distance"] + push}}) for o in outcomes]"""


class Mine:
    """The files of such a system, to be edited."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        name = f"helper_{next(_NUMBERS)}"  # no other test has imported one of this name
        self.system = written(folder, _RUN.format(helper=name), "weighed.ToySystem", file="my.py")
        self.file = folder / "my.py"
        self.helper = folder / f"{name}.py"
        self.data = folder / "push.txt"
        self.helper.write_text("PUSH = 0.0\n")
        self.data.write_text("0.0")

    def plan(self, **options: str) -> Plan:
        return plan_of(self.system, **options)
