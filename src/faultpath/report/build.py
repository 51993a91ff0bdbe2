"""What a build server shows of runs: JUnit's XML, and a summary in Markdown."""

from collections.abc import Sequence
from xml.etree import ElementTree

from faultpath.decisions.gate import found
from faultpath.decisions.model import DecisionRecord
from faultpath.decisions.summary import answers
from faultpath.decisions.tables.escapes import markdown, visible
from faultpath.report.tables import markdown_table


def junit(records: Sequence[DecisionRecord], asked: Sequence[str]) -> str:
    """Return JUnit's XML: a suite for each record, a case for its trials and each of `asked`."""
    root = ElementTree.Element("testsuites", name="faultpath")
    for record in records:
        question = record.question
        name = f"{question.repair} against {question.baseline}"
        name += f" under {question.fault}" if question.fault else ""
        cases = {"trials-ran": _failed(record)}
        for each in asked:
            answer = found(record, each)
            cases[f"no-{each}"] = answer.said if answer else ""
        suite = ElementTree.SubElement(
            root,
            "testsuite",
            name=visible(name),
            tests=str(len(cases)),
            failures=str(sum(map(bool, cases.values()))),
        )
        for case, said in cases.items():
            place = ElementTree.SubElement(suite, "testcase", classname="faultpath", name=case)
            if said:
                wrong = ElementTree.SubElement(place, "failure", message=visible(said))
                wrong.text = visible(said)
        told = "\n".join((record.headline, *record.sentences, *record.findings))
        ElementTree.SubElement(suite, "system-out").text = visible(told)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def summary(records: Sequence[DecisionRecord], asked: Sequence[str]) -> str:
    """Return what was decided as Markdown: a headline, what a build fails for, answers, tables."""
    parts: list[str] = []
    for record in records:
        parts.append(f"### {markdown(record.headline)}")
        wrong = {each: found(record, each) for each in asked}
        marks = [
            f"- **{'fails' if answer else 'passes'}** `{name}`: {markdown(answer.said)}"
            for name, answer in wrong.items()
        ]
        parts += ["\n".join(marks)] if marks else []
        parts += [f"**{label}.** {markdown(said)}" for label, said in answers(record).items()]
        if record.findings:
            noted = "\n".join(f"- {markdown(each)}" for each in record.findings)
            parts.append(f"**Found in the run.**\n\n{noted}")
        parts.append(markdown_table(record))
    return "\n\n".join(parts).rstrip() + "\n"


def _failed(record: DecisionRecord) -> str:
    failed = sum(cell.failed for cell in record.cells)
    return f"{failed} trials failed or are missing." if failed else ""
