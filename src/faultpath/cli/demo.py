"""`faultpath demo`: a reversal in seconds, from the toy that ships with faultpath."""

from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.options import FOUND, display
from faultpath.cli.options import path as as_path

_TOY = "toy.py"
_STORY = (
    "A cart: its controller and its observer read one estimate of the motor's gain. The fault: the "
    "estimate is 0.6 times the true gain. In `calibrated` the observer uses it, in `blind` the "
    "number on the nameplate.\n"
)


def demo(
    out: Annotated[
        Path | None,
        typer.Option(parser=as_path, help="Run folder; default one in runs, so it resumes."),
    ] = None,
) -> int:
    """Audit the toy that ships with faultpath: a cart whose controller and observer share one wrong
    gain, and a repair that wins where only the observer gets it."""
    import faultpath.system
    from faultpath.api.audit import audit
    from faultpath.api.display import SafeConsole
    from faultpath.report.terminal import decision

    toy = Path(faultpath.system.__file__).with_name(_TOY)
    if not toy.is_file():  # in a checkout, which a wheel takes it from
        toy = Path(__file__).resolve().parents[3] / "examples" / _TOY
    console = SafeConsole()
    console.print(_STORY, markup=False)
    variants = {"baseline": "calibrated", "repair": "blind", "fault": "gain:scale=0.6"}
    run = audit(f"{toy}:create", **variants, library="carts", folder=out, progress=display())
    console.print(decision(run.record))
    console.print(f"Report: {run.folder / 'report.html'}", markup=False, soft_wrap=True)
    console.print(f"The system: {toy}. Next, one of your own: faultpath init mine", markup=False)
    return FOUND if run.failed else 0
