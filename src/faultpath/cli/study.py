"""`faultpath audit --study FILE`: the audits of a study file, one after the other."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from faultpath.cli.audit import Json, tell, tell_json
from faultpath.cli.options import Executor, TimeLimit, path


def command(
    study: Annotated[Path, typer.Option(parser=path, help="Study file of `faultpath plan`.")],
    out: Annotated[
        Path | None,
        typer.Option(parser=path, help="Folder with a run folder for each audit; default runs/."),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            help="Worker processes, 0 for this process alone; default one per core if that helps."
        ),
    ] = None,
    time_limit: TimeLimit = None,
    executor: Executor = "local",
    as_json: Json = False,
) -> int:
    """Carry out the audits of a study file. The file says system, variants, faults, scenes and
    seeds; the same command resumes."""
    from faultpath.door.display import Display, SafeConsole
    from faultpath.door.planned import audit_study
    from faultpath.proposal.study import read_study

    console = SafeConsole(stderr=as_json)
    runs = audit_study(
        read_study(study),
        folder=out,
        workers=workers,
        time_limit_s=time_limit,
        executor=executor,
        progress=Display(console, ("faultpath", *sys.argv[1:])),
    )
    if as_json:
        tell_json(runs)
    return tell(console, runs)
