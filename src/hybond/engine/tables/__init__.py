"""A flat graph as the tables and expressions that the runtime of an export reads."""

from hybond.engine.tables.answers import answered
from hybond.engine.tables.columns import ModelTables, written_tables
from hybond.engine.tables.make import tables_of

__all__ = ["ModelTables", "answered", "tables_of", "written_tables"]
