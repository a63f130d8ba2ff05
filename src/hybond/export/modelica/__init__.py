"""A model as one flat hybrid Modelica model with the same events.

`write` puts the text together. Data flows so::

    refusals                  what Modelica has no words for
    solve, jumping            equations of each mode in symbols; which stored quantities jump
    live, rules, start        texts with parameters as names; transitions; how the start settles
    draft                     all of these, the names given, the text so far
    identifiers, expressions, pairs, inputs, terms, trees    how each thing is written
    variables                 what a name is; declared when it is first read
    levels, jumps, parameters the parts of the text that are events, jumps, parameters
"""

from hybond.export.modelica.write import to_modelica

__all__ = ["to_modelica"]
