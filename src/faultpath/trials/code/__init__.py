"""Which source decides a result: what a module imports, where it lies, and what it is made of."""

# pyright: reportUnusedImport=false
from faultpath.trials.code.graph import Graph, Root, file_of, kind_of, locate, release
from faultpath.trials.code.state import Code, CodeState, Watch, named, read_code
