"""What pages say beside their tables: no sentence that somebody typed contradicts a result."""

import json
import re
from pathlib import Path

import pytest
import studies
from blocks import REFERENCE, ROOT
from documents import BLOCK, documents

PAGES = [path for path in documents() if BLOCK.search(path.read_text("utf-8"))]
FENCE = re.compile(r"^```.*?^```$", flags=re.MULTILINE | re.DOTALL)
NONE_IS = re.compile(
    r"\bno other\b.*\bsignifican"
    r"|\b(no|nothing|none|neither)\b( \S+){0,4} (is|are|was|were) (\w+ )?significan"
    r"|\bsignificant: (everything|all) else",
    flags=re.IGNORECASE,
)
UNLESS = re.compile(r"\b(where|when|if|which|that|whether|because)\b", flags=re.IGNORECASE)
"""Begins a clause that defines or supposes, and states nothing of a run."""
NO_REVERSAL = re.compile(r"\bno reversal was\b|\bdid not reverse\b|\bno ranking reversed\b")


def typed(text: str) -> list[str]:
    """Return the sentences of a page that no command writes."""
    prose = FENCE.sub("", BLOCK.sub("\n\n", text))
    paragraphs = re.split(r"\n\n|\n(?=[-#|])", prose)
    return [s for part in paragraphs for s in re.split(r"(?<=[.;?]) ", part.replace("\n", " "))]


def nulls(text: str) -> list[str]:
    """Return the typed sentences which say that nothing, or nothing else, is significant."""
    hits = ((sentence, NONE_IS.search(sentence)) for sentence in typed(text))
    return [s for s, hit in hits if hit and not UNLESS.search(s[: hit.end()])]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_that_nothing_else_is_significant_is_only_said_by_results(page: Path) -> None:
    """A table beside a typed sentence changes with its run, and the sentence does not."""
    text = page.read_text("utf-8")
    assert nulls(text) == []
    if any(NO_REVERSAL.search(sentence) for sentence in typed(text)):
        names = {match["name"].split(":")[1] for match in BLOCK.finditer(text)}
        records = [path for name in names for path in REFERENCE.glob(f"{name}*/record.json")]
        assert records
        changes = [
            change for path in records for change in json.loads(path.read_bytes())["changes"]
        ]
        assert "reversal" not in {change["turn"] for change in changes}


@pytest.mark.parametrize(
    ("sentence", "states"),
    [
        ("In rooms a smear did, and for no other error was the difference significant.", True),
        ("With both, no gain is significant.", True),
        ("Nothing is significant.", True),
        ("- **Not significant: everything else.** Under it", True),
        ("Neither is significantly ahead.", True),
        ("With both pictures its gain is not significant.", False),
        ("It is zero where nothing is significant.", False),
        ("Correlations at which neither is significantly ahead.", False),
    ],
)
def test_sentences_that_deny_an_effect_are_known(sentence: str, states: bool) -> None:
    assert bool(nulls(sentence)) == states
    generated = f"<!-- begin:latent:effects:x -->\n{sentence}\n<!-- end:latent:effects:x -->"
    assert nulls(generated) == []


@pytest.mark.parametrize(
    ("signs", "clauses"),
    [
        ((1, 0), ["significantly more often (15 % darker)", "without a significant difference ("]),
        ((-1, -1), ["significantly less often (15 % darker and shifted by 2 px)."]),
        ((0, 0), ["without a significant difference (15 % darker and shifted by 2 px)."]),
    ],
)
def test_the_answer_about_one_camera_follows_from_its_studies(
    monkeypatch: pytest.MonkeyPatch, signs: tuple[int, int], clauses: list[str]
) -> None:
    rows = [
        {"fault": fault, "effect": [0.0, -1.0, 1.0, sign]}
        for fault, sign in zip(("darker", "moved"), signs, strict=True)
    ]
    turns = {"turns": {"observation": "reversal" if signs == (-1, -1) else "none"}}
    study = {"audits": [turns, {"turns": {}}], "baseline": rows}
    monkeypatch.setattr(studies, "figures_of", lambda *name: study)
    text = studies.camera_answer(("marked", "blank"))
    lead = (
        "A reversal is significant in 2 of 4 audits." if signs == (-1, -1) else "No reversal in 4"
    )
    assert text.startswith(lead)
    assert all(text.count(clause) == 2 for clause in clauses)
    assert text.count("significantly") == 2 * len([sign for sign in set(signs) if sign])
