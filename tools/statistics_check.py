"""The page on what the statistics keep, made from a run of `faultpath selfcheck statistics`.

faultpath selfcheck statistics --out docs/reference/statistics-check.json
python tools/statistics_check.py          write docs/statistics-check.md
python tools/statistics_check.py check    fail where the page is not what the numbers give
"""

import sys

from blocks import REFERENCE, ROOT

from faultpath.selfcheck import Report, failures, page

PAGE = ROOT / "docs" / "statistics-check.md"


def main() -> int:
    """Write or check; return the exit status."""
    report = Report.model_validate_json((REFERENCE / "statistics-check.json").read_bytes())
    text = page(report, failures(report))
    if sys.argv[1:] == ["check"]:
        if PAGE.read_text("utf-8") == text:
            return 0
        print("docs/statistics-check.md is not what its numbers give", file=sys.stderr)
        return 1
    if sys.argv[1:]:
        print((__doc__ or "").partition("\n\n")[2], file=sys.stderr)
        return 2
    PAGE.write_text(text, "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
