"""Questions of a build or a test, answered from a result, and what a build server reads."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args
from xml.etree import ElementTree

from faultpath.analyses.model import SHARED, AuditResult, where
from faultpath.core.errors import UserError
from faultpath.core.text import capital, counted, unknown
from faultpath.report.audit_tables import markdown_table
from faultpath.report.escapes import markdown, visible
from faultpath.report.sentences import phrases, words
from faultpath.report.sentences.answers import answers
from faultpath.report.sentences.phrases import NO_RESULT, in_short, places
from faultpath.report.sentences.wording import sentence

Ask = Literal["reversal", "repair-behind", "undecided", "void"]
ASKS: tuple[Ask, ...] = get_args(Ask)


@dataclass(frozen=True)
class Answer:
    """Yes or no, and what it rests on: true and false as a bool, and read in a failed assert."""

    yes: bool
    reason: str

    def __bool__(self) -> bool:
        return self.yes

    def __repr__(self) -> str:
        return f"{'yes' if self.yes else 'no'}: {self.reason}"


def found(result: AuditResult, what: str) -> Answer:
    """Return whether a result holds what is named; `UserError` for what is none of `ASKS`.

    `reversal`: sharing the fault reverses the ranking. `repair-behind`: under some condition the
    baseline is significantly ahead. `undecided`: the primary contrast is neither significant nor
    shown to be small. `void`: pairs of trials count for nothing.
    """
    if result.invalid and what in ASKS:
        return Answer(True, NO_RESULT[result.invalid])
    match what:
        case "reversal":
            turned = [change for change in result.changes if change.turn == "reversal"]
            text = " ".join(phrases.change(result, change) for change in turned)
            return Answer(bool(turned), text or "no reversal is significant.")
        case "repair-behind":
            behind = [effect for effect in result.effects if effect.sign < 0]
            if not behind:
                return Answer(False, "under no condition is the baseline significantly ahead.")
            ahead = f"{result.question.baseline} succeeds more often."
            return Answer(True, f"{capital(places(behind))}, {ahead}")
        case "undecided":
            primary = result.facts.primary
            main = result.effect(primary)
            conclusive = main is not None and (main.sign != 0 or result.is_small(main))
            return Answer(not conclusive, f"{capital(where(primary))}: {in_short(result, main)}.")
        case "void":
            missing = sum(effect.void for effect in result.effects)
            lost = [name for name in result.titles if result.effect(name) is None]
            verb = "is" if missing == 1 else "are"
            sentences = [f"{counted(missing, 'pair')} of trials {verb} void."]
            sentences += [f"{phrases.no_pair(name)}." for name in lost]
            return Answer(bool(missing or lost), " ".join(sentences))
        case _:
            raise UserError(f"a result cannot be asked for that: {unknown('name', what, ASKS)}.")


def holds_when_shared(result: AuditResult) -> Answer:
    """Return whether the repair is significantly ahead under the shared fault, away from floor and
    ceiling and not because the baseline's trials failed; `UserError` without a shared fault."""
    if SHARED not in result.titles:
        raise UserError("the result has no shared fault, so nothing says whether the repair holds.")
    effect = result.effect(SHARED)
    text = sentence(f"{where(SHARED)}, {in_short(result, effect)}")
    return Answer(effect is not None and effect.leads and effect.sign > 0, text)


def junit(results: Sequence[AuditResult], gates: Sequence[str]) -> str:
    """Return JUnit's XML: a suite for each result, a case for its trials and each of `gates`."""
    root = ElementTree.Element("testsuites", name="faultpath")
    for result in results:
        question, text = result.question, words(result)
        name = f"{question.repair} against {question.baseline}"
        name += f" under {question.fault}" if question.fault else ""
        failed = sum(count.failed for count in result.counts)
        cases = {
            "trials-ran": f"{counted(failed, 'trial')} failed or missing." if failed else "",
            "result": text.headline if result.invalid else "",
        }
        for gate in gates:
            answer = found(result, gate)
            cases[f"no-{gate}"] = answer.reason if answer else ""
        suite = ElementTree.SubElement(
            root,
            "testsuite",
            name=visible(name),
            tests=str(len(cases)),
            failures=str(sum(map(bool, cases.values()))),
        )
        for case, failure in cases.items():
            place = ElementTree.SubElement(suite, "testcase", classname="faultpath", name=case)
            if failure:
                wrong = ElementTree.SubElement(place, "failure", message=visible(failure))
                wrong.text = visible(failure)
        printed = "\n".join((text.headline, *text.sentences, *text.findings))
        ElementTree.SubElement(suite, "system-out").text = visible(printed)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def summary(results: Sequence[AuditResult], gates: Sequence[str]) -> str:
    """Return results as Markdown: a headline, what a build fails for, answers, tables."""
    parts: list[str] = []
    for result in results:
        text = words(result)
        parts.append(f"### {markdown(text.headline)}")
        answered = {gate: found(result, gate) for gate in gates}
        marks = [
            f"- **{'fails' if answer else 'passes'}** `{name}`: {markdown(answer.reason)}"
            for name, answer in answered.items()
        ]
        parts += ["\n".join(marks)] if marks else []
        parts += [f"**{label}.** {markdown(answer)}" for label, answer in answers(result).items()]
        if text.findings:
            noted = "\n".join(f"- {markdown(finding)}" for finding in text.findings)
            parts.append(f"**Found in the run.**\n\n{noted}")
        parts.append(markdown_table(result))
    return "\n\n".join(parts).rstrip() + "\n"
