"""`python -m faultpath`: the command `faultpath`."""

import sys

if __name__ == "__main__":
    if not sys.flags.safe_path:
        del sys.path[0]  # the working directory, where a file may be called like a package
    from faultpath.cli.main import main

    main()
