"""Reports for a build server: JUnit's XML, and a summary in Markdown."""

from collections.abc import Sequence
from xml.etree import ElementTree

from faultpath.analyses.model import AuditResult
from faultpath.report.audit_tables import markdown_table
from faultpath.report.gate import found
from faultpath.report.sentences.answers import answers
from faultpath.report.sentences.words import words
from faultpath.report.tables.escapes import markdown, visible


def junit(records: Sequence[AuditResult], conditions: Sequence[str]) -> str:
    """Return JUnit's XML: a suite for each record, a case for its trials and each condition."""
    root = ElementTree.Element("testsuites", name="faultpath")
    for record in records:
        question, result = record.question, words(record)
        name = f"{question.repair} against {question.baseline}"
        name += f" under {question.fault}" if question.fault else ""
        failed = sum(count.failed for count in record.counts)
        cases = {
            "trials-ran": f"{failed} trials failed or are missing." if failed else "",
            "result": result.headline if record.invalid else "",
        }
        for condition in conditions:
            answer = found(record, condition)
            cases[f"no-{condition}"] = answer.reason if answer else ""
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
        text = "\n".join((result.headline, *result.sentences, *result.findings))
        ElementTree.SubElement(suite, "system-out").text = visible(text)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def summary(records: Sequence[AuditResult], conditions: Sequence[str]) -> str:
    """Return what was decided as Markdown: a headline, what a build fails for, answers, tables."""
    parts: list[str] = []
    for record in records:
        result = words(record)
        parts.append(f"### {markdown(result.headline)}")
        wrong = {condition: found(record, condition) for condition in conditions}
        marks = [
            f"- **{'fails' if answer else 'passes'}** `{name}`: {markdown(answer.reason)}"
            for name, answer in wrong.items()
        ]
        parts += ["\n".join(marks)] if marks else []
        parts += [f"**{label}.** {markdown(answer)}" for label, answer in answers(record).items()]
        if result.findings:
            noted = "\n".join(f"- {markdown(finding)}" for finding in result.findings)
            parts.append(f"**Found in the run.**\n\n{noted}")
        parts.append(markdown_table(record))
    return "\n\n".join(parts).rstrip() + "\n"
