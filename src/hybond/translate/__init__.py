"""Portable Python, a small typed subset of Python, printed as C99 and as Java.

This page is the definition of the subset. A portable module is ordinary Python: it runs in
CPython, is checked by mypy, and is tested like any other. `load` says where a module leaves the
subset, `effects_of` where the order of evaluation would matter.

Modules
-------
A module has a docstring, imports, constants, records and functions, in this order or mixed.
Imports are ``from __future__ import annotations``, ``import math``, ``from typing import Final``,
words from ``portable.words``, and names from other portable modules of the same folder. No name
begins with an underscore. Records of all modules have different names. A constant or function is
printed with the name of its module before it where another module, or C or Java, has its name; a
variable or field that is a word there gets an underscore at its end.

A constant is ``NAME: Final = 1e-12``: a number, True or False, a text, or arithmetic of numbers and
earlier constants; or ``float_table(...)``, ``int_table(...)``, a table that nothing writes to.

A record is a class under ``@record`` with annotated fields, each with a comment or a docstring
line below it if wanted; ``Kind()`` makes one whose numbers are zero and whose references are None.
Records are references. ``@given`` before a class or a function says that each model brings it
along: a table in C or Java instead of what Python says. The body of a given function is not read;
a field of type ``Outside`` exists in Python only.

Types
-----
``int`` (32 bits), ``float`` (64 bits), ``bool``, ``Text`` (literals and names of the model, handed
on, or compared with ``""``), ``Floats``, ``Ints`` (arrays of fixed length, made by ``floats(n)``
and ``ints(n)``, zeros at first; their length is not asked, sizes are passed along), records,
``Records[Kind]`` (an array of references made by ``records(Kind, n)``, all None at first) and
``Kind | None``.
``some(x)`` is x, which is not None. An int goes where a float is wanted; nothing else changes by
itself.

Functions
---------
Each parameter and the result are annotated; calls are positional. Several results come back
through arrays or records. There are no exceptions: a function returns a status, and leaves the
reason in a record.

A local variable is declared by its first assignment, with or without annotation, and has one type.
It is not read before it is certainly assigned; in a loop, what an earlier round assigned does not
count. The variable of a ``for`` belongs to its loop, and no
variable that has a value there has its name; it is ``_`` where nothing reads it. Every
variable is read somewhere.

Statements: an expression's value to a name, an element or a field; ``+=`` and its kind; ``if``,
``elif``, ``else``; ``while``; ``for i in range(...)`` with a step that is a literal; ``break``,
``continue``, ``return``, ``pass``; a call.

Expressions: ``+ - *`` of numbers, ``/`` of which one side is a float, ``//`` and ``%`` of whole
numbers (not negative), comparisons of two, ``is None``, ``and``, ``or``, ``not`` of bools,
``a if c else b``, ``& | ^ << >>`` of whole numbers, ``float(i)``, ``int(x)``, ``abs``, ``min``,
``max`` of two; of `math` the functions sqrt exp expm1 log log1p log10 sin cos tan asin acos atan
atan2 sinh cosh tanh hypot fabs floor ceil pow fmod copysign isfinite isnan (floor and ceil are
floats here) and the constants inf, nan and pi. ``quotient(a, b)`` divides where b may be zero;
``/`` does not.

A call that changes something stands where no other part of the statement can see whether it came
first: alone on the right side, as the statement, as what is returned or compared.

Text goes out by ``put_text``, ``put_number``, ``put_int`` and ``put_line``.

Comments
--------
Docstrings, lines of comment and comments behind a statement are carried over to the printed text.
What stands under a heading "Examples" of a docstring is not.
"""

from hybond.translate.errors import PortableError
from hybond.translate.modules import Program, load, load_texts

__all__ = ["PortableError", "Program", "load", "load_texts"]
