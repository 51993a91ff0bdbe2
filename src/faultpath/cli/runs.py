"""`faultpath runs`: the run folders that there are, with their verdicts."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from faultpath.cli.options import path

if TYPE_CHECKING:
    from rich.console import RenderableType

    from faultpath.door.listing import Listed

_DEFAULT = Path("runs")
_STYLES = {"finished": "", "unfinished": "yellow", "damaged": "bold red"}


def command(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(parser=path, help="Folders to look in and below; default runs/."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List the run folders, the latest first: kind, verdict, date, code, scenes, trials, time."""
    # What reads records takes a while to load, and a wrong option need not wait.
    from faultpath.door.listing import runs

    places = folders or ([_DEFAULT] if _DEFAULT.is_dir() else [])
    found = runs(places)
    if as_json:
        import json
        from dataclasses import asdict
        from datetime import datetime

        content = [asdict(each) for each in found]
        typer.echo(json.dumps(content, indent=1, default=datetime.isoformat))
        return
    from faultpath.door.display import SafeConsole

    console = SafeConsole()
    for each in found:
        console.print(each.folder, markup=False, highlight=False, style="bold", soft_wrap=True)
        console.print(_told(each), "")
    if not found:
        looked = ", ".join(map(str, places or [_DEFAULT]))
        console.print(f"There are no runs below {looked}.", markup=False, soft_wrap=True)


def _told(each: "Listed") -> "RenderableType":
    from rich.console import Group
    from rich.padding import Padding
    from rich.text import Text

    about = Text(f"{each.kind}, ").append(each.state, _STYLES[each.state]).append(_rest(each))
    return Padding.indent(Group(about, Text(each.words)), 2)


def _rest(each: "Listed") -> str:
    from faultpath.record.wording import counted

    parts = (
        each.date and f"{each.date:%Y-%m-%d %H:%M} UTC",
        each.fingerprint and f"code {each.fingerprint[:8]}",
        each.scenes is not None and counted(each.scenes, "scene"),
        each.state == "finished" and each.trials is not None and counted(each.trials, "trial"),
        each.wall_s is not None and _lasted(each.wall_s, each.resumed),
    )
    return "".join(f", {part}" for part in parts if part)


def _lasted(seconds: float, resumed: bool) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    text = f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s"
    if not hours and not minutes:
        text = f"{seconds:.1f} s"
    return f"last invocation {text}" if resumed else text
