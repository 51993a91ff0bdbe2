"""Which source decides a result: what a module imports, where it lies, and what it is made of."""

# pyright: reportUnusedImport=false
from faultpath.code.graph import Kind, Root, kind_of, release
from faultpath.code.state import Code, CodeState, Watch, named, read_code
