"""Wrong inputs in great numbers: one sentence and status 2, never a traceback.

`make fuzz` draws others; SEED repeats the seed that a failure names.
"""

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer
from cli_runs import TOY, Ended, faultpath

from faultpath.cli.app import build

pytestmark = pytest.mark.fuzz

JUNK = (
    *("", " ", "-", "--", ".", "nan", "inf", "-1", "0", "1e999", "true", "[]", "9" * 300),
    *("-0", "1e308", "-1e308", "5e-324", "1e-13", "gain:scale=1e308", "velocity:noise=nan"),
    *(str(2**64), "1_0", "٣", "x" * 5000, "a/" * 1500, "\0", "\x1b[31mred", "a\nb", "\u2028"),
    *("\ud800", "\u202egnp", "日本", "%s%n", "{0}", "$(id)", "'", '"', "\\", "a,b", ",", "="),
    *("a=b=c", "@", "a:b", ":", "text.txt", "folder", "loop", "nowhere/x", "/dev/null", "0,٣"),
    *("a,,b", "a,a"),
)
VERSIONS = ["--baseline", "calibrated", "--repair", "blind", "--library", "carts", "--scenes", "1"]
RIGHT = {
    "audit": [TOY, *VERSIONS, "--fault", "gain:scale=0.6", "--workers", "0", "--no-signals"],
    "check": [TOY, "--library", "carts", "--scenes", "1", "--workers", "0"],
    "init": ["my_rover"],
    "judge": ["results.csv", "--baseline", "old", "--repair", "new"],
    "map": [TOY, *VERSIONS, "--fault", "gain", "--against", "controller", "--workers", "0"],
    "scan": [TOY, "--variant", "calibrated", "--scenes", "1", "--workers", "0"],
    "replay": ["folder"],
    "report": ["folder"],
    "reproduce": ["table-99"],
    "trace": [TOY, "--library", "carts"],
    "train quadrotor": ["nobody"],
}
"""Each verb with arguments that end soon: right ones for the toy, wrong ones for what is costly."""
COSTLY = ("--executor", "--traceback", "--help", "--workers", "--judge", "--list")


def _verbs(command: Any, *names: str) -> Iterator[tuple[str, list[str]]]:
    """Yield each verb with its options that take a value."""
    for name, each in getattr(command, "commands", {}).items():
        yield from _verbs(each, *names, name)
    if not hasattr(command, "commands"):
        options = [
            each.opts[0]
            for each in command.params
            if each.param_type_name == "option" and not each.is_flag
        ]
        yield " ".join(names), [each for each in options if each not in COSTLY]


OPTIONS = dict(_verbs(typer.main.get_command(build())))


def exit_problem(line: list[object], ended: Ended) -> str:
    """Return what is wrong with how a command ended, if anything is."""
    text = ended.out + ended.err
    if "Traceback" in text or ended.status not in (0, 1, 2):
        return f"status {ended.status}: {text[-300:]}"
    if not all(row.isprintable() for row in text.splitlines() if line[-1] != "--json"):
        return "characters that steer the terminal"
    last = ended.err.splitlines()[-1:] or [""]
    if ended.status == 2 and "Usage" not in ended.out and not last[0].startswith("faultpath: "):
        return f"no sentence: {text[-300:]}"
    return ""


@pytest.fixture
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "text.txt").write_text("text\n")
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "results.csv").write_text("variant,scene,success\nold,s,0\nnew,s,1\n")
    monkeypatch.chdir(tmp_path)


def test_no_verb_is_left_out() -> None:
    """Those that the quadrotor brings are among them."""
    assert set(OPTIONS) - {"demo"} == set(RIGHT)  # the demo only takes a folder, and seconds


@pytest.mark.usefixtures("_here")
@pytest.mark.parametrize("verb", [verb for verb in RIGHT if verb in OPTIONS])
def test_junk_in_the_place_of_a_word(verb: str, fuzz_seed: int) -> None:
    rng = random.Random(f"{fuzz_seed} {verb}")
    for _ in range(12):
        line, junk = [*verb.split(), *RIGHT[verb]], rng.choice(JUNK)
        if rng.random() < 0.3 or not OPTIONS[verb]:
            at = len(verb.split())
            line[at : at + 1] = [junk]  # also where the verb takes no argument
        else:
            option = rng.choice(OPTIONS[verb])
            if option in line:
                line[line.index(option) + 1] = junk
            else:
                line += [option, junk]
        assert not exit_problem(line, faultpath(*line)), line
