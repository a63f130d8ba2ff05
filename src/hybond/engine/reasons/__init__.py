"""Why a run ends, and what it warns of, in numbers."""
