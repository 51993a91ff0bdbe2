"""Reading imports off a source."""

import pytest

from faultpath.code.imports import Import, imports_of


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("import a", [Import("a")]),
        ("import a.b as c, d", [Import("a.b"), Import("d")]),
        ("from a import b as c", [Import("a", (("b", "c"),))]),
        ("from . import b", [Import("", (("b", "b"),), 1)]),
        ("from ..a import *", [Import("a", (("*", "*"),), 2)]),
        ("x = 1; import a", [Import("a")]),
        ("def f():\n    class A:\n        import a", [Import("a")]),
        ("try:\n    import a\nexcept ImportError:\n    import b", [Import("a"), Import("b")]),
        ("try:\n    pass\nfinally:\n    import a", [Import("a")]),
        ("if x:\n    pass\nelse:\n    import a", [Import("a")]),
        ("with x:\n    import a", [Import("a")]),
        ("match x:\n    case 1:\n        import a", [Import("a")]),
        ("async def f():\n    async for _ in x:\n        import a", [Import("a")]),
        ("if TYPE_CHECKING:\n    import a\nelse:\n    import b", [Import("b")]),
        ("if typing.TYPE_CHECKING:\n    import a", []),
        ("importlib.import_module('a.b')", [Import("a.b")]),
        ("import_module('.b', __package__)", [Import("b", level=1)]),
        ("f = lambda: __import__('a')", [Import("a")]),
        ('"""import a"""  # import b', []),
        ("import", []),
        ("x = '\0'", []),
    ],
)
def test_every_statement_is_found(source, found):
    imports = imports_of(source.encode())
    assert sorted(imports.imports, key=str) == sorted(found, key=str)
    assert not imports.computed


@pytest.mark.parametrize(
    "source",
    [
        "importlib.import_module(name)",
        "def f(x):\n    return import_module('plugins.' + x)",
        "__import__(name)",
        "runpy.run_path(place)",
        "importlib.util.spec_from_file_location('a', 'a.py')",
    ],
)
def test_a_computed_name_is_noticed(source):
    assert imports_of(source.encode()).computed


@pytest.mark.parametrize(
    ("source", "facade"),
    [
        ('"""Says so."""\nfrom a import b\n__all__ = ["b"]\n', True),
        ("", True),
        ("from a import b\nb.register()\n", False),
        ("x = 1\n", False),
    ],
)
def test_a_facade_does_nothing_but_pass_names_on(source, facade):
    assert imports_of(source.encode()).facade is facade
