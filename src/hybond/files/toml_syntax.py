"""What is wrong with a text that is not TOML, in words, and what to write instead."""

from __future__ import annotations

import re

from hybond.files.place import quoted, shortened

_NUMBER = re.compile(r"[+-]?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?")
_LIKE_A_NUMBER = re.compile(r"[+-]?[\d.][\d._]*(?:[eE][+-]?\d*)?")
_VALUE = re.compile(r"""[^,\]}#\n]*""")
_STRING = re.compile(r'"[^"\\\n]*+(?:\\.[^"\\\n]*+)*+"|\'[^\'\n]*\'')
_CURLY = "“”„‟‘’‚«»"
_WORDS = {"True": "true", "TRUE": "true", "False": "false", "FALSE": "false"}
_NOTHING = ("None", "null", "nil", "Null", "none")


def explain(text: str, at: int, message: str) -> tuple[str, str]:
    r"""Return the reason and the remedy of a syntax error.

    Parameters
    ----------
    at : int
        Where reading stopped, in characters.
    message : str
        What the parser says, in its own words.

    Examples
    --------
    >>> explain("[elements]\nL = { I = ms }\n", 21, "Invalid value")
    ('ms is no number and stands in no quotes', 'put the expression in quotes: "ms"')
    """
    start = text.rfind("\n", 0, at) + 1
    line = text[start:].split("\n", 1)[0].rstrip("\r")
    here = at - start
    low = message.lower()
    for mark in _CURLY:
        outside = _STRING.sub("", line.split("#", 1)[0])
        if mark in outside:
            return f"{mark} is not a quote of TOML", 'write straight quotes: "..."'
    if "overwrite" in low or "duplicate" in low:
        # of a whole statement it is the key in front, whatever its value holds
        ended = not line[here:].split("#", 1)[0].strip()
        key = _key(line, _first(line) + 1 if ended and "overwrite" in low else here)
        return f"the key {quoted(key)} is there twice", "rename one of them, or take one out"
    if "declare" in low:
        name = line.strip().strip("[]").strip()
        return (
            f"the section [{shortened(name)}] is there twice, or its name is taken",
            "put what stands in both under one header",
        )
    if "immutable" in low:
        return (
            "a table that was written in braces or as a value is added to here",
            "write all of it in one place",
        )
    if "unterminated" in low or ("illegal" in low and "\\n" in low) or _is_open(line):
        return "a text is not closed on its line", "close it with the quote that opened it"
    if "illegal character" in low or "invalid character" in low:
        return "a control character, which TOML forbids", "take it out, or write it as \\t or \\n"
    if "escape" in low or "\\" in low or "hex" in low or "unicode scalar" in low:
        return (
            r"a \ in a text in double quotes begins an escape that TOML has not",
            r"write \\, or put the text in single quotes",
        )
    return _of_statement(line, here, low)


def _of_statement(line: str, here: int, low: str) -> tuple[str, str]:
    bare = line.strip()
    if bare.startswith("[") and "=" not in bare and ("declaration" in low or "key part" in low):
        return "the header of a section is not closed", "write [elements], with a ] at its end"
    if not line[:here].count("=") and ("after a key" in low or "invalid statement" in low):
        if ":" in bare:
            return "a : stands where TOML has =", 'write key = "value"'
        return "this is no header, no key with a value and no comment", 'write key = "value"'
    at = _value_start(line, here)
    if at is None and "array" in low:
        return "a list goes on without a comma, or is not closed", "put commas between its items"
    if at is None:
        return "the text is not TOML from here on", 'write key = "value", a [header] or a # comment'
    value = _VALUE.match(line, at)
    word = value[0].strip() if value else ""
    if not word and line[at : at + 1] in ("", "#", ",", "}", "]"):
        return "a value is missing", 'write one behind the =, such as "10 V"'
    if word in _WORDS:
        return f"{word} is not a value of TOML", f"write {_WORDS[word]}"
    if word in _NOTHING:
        return f"{word} is not a value of TOML", "leave the key out"
    if "array" in low and not line[:here].count("["):
        return "a list above is not closed", "close it with ], and put commas between its items"
    if _STRING.match(word) or word[:1] in "[{" or _NUMBER.fullmatch(word):
        return _of_list_or_table(line, at, here, low, bare)
    if _LIKE_A_NUMBER.fullmatch(word):
        return (
            f"{shortened(word)} is not a number of TOML",
            "write digits on both sides of the point and no 0 in front: 0.5, 5.0, 1e-3",
        )
    kind = "quantity" if word[:1].isdigit() and " " in word else "expression"
    shown = shortened(word.rstrip(";"))
    return (
        f"{shown} is no number and stands in no quotes",
        f'put the {kind} in quotes: "{shown}"',
    )


def _of_list_or_table(line: str, at: int, here: int, low: str, bare: str) -> tuple[str, str]:
    rest = line[here:].strip()
    before = line[at:here].rstrip()
    if re.search(r",\s*\}", line[at:]):
        return "a comma stands before }", "take it out: { C = 1, q = 2 }"
    if rest.startswith(";") or bare.endswith(";"):
        return "a ; ends no line of TOML", "take it out"
    opened = line[at : at + 1]
    if opened == "{" and line.count("{") > line.count("}"):
        return (
            "a table in braces is not closed on its line",
            "close it with }, and keep all of it on one line",
        )
    if rest[:1] == ":" or before.endswith(":"):
        return "a : stands where TOML has =", 'write { C = "1 mm/N" }'
    if re.match(r"[\w.-]+\s*=", rest):
        return (
            f"{quoted(shortened(rest, 40))} follows a value",
            "put a comma between two values, a new line between two keys",
        )
    if rest[:1].isalpha() and before.endswith('"'):
        return (
            "a quote within a text in double quotes ends it",
            'write \\" for it, or put the whole text in single quotes',
        )
    if rest[:1] == "," and opened not in "[{":
        return "a second value follows a comma", 'put the values in a list: ["a -> b", "b -> c"]'
    if rest and rest[0] not in "#":
        return (
            f"{quoted(shortened(rest, 40))} follows a value",
            "put a comma between two values, a new line between two keys",
        )
    if "array" in low or opened == "[":
        return "a list is not closed", "close it with ], and put commas between its items"
    return "a table in braces is not closed", "close it with }, on the same line"


def _is_open(line: str) -> bool:
    """Whether a quote on the line is never closed, comments and texts aside."""
    plain = _STRING.sub("", line)
    if '"""' in line or "'''" in line:
        return False
    plain = plain.split("#", 1)[0]
    return '"' in plain or "'" in plain


def _value_start(line: str, here: int) -> int | None:
    """Return where the value begins that is being read at `here`."""
    masked = _STRING.sub(lambda m: "s" * len(m[0]), line)
    equals = masked.rfind("=", 0, max(here, 1))
    if equals < 0:
        equals = masked.find("=")
    if equals < 0:
        return None
    at = equals + 1
    return at + len(line[at:]) - len(line[at:].lstrip())


def _first(line: str) -> int:
    """Return where the first = stands, outside of texts."""
    return _STRING.sub(lambda m: "s" * len(m[0]), line).find("=")


def _key(line: str, here: int) -> str:
    masked = _STRING.sub(lambda m: "s" * len(m[0]), line)
    equals = masked.rfind("=", 0, max(here, 1))
    before = line[: equals if equals >= 0 else len(line)]
    words: list[str] = re.findall(r"[\w.-]+", before)
    return words[-1] if words else before.strip()
