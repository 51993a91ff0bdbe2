"""Wrong inputs in great numbers, drawn from a seed, and what must hold for each of them."""

import copy
import json
import os
import random
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer
from cli_runs import TOY, Ended, faultpath

from faultpath.cli.app import build

JUNK = (
    *("", " ", "-", "--", ".", "..", "/", "nan", "inf", "-1", "0", "1e999", "true", "None", "[]"),
    *("9" * 300, "9" * 5000, str(2**63), str(2**64), "-" + "9" * 30, "0x10", "1_0", "٣", "½"),
    *("x" * 300, "x" * 5000, "a/" * 1500, "\0", "a\0b", "\x1b[31mred", "a\nb", "\u2028", "\x85"),
    *(
        "\ud800",
        "\udcff\udcfe",
        "\u202egnp",
        "e\u0301",
        "日本",
        "🛩",
        "%s%n",
        "{0}",
        "$(id)",
        "`id`",
    ),
    *("'", '"', "\\", "a,b", ",", "=", "a=", "=b", "a=b=c", "@", "a@", "a:b", ":", "a:", ":b"),
    *("text.txt", "folder", "binary", "loop", "nowhere/x", "text.txt/x"),
    *("/dev/null", "/dev/zero", "1e308", "1e-320", "-inf", "0,٣", "a,,b", "a,a"),
)
STEERING = ("\x1b[31m", "\x9b2J", "\x07", "\u202e", "\u2066", "\n", "\r", "[red]", "[/b]", "\ud800")
"""Parts of names and messages that must not reach a terminal as they are."""

SYSTEMS = (
    TOY,
    "broken.py:create",
    "text.txt:create",
    "folder:create",
    "folder.py:create",
    "toy",
    "quadcopter",
    "json:loads",
    "os:getcwd",
    "nowhere.py:create",
    f"{TOY}x",
    "binary.py:create",
    *("builtins:dict", "builtins:exit", "builtins:object", "sys:exit", "sys:intern", "json", "os"),
    "mute.py:create",
)
FAULTS = (
    *("gain:scale=0.6", "gain:scale=", "gain:", "gain:delay=1e99", "gain:delay=99999999999"),
    *("gain:noise=-1", "gain:scale=0.6@", "gain:scale=0.6@observer,onset=1e30"),
    *("gain:offset=1/2", "gain:scale=0.6,0.8", "gain:erase,0.8", "velocity:freeze,for=0"),
    *("gain:erase", "gain:scale=0.6,for=1,recover=-1"),
)

OF_SYSTEMS = ("audit", "check", "map", "plan", "trace")

VERBS: dict[str, tuple[list[str], dict[str, tuple[str | None, ...]]]] = {
    "audit": (
        [TOY],
        {
            "--baseline": ("calibrated", "blind", "nobody"),
            "--repair": ("blind", "nobody"),
            "--fault": FAULTS,
            "--library": ("carts", "mine.json"),
            "--scenes": ("1", "2"),
            "--seeds": ("0", "0,1", "1,1"),
            "--metric": ("terminal_distance_m", "speed"),
            "--thresholds": ("0.1,1", "x", "nan"),
            "--workers": ("0",),
            "--out": ("run", "folder", "text.txt"),
            "--no-signals": (None,),
        },
    ),
    "report": (
        ["folder", "text.txt"],
        {"--out": ("page.html", "folder", "nowhere/page.html"), "--json": (None,)},
    ),
    "replay": (
        ["folder"],
        {
            "--scene": ("carts/000", "nowhere"),
            "--path": ("shared", "nobody"),
            "--signals": (None,),
        },
    ),
    "log": (
        ["text.csv"],
        {
            "--columns": ("px4", "map.yaml", "folder"),
            "--mass": ("1.5", "-1", "nan"),
            "--errors": ("0.1", "x", "1,1"),
        },
    ),
    "check": (
        [TOY],
        {
            "--variants": ("calibrated", "blind,nobody", ","),
            "--library": ("carts",),
            "--scenes": ("1", "2"),
            "--seed": ("0", "-1", "x"),
            "--workers": ("0",),
            "--json": (None,),
        },
    ),
    "trace": (
        [TOY],
        {
            "--variant": ("blind", "nobody"),
            "--steps": ("1", "0", "x"),
            "--scene": ("cart/001", "cart/1"),
            "--library": ("carts",),
            "--fault": FAULTS,
            "--json": (None,),
        },
    ),
    "map": (
        [TOY],
        {
            "--baseline": ("calibrated", "nobody"),
            "--repair": ("blind", "calibrated"),
            "--fault": ("gain", "gain:offset", "gain:noise", "gain:scale=2", "gian", ","),
            "--against": ("controller,observer", "observer", "observer,nobody", ","),
            "--up-to": ("0.2", "2", "-1", "nan"),
            "--spread": ("0.1", "0.1,0.2", "x", "0", "inf"),
            "--points": ("25", "3"),
            "--library": ("carts",),
            "--scenes": ("1",),
            "--workers": ("0",),
            "--out": ("m", "folder", "text.txt"),
        },
    ),
    "plan": (
        [TOY],
        {
            "--baseline": ("calibrated", "nobody"),
            "--repair": ("blind", "calibrated"),
            "--fault": FAULTS,
            "--module": ("observer", "nobody"),
            "--library": ("carts",),
            "--scenes": ("1", "0"),
            "--seeds": ("0", "1,1"),
            "--out": ("s.yaml", "folder", "text.txt"),
            "--json": (None,),
        },
    ),
    "init": (["my_rover"], {"--with": ("numpy", "gymnasium", "jax")}),
    "reproduce": (
        ["table-99"],
        {"--profile": ("x", "quick"), "--out": ("r",), "--device": ("x",), "--judge": (None,)},
    ),
    "train quadrotor": (["nobody"], {"--seed": ("77", "x"), "--out": ("t",)}),
}
"""Each verb with arguments that end soon: right ones for the toy, wrong ones for what is costly.
`None` stands for the value of an option that takes none."""

NO_VERB = "fly"
ELSEWHERE = ("--share", "--executor", "--traceback")
"""Options whose right values write outside, take minutes, or ask for a traceback."""


def flags(command: Any) -> dict[str, bool]:
    """Return the options of a verb, and whether each takes a value."""
    return {
        flag: not each.is_flag
        for each in command.params
        if each.param_type_name == "option"
        for flag in (*each.opts, *each.secondary_opts)
        if flag.startswith("--") and flag not in (*ELSEWHERE, "--help")
    }


def leaves(command: Any, *names: str) -> Iterator[tuple[str, Any]]:
    """Yield each verb with what parses it."""
    below = getattr(command, "commands", None)
    if below is None:
        yield " ".join(names), command
    for name, each in (below or {}).items():
        yield from leaves(each, *names, name)


def commands(seed: int, count: int) -> Iterator[list[str]]:
    """Yield command lines, near to right ones and far from them."""
    rng = random.Random(seed)
    verbs = dict(leaves(typer.main.get_command(build())))
    for _ in range(count):
        verb = rng.choice([*VERBS, NO_VERB])
        positional, options = VERBS.get(verb, ([], {}))
        given: dict[str, str | None] = {
            name: rng.choice(values) for name, values in options.items()
        }
        words = list(positional)
        fixed = {"--workers", *(() if verb == "audit" else ("--seed", "--profile"))}
        for _ in range(rng.randint(0, 2)):
            name = rng.choice([*options, "system", "more", "less"] if options else ["system"])
            if name == "system" and words:
                words[0] = rng.choice(SYSTEMS if verb in OF_SYSTEMS else JUNK)
            elif name == "more":
                known = flags(verbs[verb]) if verb in verbs else {}
                others = {each: known[each] for each in known if each not in options}
                flag = rng.choice(("--set", "--wind", "--device", "--nothing", *others, *others))
                given[flag] = rng.choice(JUNK) if others.get(flag, True) else None
            elif name == "less":
                given.pop(rng.choice(sorted(options)), None)
            elif name not in fixed:
                given[name] = rng.choice(JUNK)
        line = [*verb.split(), *words]
        line += [part for pair in given.items() for part in pair if part is not None]
        yield line


def texts(rng: random.Random, text: str, count: int) -> Iterator[str]:
    """Yield text with some of its characters, words and lines out of place."""
    tokens = (
        *("&a", "*a", "!!bool", "? ", "- ", "{", "[", "'", '"', "|", "\t", "\0", "\x85"),
        *("\ud800", "9" * 5000, "[" * 500, "!!python/name:os.system ", "<<: ", "2001-99-99"),
        *("\x1b", "#", ":"),
    )
    for _ in range(count):
        now = text
        for _ in range(rng.randint(1, 4)):
            at = rng.randrange(len(now) + 1)
            to = min(len(now), at + rng.choice((0, 0, 1, 8, 40)))
            now = now[:at] + rng.choice((*tokens, now[: rng.randrange(40)], "")) + now[to:]
        yield now


def documents(rng: random.Random, document: Any, count: int) -> Iterator[str]:
    """Yield JSON with some of its values changed, or cut short, or nested without end."""
    values: tuple[Any, ...] = (
        *(None, "", "\ud800", "\x1b[2J", -1, 2**64, 10**400, 1e308, float("nan"), [], {}, [[]]),
        *(True, "x" * 5000, "../../outside", "__class__"),
    )
    for _ in range(count):
        changed = copy.deepcopy(document)
        for _ in range(rng.randint(1, 3)):
            places = list(_places(changed))
            box, key = rng.choice(places[: rng.choice((5, 50, len(places)))])
            if key in box if isinstance(box, dict) else key < len(box):
                if rng.random() < 0.3:
                    del box[key]
                else:
                    box[key] = rng.choice(values)
        text = json.dumps(changed)
        kind = rng.random()
        if kind < 0.1:
            text = text[: rng.randrange(len(text))]
        elif kind < 0.15:
            text = "[" * 100_000 + text
        elif kind < 0.2:
            text = text.replace("1", "9" * 5000, 1)
        yield text


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, each in list(items):
        yield value, key
        if isinstance(each, (dict, list)):
            yield from _places(each)


def wrong(line: list[str], here: Path, seconds: float = 60.0, prints: bool = False) -> str:
    """Run a command and say what is wrong with how it ended; nothing where all is right.

    With `prints`, and with `--json`, something may be said before the sentence.
    """
    try:
        with _in_time(seconds), _writes_outside(here) as outside:
            ended = faultpath(*line)
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        return f"{line!r:.300}: {type(error).__name__}: {error!s:.300}"
    fault = _misbehaved(ended, prints or "--json" in line) or (
        f"wrote to {outside[0]}" if outside else ""
    )
    return f"{line!r:.300}: {fault}" if fault else ""


def _misbehaved(ended: Ended, prints: bool) -> str:
    if "Traceback" in ended.out + ended.err:
        return f"a traceback: {ended.err[-300:]}"
    if ended.status not in (0, 1, 2):
        return f"status {ended.status}"
    for line in (ended.out + ended.err).splitlines():
        if not line.isprintable():
            return f"characters that are not to be seen: {line!r:.400}"
    if ended.status == 2 and "Usage" not in ended.out:
        lines = ended.err.splitlines()[-1 if prints else 0 :]
        if len(lines) != 1 or not lines[0].startswith("faultpath: "):
            return f"not one sentence: {ended.err!r:.400}"
    return ""


class TooLong(BaseException):
    """A command does not end."""


@contextmanager
def _in_time(seconds: float) -> Iterator[None]:
    def stop(*_: object) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


_seen: list[Callable[[str, Any], None]] = []
_CHANGES = {
    "os.rename",
    "os.remove",
    "os.mkdir",
    "os.rmdir",
    "os.link",
    "os.symlink",
    "os.truncate",
}
_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND


def _audited(event: str, details: Any) -> None:
    for each in _seen:
        each(event, details)


sys.addaudithook(_audited)


@contextmanager
def _writes_outside(here: Path) -> Iterator[list[str]]:
    """Collect the paths outside `here` that are opened to write, made, moved or removed."""
    found: list[str] = []
    home = os.path.realpath(here)

    def watch(event: str, details: Any) -> None:
        if event == "open":
            path, _, flags = details
            paths = [path] if flags & _WRITING else []
        else:
            paths = list(details[:2]) if event in _CHANGES else []
        for path in paths:
            if not isinstance(path, (str, bytes, os.PathLike)):
                continue
            place = os.path.realpath(os.fsdecode(path))
            if not place.startswith((home, "/dev/null")) and "__pycache__" not in place:
                found.append(place)

    _seen.append(watch)
    try:
        yield found
    finally:
        _seen.remove(watch)
