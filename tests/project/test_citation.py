"""`CITATION.cff` names this version, and the same paper as the README."""

import tomllib
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]


def test_the_citation_is_that_of_the_readme() -> None:
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text("utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert (cited["title"], cited["version"]) == (project["name"], project["version"])
    assert cited["license"] == project["license"]
    paper = cited["preferred-citation"]
    authors = [f"{a['family-names']}, {a['given-names']}" for a in paper["authors"]]
    readme = (ROOT / "README.md").read_text("utf-8")
    assert f"author = {{{' and '.join(authors)}}}" in readme
    assert f"title  = {{{paper['title']}}}" in readme
