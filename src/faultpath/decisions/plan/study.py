"""A study file: audits of one repair, with their arms, to be carried out as they stand."""

import shlex
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, Self, get_args

from pydantic import Field, StringConstraints, model_validator

from faultpath.core.errors import UserError
from faultpath.core.files.opening import contents
from faultpath.core.files.plain import Misread, read_yaml, yaml_text
from faultpath.core.results import Frozen
from faultpath.decisions.model import CORRECT, SHARED
from faultpath.decisions.planning import Audit
from faultpath.decisions.question import Question
from faultpath.trials.question import RepairQuestion

_MOST = 200
"""Audits of a file. Each is a finding of its own, and a file of more asks no one question."""
Role = Literal["correct", "repaired", "shared", "attribution"]


class StudyArm(Frozen):
    """One path of the fault, run with both variants."""

    path: str
    role: Role
    """`repaired`: isolated at the module that the repair changes; `attribution`: at another."""
    baseline: tuple[str, ...] = ()
    """Consumers that the fault reaches there; without any the arm is that of correct inputs."""
    repair: tuple[str, ...] = ()


class StudyAudit(Frozen):
    """One audit of the repair: a fault, and its arms where they were planned."""

    name: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}$")]
    """Names its folder."""
    fault: str
    why: str = ""
    arms: tuple[StudyArm, ...] = ()

    @model_validator(mode="after")
    def _paths_once(self) -> Self:
        _check_once("arms", "path", [arm.path for arm in self.arms])
        return self


class StudyFile(RepairQuestion, strict=False):
    """Study that `faultpath plan` writes and `faultpath audit --study` carries out.

    One that was written by hand may leave out arms and hash: they follow from the system as it is.
    """

    faultpath_study: Literal[1] = 1
    """Version of the form."""
    system: str
    library_hash: str = ""
    scenes: int | None = Field(default=None, ge=1)
    audits: tuple[StudyAudit, ...] = Field(min_length=1, max_length=_MOST)

    @model_validator(mode="after")
    def _names_once(self) -> Self:
        _check_once("audits", "name", [audit.name for audit in self.audits])
        return self

    def yaml(self) -> str:
        """Return the file's text."""
        data = {"faultpath_study": 1, "system": self.system, **self.model_dump(mode="json")}
        return yaml_text(data, width=100, default_flow_style=None)


def _check_once(what: str, having: str, names: Sequence[str]) -> None:
    if twice := [name for name, count in Counter(names).items() if count > 1]:
        raise ValueError(f"two {what} have the {having} '{twice[0]}': give each its own")


def read_study(path: Path) -> StudyFile:
    """Read a study file; `UserError` for one that cannot be read or says something else."""
    try:
        return read_yaml(contents(path)).fill(StudyFile)
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror}): give a study file.") from None
    except Misread as error:
        raise UserError(f"{error.at(path)}, or let `faultpath plan` write the file anew.") from None


def arms_of(audit: Audit, repaired: tuple[str, ...] = ()) -> tuple[StudyArm, ...]:
    """Return the arms of an audit path by path, in the order of their roles: the paper's, III-C."""
    question = audit.question
    reached: dict[str, dict[str, tuple[str, ...]]] = {}
    for row in audit.study.rows:
        consumers = {c: None for f in row.arm.faults for c in f.consumers}
        reached.setdefault(row.path, {})[row.variant] = tuple(consumers)
    of_path: dict[str, Role] = {CORRECT: "correct", SHARED: "shared"}
    of_path |= dict.fromkeys(repaired, "repaired")
    arms = [
        StudyArm(
            path=path,
            role=of_path.get(path, "attribution"),
            baseline=by_variant[question.baseline],
            repair=by_variant[question.repair],
        )
        for path, by_variant in reached.items()
    ]
    return tuple(sorted(arms, key=lambda arm: get_args(Role).index(arm.role)))


def check_arms(study: StudyFile, planned: StudyAudit, audit: Audit) -> None:
    """Raise `UserError` unless the system still lays out the arms and scenes of the file."""
    if study.library_hash and audit.question.library_hash != study.library_hash:
        raise UserError(
            f"library '{study.library}' has changed since the study file was written: plan anew."
        )
    current = {(arm.path, arm.baseline, arm.repair) for arm in arms_of(audit)}
    then = {(arm.path, arm.baseline, arm.repair) for arm in planned.arms}
    if planned.arms and current != then:
        other = sorted({path for path, _, _ in current ^ then})
        raise UserError(
            f"audit '{planned.name}' of the study file does not run what the system now has for "
            f"'{planned.fault}' ({', '.join(other)}): an audit runs every version under every "
            "condition, so plan anew."
        )


def command(question: Question | StudyFile, fault: str) -> str:
    """Return the command that flies the arms of a fault: each module alone, and shared."""
    parts = ["faultpath", "audit", question.system, "--baseline", question.baseline]
    parts += ["--repair", question.repair, "--fault", fault, "--library", question.library]
    parts += [
        part for key, value in question.options.items() for part in ("--set", f"{key}={value}")
    ]
    return shlex.join(parts)
