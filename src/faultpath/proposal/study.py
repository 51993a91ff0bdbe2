"""A study file: audits of one repair, with their arms, to be carried out as they stand."""

from pathlib import Path
from typing import Annotated, Literal, get_args

import yaml
from pydantic import Field, StringConstraints, ValidationError

from faultpath.errors import UserError
from faultpath.frozen import Frozen
from faultpath.misfits import misfit_of
from faultpath.planning import Audit
from faultpath.record import CORRECT, SHARED
from faultpath.record.factorial import JOINED

_LONGEST = 1_000_000
"""Bytes of a file."""
Role = Literal["correct", "repaired", "shared", "attribution", "factorial"]


class StudyArm(Frozen):
    """One path of the fault, flown with both variants."""

    path: str
    role: Role
    """`repaired`: isolated at the module that the repair changes; `attribution`: at another."""
    baseline: tuple[str, ...] = ()
    """Consumers that the fault strikes there; without any the arm is that of correct inputs."""
    repair: tuple[str, ...] = ()


class StudyAudit(Frozen):
    """One audit of the repair: a fault, and its arms."""

    name: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}$")]
    """Names its folder."""
    fault: str
    why: str = ""
    factorial: bool = False
    arms: tuple[StudyArm, ...] = Field(min_length=2)


class StudyFile(Frozen):
    """What `faultpath plan` writes and `faultpath audit --study` carries out."""

    faultpath_study: Literal[1] = 1
    """Version of the form."""
    system: str
    options: dict[str, str] = Field(default_factory=dict[str, str])
    baseline: str
    repair: str
    library: str
    library_hash: str
    scenes: int = Field(ge=1)
    """The first so many of the library."""
    seeds: tuple[int, ...] = Field(min_length=1)
    audits: tuple[StudyAudit, ...] = Field(min_length=1)

    def yaml(self) -> str:
        """Return the file's text."""
        data = self.model_dump(mode="json")
        return yaml.safe_dump(
            data, sort_keys=False, allow_unicode=True, width=100, default_flow_style=None
        )


def read_study(path: Path) -> StudyFile:
    """Read a study file; `UserError` for one that cannot be read or says something else."""
    try:
        if path.exists() and not path.is_file():  # a device may have no end
            raise UserError(f"{path} is not a file: give the study file that `plan` wrote.")
        with path.open("rb") as file:
            text = file.read(_LONGEST + 1).decode("utf-8")
    except (OSError, ValueError) as error:
        reason = (error.strerror if isinstance(error, OSError) else "") or "not UTF-8 text"
        raise UserError(f"{path}: cannot be read ({reason}): give a study file.") from None
    try:
        if len(text) > _LONGEST:
            raise ValueError("it is too long")
        study = StudyFile.model_validate(yaml.safe_load(text))
    except ValidationError as error:
        raise UserError(
            f"{path}: {misfit_of(error, StudyFile)}, or let `faultpath plan` write the file anew."
        ) from None
    except (yaml.YAMLError, ArithmeticError, AttributeError, LookupError, RecursionError) as error:
        raise _not_yaml(path, error) from None
    except (TypeError, ValueError) as error:  # the 99th of a month, a number of 5,000 digits
        raise _not_yaml(path, error) from None
    names = [audit.name for audit in study.audits]
    if len(set(names)) < len(names):
        raise UserError(f"{path}: two audits have one name: name each once.")
    return study


def _not_yaml(path: Path, error: Exception) -> UserError:
    return UserError(f"{path}: is not plain YAML ({' '.join(str(error).split())}): correct it.")


def arms_of(audit: Audit, repaired: tuple[str, ...] = ()) -> tuple[StudyArm, ...]:
    """Return the arms of an audit path by path, in the order of their roles: the paper's, III-C."""
    asked = audit.question
    struck: dict[str, dict[str, tuple[str, ...]]] = {}
    for row in audit.study.rows:
        consumers = {c: None for f in row.arm.faults if f.kind != "coupled" for c in f.consumers}
        struck.setdefault(row.path, {})[row.variant] = tuple(consumers)
    arms = [
        StudyArm(
            path=path,
            role=_role(path, repaired),
            baseline=by_variant[asked.baseline],
            repair=by_variant[asked.repair],
        )
        for path, by_variant in struck.items()
    ]
    return tuple(sorted(arms, key=lambda arm: get_args(Role).index(arm.role)))


def _role(path: str, repaired: tuple[str, ...]) -> Role:
    if path == CORRECT:
        return "correct"
    if path == SHARED:
        return "shared"
    if JOINED in path:
        return "factorial"
    return "repaired" if path in repaired else "attribution"


def check_arms(study: StudyFile, planned: StudyAudit, audit: Audit) -> None:
    """Raise `UserError` unless the system still lays out the arms and scenes of the file."""
    if audit.question.library_hash != study.library_hash:
        raise UserError(
            f"library '{study.library}' is not the one of the study file any more: plan anew."
        )
    now = {(arm.path, arm.baseline, arm.repair) for arm in arms_of(audit)}
    then = {(arm.path, arm.baseline, arm.repair) for arm in planned.arms}
    if now != then:
        other = sorted({path for path, _, _ in now ^ then})
        raise UserError(
            f"audit '{planned.name}' of the study file has other arms than the system now has for "
            f"'{planned.fault}' ({', '.join(other)}): an audit flies all of its arms, so plan anew."
        )
