"""What a module or a loss is made of, in a digest that comments and places do not change."""

import dis
import inspect
from collections.abc import Iterator, Mapping
from functools import partial
from hashlib import sha256
from pathlib import Path
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

from faultpath.code.places import Kind, kind_of


def code_sha256(thing: Any) -> str:
    """Return a digest of the code of a function or class, and of what it uses of the user's own.

    Bytecode, constants, defaults, captured and global numbers count; of what is installed only
    the name does. The bytecode belongs to a version of Python.
    """
    return sha256("\n".join(_parts(thing, set())).encode()).hexdigest()


def name_of(thing: Any) -> str:
    """Return what a function or class is called."""
    if isinstance(thing, partial):
        return name_of(thing.func)
    named = thing if hasattr(thing, "__qualname__") else type(thing)
    return named.__qualname__.replace("<locals>.", "")


def plain_fields(thing: Any) -> dict[str, Any]:
    """Return the numbers, texts and tuples that an object holds, by name."""
    held = getattr(thing, "__dict__", {})
    return {
        k: v for k, v in sorted(held.items()) if isinstance(v, bool | int | float | str | tuple)
    }


def _parts(thing: Any, seen: set[int]) -> Iterator[str]:
    if isinstance(thing, partial):
        yield from _parts((thing.func, thing.args, thing.keywords), seen)
    elif isinstance(thing, ModuleType):
        yield thing.__name__
    elif isinstance(thing, MethodType):
        yield from _parts((thing.__func__, thing.__self__), seen)
    elif isinstance(thing, FunctionType | type):
        yield f"{thing.__module__}.{thing.__qualname__}" if not _own(thing) else thing.__name__
        if id(thing) not in seen and _own(thing):
            seen.add(id(thing))
            if isinstance(thing, type):
                yield from _of_class(thing, seen)
            else:
                yield from _of_function(thing, seen)
    elif isinstance(thing, Mapping):
        for key, value in thing.items():
            yield repr(key)
            yield from _parts(value, seen)
    elif isinstance(thing, tuple | list):
        for each in thing:
            yield from _parts(each, seen)
    elif hasattr(thing, "detach"):  # a tensor
        yield sha256(thing.detach().cpu().double().numpy().tobytes()).hexdigest()
    elif hasattr(thing, "tobytes"):
        yield sha256(thing.tobytes()).hexdigest()
    elif thing is None or isinstance(thing, bool | int | float | complex | str | bytes):
        yield repr(thing)
    else:
        yield from _of_object(thing, seen)


def _of_object(thing: Any, seen: set[int]) -> Iterator[str]:
    """An object counts by its class and what it holds; one of an installed class by its numbers."""
    if id(thing) in seen:
        return
    seen.add(id(thing))
    yield from _parts(type(thing), seen)
    if isinstance(thing, frozenset | set):
        yield repr(sorted(map(repr, thing)))
    else:
        yield from _parts(
            getattr(thing, "__dict__", {}) if _own(type(thing)) else plain_fields(thing), seen
        )


def _of_function(function: FunctionType, seen: set[int]) -> Iterator[str]:
    yield from _of_code(function.__code__)
    yield from _parts((function.__defaults__, function.__kwdefaults__), seen)
    for cell in function.__closure__ or ():
        yield from _parts(cell.cell_contents, seen)
    for name in sorted(_names(function.__code__)):
        if name in function.__globals__:
            yield from _parts(function.__globals__[name], seen)


def _of_class(kind: type, seen: set[int]) -> Iterator[str]:
    for name, value in sorted(vars(kind).items()):
        plain = inspect.unwrap(getattr(value, "__func__", getattr(value, "fget", value)))
        number = isinstance(plain, bool | int | float | str | tuple) and not name.startswith("__")
        if number or isinstance(plain, FunctionType):
            yield name
            yield from _parts(plain, seen)
    for base in kind.__bases__:
        yield from _parts(base, seen)


def _of_code(code: CodeType) -> Iterator[str]:
    yield code.co_code.hex()
    yield repr((code.co_names, code.co_varnames, code.co_freevars))
    for constant in code.co_consts[1:] if _has_docstring(code) else code.co_consts:
        if isinstance(constant, CodeType):
            yield from _of_code(constant)
        else:
            yield repr(sorted(constant) if isinstance(constant, frozenset) else constant)


def _names(code: CodeType) -> set[str]:
    inner = (c for c in code.co_consts if isinstance(c, CodeType))
    read = {i.argval for i in dis.get_instructions(code) if i.opname == "LOAD_GLOBAL"}
    return read.union(*map(_names, inner))


def _has_docstring(code: CodeType) -> bool:
    first = code.co_consts[0] if code.co_consts else None
    return isinstance(first, str) and not code.co_name.startswith("<")


def _own(thing: Any) -> bool:
    try:
        return kind_of(Path(inspect.getfile(thing))) is Kind.LOCAL
    except TypeError:  # built in, or a class of a notebook
        return getattr(thing, "__module__", None) == "__main__"
    except OSError:
        return True
