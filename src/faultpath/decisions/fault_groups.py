"""Faults that act together, as one text: `mass:bias=0.1,relative & wind:bias=0.5,loading=0.7`.

Parts joined by `&` have one cause: drawn errors are the same draws, as far as each `loading` says.
"""

from dataclasses import replace

from faultpath.core.errors import UserError
from faultpath.core.numbers import number_in
from faultpath.faults import AnyFault, Coupled, Fault, FaultText
from faultpath.trials import System

JOINED = " & "


def fault_of(system: System, text: str) -> AnyFault:
    """Return the fault that a text states, of one part or several; `UserError` for none."""
    texts = [part.strip() for part in text.split(JOINED.strip())]
    if len(texts) == 1:
        return system.fault(text)
    if "@" in text:
        raise UserError(f"fault '{text}': joined faults reach every reader; leave '@' out")
    parts = [_part(system, text) for text in texts]
    # Without sizes: draws of the cause are the same at every size.
    names = (part.name if part.kind == "coupled" else part.drawn_from for part in parts)
    return Coupled(name=JOINED.join(names), faults=tuple(f for part in parts for f in _each(part)))


def _part(system: System, text: str) -> AnyFault:
    parsed = FaultText.read(text)
    if "loading" not in parsed.options:
        return system.fault(text)
    rest = {key: value for key, value in parsed.options.items() if key != "loading"}
    fault, number = system.fault(str(replace(parsed, options=rest))), parsed.options["loading"]
    try:
        loading = number_in(number)
    except ValueError:
        loading = 2.0
    if not (-1.0 <= loading <= 1.0 and all(e.intervention.is_random() for e in _each(fault))):
        raise UserError(
            f"fault '{text}': a loading is a number from -1 to 1, and of errors that are drawn"
        )
    update = {"loading": loading}
    if fault.kind == "fault":
        return fault.model_copy(update=update)
    loaded = tuple(part.model_copy(update=update) for part in fault.faults)
    return fault.model_copy(update={"faults": loaded})


def _each(fault: AnyFault) -> tuple[Fault, ...]:
    return fault.faults if fault.kind == "coupled" else (fault,)
