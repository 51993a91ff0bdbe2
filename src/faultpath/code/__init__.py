"""Which source decides a result: what a module imports, where it lies, and what it is made of."""

# pyright: reportUnusedImport=false
from faultpath.code.graph import Root, shadowed
from faultpath.code.reads import Reads
from faultpath.code.state import Code, CodeState, named, read_code
from faultpath.code.watch import Watch
