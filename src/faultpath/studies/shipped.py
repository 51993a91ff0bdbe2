"""Runs of the whole paper that come with the package, each under the platform that it flew on."""

from pathlib import Path

from faultpath.errors import UserError
from faultpath.record import Ledger, Reproduction

RUNS = Path(__file__).parent / "paper" / "runs"
"""One folder a platform."""
PLATFORM = "platform"
"""The option of the system that names one."""


def platforms() -> tuple[str, ...]:
    """Return the names of all frozen platforms, in the order in which they were frozen."""
    return ("matched",)


def default_platform() -> str:
    """Return the platform that flies where none is named."""
    return platforms()[-1]


def shipped() -> tuple[str, ...]:
    """Return the platforms whose run is there, in the same order."""
    return tuple(name for name in platforms() if (RUNS / name / "provenance.json").is_file())


def beside(ledger: Ledger) -> tuple[Ledger, ...]:
    """Return what the shipped runs on other platforms answered, over the library of `ledger`."""
    found = (shipped_ledger(name) for name in shipped() if name != ledger.platform)
    return tuple(other for other in found if other.library_hash == ledger.library_hash)


def shipped_run(platform: str | None = None) -> Path:
    """Return the folder of a platform's run; `UserError` where there is none."""
    name = platform or default_platform()
    if name not in platforms():
        raise UserError(f"there is no platform '{name}': choose from {', '.join(platforms())}.")
    if name not in shipped():
        others = ", ".join(shipped()) or "none"
        raise UserError(
            f"no run of the paper comes with faultpath for platform '{name}', only for: {others}. "
            f"Name one of these, or fly it: faultpath reproduce --profile paper --platform {name}."
        )
    return RUNS / name


def shipped_ledger(platform: str | None = None) -> Ledger:
    """Return what a platform's run answered; `UserError` where there is none.

    A test holds it to what the code that is here answers from the run's tables.
    """
    text = (shipped_run(platform) / "reproduction.json").read_bytes()
    return Reproduction.model_validate_json(text).ledger
