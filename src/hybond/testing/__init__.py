"""Random hybrid bond graphs, and what must hold of every run.

`random_recipe` draws a graph from a seed, `check_recipe` and `check_model` run it in ways that must
agree, `recipes` is the same as a strategy of hypothesis.

>>> from hybond.testing import check_recipe, random_recipe
>>> check_recipe(random_recipe(1)).outcome
'ok'
"""

from hybond.testing.check import WAYS, Check, Finding, check_model, check_recipe
from hybond.testing.curves import Curve
from hybond.testing.drawing import random_recipe
from hybond.testing.recipe import Bond, Part, Recipe, Switch
from hybond.testing.strategy import recipes
from hybond.testing.variants import Variant, renamed, reordered, turned

__all__ = [
    "WAYS",
    "Bond",
    "Check",
    "Curve",
    "Finding",
    "Part",
    "Recipe",
    "Switch",
    "Variant",
    "check_model",
    "check_recipe",
    "random_recipe",
    "recipes",
    "renamed",
    "reordered",
    "turned",
]
