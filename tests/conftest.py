"""Random tests draw the same examples in every run; ``HYBOND_FUZZ=1`` draws new ones."""

import os

from hypothesis import settings

settings.register_profile("same", derandomize=True, deadline=None, database=None)
settings.register_profile("new", deadline=None)
settings.load_profile("new" if os.environ.get("HYBOND_FUZZ") else "same")
