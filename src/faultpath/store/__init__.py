"""What a run leaves behind: a folder of shards, and the tables assembled from them."""

# pyright: reportUnusedImport=false
from faultpath.store.atomic import check_writable, make_folder, write_text
from faultpath.store.evidence import read_evidence, write_evidence
from faultpath.store.folder import RunFolder
from faultpath.store.manifest import FORMAT, Manifest
from faultpath.store.parquet import read_table
from faultpath.store.tables import Shard, TrialAddress, read_outcomes, read_traces, traces_of
