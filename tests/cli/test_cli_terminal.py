"""Nothing that a file or a user names can steer the terminal."""

import io

from rich.table import Table
from rich.text import Text

from faultpath.api.display import SafeConsole

STEERS = "\x1b]0;owned\x07\x1b[2J\x9b31m‮name"


def printed(*what: object) -> str:
    file = io.StringIO()
    SafeConsole(file=file, width=120).print(*what, markup=False)
    return file.getvalue()


def test_control_characters_of_names_are_shown_instead_of_sent():
    table = Table(title=Text(STEERS))
    table.add_column("path")
    table.add_row(Text(STEERS))
    for shown in (printed(STEERS), printed(Text(STEERS)), printed(table)):
        assert not set(shown) & set("\x1b\x07\x9b‮")
        assert "\\x1b[2J" in shown


def test_lines_and_styles_stay_what_they_are():
    file = io.StringIO()
    console = SafeConsole(file=file, width=40, force_terminal=True, color_system="standard")
    console.print(Text("one\ntwo", style="bold"))
    assert "\x1b[1mone\x1b[0m\n" in file.getvalue()
    assert "\\n" not in file.getvalue()
