"""``python -m hybond`` is the command line."""

import sys

from hybond.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
