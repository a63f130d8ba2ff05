"""A model as one flat hybrid Modelica model with the same events."""

from hybond.export.modelica.write import to_modelica

__all__ = ["to_modelica"]
