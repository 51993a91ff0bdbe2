"""The mistakes of `docs/faq.md` end in the sentences that stand there."""

import contextlib
import doctest
import io
import re
import shlex
import sys
from pathlib import Path

import pytest

from faultpath.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
REFUSED = re.compile(r"^```console refused\n\$ (.*?)\n(faultpath: [^\n]*)\n```$", re.M | re.S)
MISTAKES = REFUSED.findall((ROOT / "docs" / "faq.md").read_text("utf-8"))


def test_there_are_the_ten_most_likely_mistakes() -> None:
    assert len({said for _, said in MISTAKES}) >= 10


@pytest.mark.parametrize(("command", "said"), MISTAKES, ids=[said[11:50] for _, said in MISTAKES])
def test_a_mistake_ends_in_its_sentence(
    command: str, said: str, workspace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(workspace)
    monkeypatch.setattr(sys, "argv", shlex.split(command.replace("\\\n", "")))
    told = io.StringIO()
    with contextlib.redirect_stderr(told), pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    assert doctest.OutputChecker().check_output(said, told.getvalue().strip(), doctest.ELLIPSIS)
