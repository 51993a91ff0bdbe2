"""Which source decides a result: what a module imports, where it lies, and what it is made of."""

from faultpath.code.graph import Root
from faultpath.code.state import CodeState, code_state

__all__ = ["CodeState", "Root", "code_state"]
