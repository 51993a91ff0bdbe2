"""Whether the code of a system has one state, wherever and however often it is built."""

from functools import partial
from pathlib import Path

from faultpath.code import CodeState, named
from faultpath.review.report import Check
from faultpath.trials import System, SystemSpec, load_system
from faultpath.trials.state import system_code
from faultpath.work import Executor, run_all

_OURS = Path(__file__).resolve().parents[1]
_REMEDY = "let fingerprint() and what the file does when it is loaded depend on nothing else."


def fingerprint(system: System, spec: SystemSpec, held: Executor) -> Check:
    """Compare the state of the code when it is built again, here and in another process.

    Raises `UserError` where the system cannot be built there.
    """
    code = system_code(system, spec)
    failures: list[str] = []
    if not spec.is_object:
        if changed := code.state.changed(_state(spec)):
            failures.append(f"Built twice, the system differs in {named(changed)}; {_REMEDY}")
        elif not held.in_process:
            ((_, there),) = run_all(held, [partial(_state, spec)])
            if changed := code.state.changed(there):
                failures.append(
                    f"Built in another process, the system differs in {named(changed)}; {_REMEDY}"
                )
    own = sum(not path.is_relative_to(_OURS) for path in code.sources.values())
    says = (
        f"{code.state.digest[:8]} of {own} of your files, {len(code.sources) - own} of faultpath, "
        f"{len(code.data)} data files and {len(code.state.packages)} packages"
    )
    return Check(name="fingerprint", says=says, failures=tuple(failures))


def _state(spec: SystemSpec) -> CodeState:
    return system_code(load_system(spec), spec).state
