"""A flat graph as the tables and expressions that the runtime of an export reads."""

from hybond.export.tables.answers import answered
from hybond.export.tables.make import ModelTables, tables_of

__all__ = ["ModelTables", "answered", "tables_of"]
