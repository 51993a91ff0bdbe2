"""For code that runs in a trial or builds a system: errors, random numbers, the user's parts, files
that it reads, and what a system is named and run by."""

from faultpath.core.error_source import explained, located
from faultpath.core.errors import Notice, Stopped, SystemMistake, UserError
from faultpath.core.files.opening import LARGEST_TEXT, contents
from faultpath.core.files.plain import Misread, read_json
from faultpath.core.results import Frozen
from faultpath.core.streams import generator, key, words
from faultpath.core.text import listed, one_line, unknown
from faultpath.core.validation_messages import misfit_of
from faultpath.run.plan import SystemSpec, Treatment
from faultpath.run.registry import factory_root, load_parts, load_system
from faultpath.run.work.executor import one_thread
from faultpath.system.options import call

__all__ = [
    "LARGEST_TEXT",
    "Frozen",
    "Misread",
    "Notice",
    "Stopped",
    "SystemMistake",
    "SystemSpec",
    "Treatment",
    "UserError",
    "call",
    "contents",
    "explained",
    "factory_root",
    "generator",
    "key",
    "listed",
    "load_parts",
    "load_system",
    "located",
    "misfit_of",
    "one_line",
    "one_thread",
    "read_json",
    "unknown",
    "words",
]
