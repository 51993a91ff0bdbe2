"""Everything that README and docs show as code runs, and prints what they say it prints.

Two kinds of fenced block count. The ``python`` blocks of a document run one after another, as one
program, beside the systems that its ``faultpath init`` commands write. A ``console`` block is a
session: lines that start with ``$ `` are commands, the lines below each are its output, in which
``...`` stands for anything; a command without output below only has to succeed. Commands of
``faultpath`` and ``python`` are run; the rest (git, make, pip) are set-up and are not. All commands
share one directory, which holds ``examples/``. The word ``not-run`` after the language
(```` ```console not-run ````) keeps a block out, for what takes minutes; with ``refused`` its one
command ends in the sentence below it. An audit of every scene of
a library whose output is not shown flies eight of them. Design
notes are about the past and are left alone.
"""

import doctest
import re
import runpy
import shlex
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from subprocess import CompletedProcess

import pytest
from cli_runs import faultpath

from faultpath.run.work.executor import Here

pytestmark = pytest.mark.slow  # all together

Run = Callable[..., CompletedProcess[str]]

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = [
    path
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    if path.is_file() and "design" not in path.relative_to(ROOT).parts
]
FENCE = re.compile(r"^```(?P<info>[^\n`]+)\n(?P<body>.*?)^```\s*$", flags=re.MULTILINE | re.DOTALL)
RUNNABLE = re.compile(r"(?:\w+=\S* )*(?:faultpath|python)\b")
INIT = re.compile(r"faultpath init (\w+)")
OF_ALL_SCENES = re.compile(r"faultpath audit (?!.*--(scenes|study)\b)")
LOOSELY = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def blocks(text: str, info: str) -> Iterator[tuple[str, int]]:
    """Yield the text of each fenced block, and how many lines of the document are above it."""
    for match in FENCE.finditer(text):
        if match["info"].strip() == info:
            yield match["body"], text.count("\n", 0, match.start("body"))


def program(text: str) -> str:
    """The Python blocks as one program, each line where it stands in the document."""
    lines = [""] * (text.count("\n") + 1)
    for block, above in blocks(text, "python"):
        body = block.splitlines()
        lines[above : above + len(body)] = body
    return "\n".join(lines).rstrip()


def session(text: str, info: str = "console") -> Iterator[tuple[str, str]]:
    """The console blocks as commands with the output that is shown for each; a backslash at a
    line's end joins it with the next."""
    for block, _ in blocks(text, info):
        for part in re.split(r"^\$ ", block.replace("\\\n", ""), flags=re.MULTILINE)[1:]:
            line, _, output = part.partition("\n")
            yield line.strip(), output


def commands(text: str) -> list[tuple[str, str]]:
    """Return the commands of a document that are run, each with its output."""
    return [(line, output) for line, output in session(text) if RUNNABLE.match(line)]


def typed(line: str, run: Run) -> CompletedProcess[str]:
    """Carry out a command: one of faultpath alone in this process, which has loaded what it needs.

    A `faultpath init` writes its files whether or not another test has done so.
    """
    for name in INIT.findall(line):
        for file in (f"{name}.py", f"test_{name}.py"):
            Path(file).unlink(missing_ok=True)
    if not line.startswith("faultpath ") or set(line) & set("|&;<>$`*"):
        return run(line, shell=True)
    ended = faultpath(*shlex.split(line)[1:])
    return CompletedProcess(line, ended.status, ended.out, ended.err)


@pytest.fixture(scope="session")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One folder for all documents, so that an audit that several show is run once."""
    place = tmp_path_factory.mktemp("documents")
    (place / "examples").symlink_to(ROOT / "examples")
    return place


@pytest.fixture(autouse=True)
def _here(
    workspace: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Run all in this process: to start others takes longer than what most documents run."""
    monkeypatch.chdir(workspace)
    others = str(tmp_path_factory.getbasetemp())  # folders of tests, with a `mine` of their own
    monkeypatch.setattr(sys, "path", [each for each in sys.path if not each.startswith(others)])
    monkeypatch.syspath_prepend(workspace)
    monkeypatch.setattr("faultpath.api.systems.local", lambda workers: Here())
    monkeypatch.delitem(sys.modules, "mine", raising=False)  # of another test: `init` refuses it
    for name, value in {"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}.items():
        monkeypatch.setenv(name, value)


TEXTS = {path: path.read_text(encoding="utf-8") for path in DOCUMENTS}


@pytest.mark.parametrize(
    "document", [path for path in TEXTS if program(TEXTS[path])], ids=lambda path: path.name
)
def test_python_of_a_document_runs(document: Path, workspace: Path, run: Run) -> None:
    """An error names the line of the document."""
    for line, _ in session(TEXTS[document]):
        if INIT.match(line):
            typed(line, run)
    script = workspace / f"{document.stem}_snippets.py"
    script.write_text(program(TEXTS[document]), encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        runpy.run_path(str(script), run_name="__main__")


@pytest.mark.parametrize(
    "document", [path for path in TEXTS if commands(TEXTS[path])], ids=lambda path: path.name
)
def test_console_of_a_document_runs(document: Path, run: Run) -> None:
    checker = doctest.OutputChecker()
    for line, output in commands(TEXTS[document]):
        brief = OF_ALL_SCENES.match(line) and not output.strip()
        line += " --scenes 8" * bool(brief)
        done = typed(line, run)
        assert done.returncode == 0, f"$ {line}\n{done.stdout}{done.stderr}"
        if output.strip():
            shown = checker.check_output(output, done.stdout, LOOSELY)
            assert shown, f"$ {line}\n{done.stdout}\nis not\n{output}"


MISTAKES = list(session(TEXTS[ROOT / "docs" / "faq.md"], "console refused"))


@pytest.mark.parametrize(("line", "sentence"), MISTAKES, ids=[text[11:50] for _, text in MISTAKES])
def test_a_mistake_ends_in_the_sentence_that_the_page_has_for_it(line: str, sentence: str) -> None:
    ended = faultpath(*shlex.split(line)[1:])
    assert ended.status == 2
    assert doctest.OutputChecker().check_output(sentence, ended.err, doctest.ELLIPSIS)
