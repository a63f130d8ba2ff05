"""What users have to know of the parts of the library, read once for all tests that look at it."""

from __future__ import annotations

from functools import cache

import hybond as hb

sheet_of = cache(hb.library.sheet)
SHARE_SHEETS = (
    "library/test_every_part.py",
    "library/test_every_port_has_a_mate.py",
    "library/test_library_pages.py",
)
"""Files of tests that one worker runs: reading all sheets takes three seconds."""
