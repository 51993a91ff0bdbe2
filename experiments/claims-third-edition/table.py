"""Print the tables of README.md: answers to the paper's claims on one run, before and after.

python experiments/claims-third-edition/table.py BEFORE AFTER

Both are a `reproduction.json` of the same trials. README.md says by which commits.
"""

import sys
from pathlib import Path

from faultpath_paper.answers import ClaimVerdict, Reproduction
from faultpath_paper.report.words import estimate, interval, typeset

from faultpath.decisions.tables.escapes import markdown

CHANGED = {
    "C01": "the order is one of estimates, not of detected differences",
    "C07": "“by less” compares estimates, no interval has to leave out 0",
    "C12": "lower and higher errors are estimates",
    "C13": "too lenient: WM-U+DCC has to complete 99 of 100 scenes at every error, and WM-A+DCC to "
    "fail at the most negative one; that WM-U's range widens is not asked any more",
    "C14": "another probe: the steps of each history are shuffled; the exchange is reported beside",
    "C15": "too lenient: the cost under correct calibration has to be detected",
    "C16": "the order is one of estimates",
    "C17": "too narrow: free space as well as obstacles",
    "C18": "a platform claim; in free space the true wind is paired with three zero inputs",
    "C19": "the true wind flies once",
    "C20": "the zero input flies once",
    "C22": "too strict: a lower mean of three seeds, no detected difference",
    "C28": "DOB flies once, so that its own changes are of one seed",
    "C29": "too strict: detected by the paper's interval alone; DOB flies once",
    "C30": "“changes less” and “recovers less” are estimates",
    "C32": "too lenient: neither preference may be detected",
    "C33": "the paper's p* with a joint percentile bootstrap in place of an inverted score test; "
    "“no crossing” is about the estimates",
    "C34": "DOB flies once",
    "C36": "too strict: seed 0 is lower; nothing is asked of the order of the two costs",
    **dict.fromkeys(("C40", "C41", "C42", "C43", "C44", "C45"), "new"),
}
"""What changed beside the interval, which is the paper's in all of them."""


def why(claim: ClaimVerdict) -> str:
    """Return the statement that decides, with its numbers."""
    part = next(part for part in claim.parts if part.answer == claim.verdict)
    score = part.score and f"score {interval(part.model_copy(update={'interval': part.score}))}"
    said = "; ".join(filter(None, (estimate(part), score, part.reason)))
    return f"{part.words}: {said}" if said else part.words


runs = [Reproduction.model_validate_json(Path(path).read_bytes()) for path in sys.argv[1:]]
before, after = ({claim.id: claim for claim in run.ledger.claims} for run in runs)
shown = [id for id in after if id in CHANGED or before[id].verdict != after[id].verdict]
print("| claim | what changed | before | after | why, after |\n| :-- | :-- | :-- | :-- | :-- |")
for id in shown:
    old = before[id].verdict if id in before else "–"
    new = after[id].verdict if id in before and before[id].verdict == after[id].verdict else ""
    new = new or f"**{after[id].verdict}**"
    print(f"| {id} | {CHANGED.get(id, '')} | {old} | {new} | {markdown(typeset(why(after[id])))} |")

others = [id for id in after if id not in shown]
print(f"\nAll others have their answer of before: {', '.join(others)}.")
print("\n| | claims | confirmed | refuted | undecided |\n| :-- | --: | --: | --: | --: |")
for label, found in (("before", before), ("after", after)):
    counts = (
        sum(claim.verdict == answer for claim in found.values())
        for answer in ("confirmed", "refuted", "undecided")
    )
    print(f"| {label} | {len(found)} | {' | '.join(map(str, counts))} |")

INTERACTION = "DOB minus GRU, shared minus reconstruction-only (pp)"
print(f"\n| {INTERACTION} | difference | 95 % interval |\n| :-- | --: | --: |")
for label, run in zip(("three runs of DOB, score", "one run, bootstrap"), runs, strict=True):
    (lines,) = (table.lines for table in run.tables if table.name == "table-4")
    at = [line.label for line in lines].index(INTERACTION)
    value, ends = (markdown(line.entries[-1].text) for line in lines[at : at + 2])
    print(f"| {label} | {value} | {ends} |")
