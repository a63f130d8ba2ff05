"""Model files and netlists to a Model and back."""

from hybond.files.encode import to_data
from hybond.files.load import from_data, load, loads
from hybond.files.save import dumps, save

__all__ = ["dumps", "from_data", "load", "loads", "save", "to_data"]
