"""Ready parts by domain, as model files: ``electrical.diode`` is ``electrical/diode.toml``.

A part is a model like any other, with ports, parameters and inputs. It is read when a model names
it, and shared from then on: nobody changes it. `part` gives a copy to whoever wants to, `sheet`
what a user of it has to know.
"""

from hybond.library.sheets import Line, Port, Sheet, sheet
from hybond.library.shelves import SHELVES, find, names, part

__all__ = ["SHELVES", "Line", "Port", "Sheet", "find", "names", "part", "sheet"]
