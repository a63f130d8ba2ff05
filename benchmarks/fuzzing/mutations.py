"""Changes of good inputs: of bytes, tokens, lines, numbers and trees, all drawn from a seed."""

from __future__ import annotations

import contextlib
import copy
import random
import re
from collections.abc import Callable, Sequence
from itertools import islice
from typing import Any

NUMBERS = (
    *("0", "-0", "-0.0", "1", "-1", "2", "0.5", "1e-9", "1e9", "1e300", "-1e300", "1e308", "1e309"),
    *("1e400", "-1e400", "1e-320", "5e-324", "1e-400", "nan", "inf", "-inf", "+inf", "NaN"),
    *("2147483647", "2147483648", "-2147483649", "4294967296", "9223372036854775807"),
    *("9223372036854775808", "18446744073709551616", "1" + "0" * 400, "9" * 5000, "0." + "0" * 999),
    *("1_000", "0x10", "0b1", "007", "1e", "e5", ".5", "5.", "1.5.2", "--1", "+-1", "1,5", "1/0"),
    *("٣", "²", "１２", "½", "1 e5", "1e+", "1e5000", "0e0", "1d3", "1meg", "1e999999999999"),
)
NAMES = (
    *(
        "x",
        "e",
        "f",
        "p",
        "q",
        "time",
        "pre",
        "nan",
        "inf",
        "true",
        "null",
        "None",
        "self",
        "__class__",
    ),
    *("constructor", "__proto__", "hybond", "elements", "start", "start_mode", "if", "for", "int"),
    *("and", "or", "not", "when", "->", "a.b", "a b", "", " ", ".", "..", "../up", "/etc/passwd"),
    *(
        "C:\\x",
        "a\x00b",
        "\n",
        "\t",
        "\x1b[31mred\x1b[0m",
        "é",
        "Ω",
        "µ",
        "𝔘",
        "\u202eabc",
        "a\u0301",
    ),
    *(
        "名",
        "🜚",
        "\ud800",
        "\ufeff",
        "\u2028",
        "\\",
        '"',
        "'",
        "'''",
        '"""',
        "#",
        "$",
        "{}",
        "{{",
        "%s",
    ),
    *(
        "%(x)s",
        "<b>",
        "&amp;",
        "<!--",
        "]]>",
        "\\input{x}",
        "*/",
        "//",
        "`x`",
        "$(id)",
        ";",
        ":",
        "=",
        "!",
    ),
    *("a" * 300, "a" * 70_000, "a." * 200 + "a", "é" * 5000, "x[0]", "x[1..3]", "x[-1]", "x[1e9]"),
)
VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 2, 10**6, 2**31, 2**63, 2**64, 10**400, -(10**30)),
    *(0.0, -0.0, 0.5, 1e-320, 1e308, 1e-300, 3.5, 1e20),
    *("", "1", "1 kg", "-1", "x", "time", "a -> b", "1e400", "sin(time)", "time/0", "nan"),
    *(
        [],
        {},
        [[]],
        [1, 2, 3],
        ["a"],
        [1, "a", None],
        {"a": 1},
        {"a": {"a": {}}},
        {"R": 1},
        {"C": 0},
    ),
    *([0.0, 0.0], [[0, 0], [1, 1]], [[0, 0], [0, 1]], [1e400], {"submodel": "a"}, {"junction": 1}),
    *({"": 1}, {"a.b": 1}, ["a", ["b", ["c"]]], [1] * 1000, {str(k): k for k in range(300)}),
)
TOKEN = re.compile(
    r"[A-Za-z_][\w]*|[-+]?\d[\w.]*(?:[eE][-+]?\d+)?|\"[^\"\n]*\"|'[^'\n]*'|[ \t]+|\n|\S", re.ASCII
)
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
WORD = re.compile(r"[A-Za-z_]\w*")
DEPTHS = (3, 40, 70, 120, 300, 1200, 5000, 30_000)
PAIRS = (("(", ")"), ("[", "]"), ("{", "}"), ("{a=", "}"), ('{"a":', "}"), ("-", ""), ("not ", ""))
PAIRS += (("sin(", ")"), ("1+", ""), ("<a>", "</a>"), ("if(", ",1,2)"), ("!", ""), ("2^", ""))
COUNTS = (2, 5, 30, 300, 3000)

LONGEST = 2_000_000
"""Letters of a changed text."""


def changed_text(draw: random.Random, text: str, others: Sequence[str] = ()) -> str:
    """Return a text with one to eight changes, each of tokens, lines, numbers or letters."""
    for _ in range(draw.choice((1, 1, 1, 2, 2, 3, 5, 8))):
        text = draw.choice(CHANGES)(draw, text, others)
        if len(text) > LONGEST:
            return text[:LONGEST]
    return text


def changed_bytes(draw: random.Random, data: bytes) -> bytes:
    """Return bytes with one to eight changes."""
    found = bytearray(data)
    for _ in range(draw.choice((1, 1, 2, 4, 8))):
        at = draw.randrange(len(found) + 1)
        end = min(len(found), at + draw.choice((1, 1, 2, 4, 16, 200)))
        match draw.randrange(7):
            case 0:
                found[at:end] = draw.randbytes(end - at)
            case 1:
                del found[at:end]
            case 2:
                found[at:at] = draw.randbytes(draw.choice((1, 2, 4, 50)))
            case 3:
                found[at:at] = found[at:end] * draw.choice((1, 2, 50))
            case 4:
                extremes = (b"\0", b"\xff", b"\xef\xbb\xbf", b"\r\n", b"\x1b", b"\xff\xff\xff\xff")
                new = draw.choice(extremes)
                found[at : at + len(new)] = new
            case 5:
                del found[at:]
            case _ if at < len(found):
                found[at] ^= 1 << draw.randrange(8)
    return bytes(found)


def name(draw: random.Random) -> str:
    """Return a name as nobody would choose it."""
    return draw.choice(NAMES)


def _number(draw: random.Random, text: str, _: Sequence[str]) -> str:
    return _replaced(draw, text, NUMBER, lambda old: _other_number(draw, old))


def _other_number(draw: random.Random, old: str) -> str:
    if draw.random() < 0.5:
        return draw.choice(NUMBERS)
    factor = draw.choice(("0", "1e3", "1e-3", "1e9", "1e-9", "1e30", "-1"))
    return f"{float(old) * float(factor):.6g}" if len(old) < 300 else "1"


def _word(draw: random.Random, text: str, others: Sequence[str]) -> str:
    words = WORD.findall(text)
    new = draw.choice(words) if words and draw.random() < 0.5 else name(draw)
    if draw.random() < 0.3 and words:  # everywhere
        old = draw.choice(words)
        return re.sub(rf"\b{old}\b", lambda _: new, text)
    return _replaced(draw, text, WORD, lambda _: new)


def _replaced(
    draw: random.Random, text: str, what: re.Pattern[str], by: Callable[[str], str]
) -> str:
    many = sum(1 for _ in what.finditer(text))
    if not many:
        return text
    # one at a time: a list of them may need a thousand times what the text does
    at = next(islice(what.finditer(text), draw.randrange(many), None))
    return text[: at.start()] + by(at[0]) + text[at.end() :]


def _tokens(draw: random.Random, text: str, _: Sequence[str]) -> str:
    tokens = TOKEN.findall(text)
    if not tokens:
        return text
    at, other = draw.randrange(len(tokens)), draw.randrange(len(tokens))
    match draw.randrange(5):
        case 0:
            del tokens[at]
        case 1:
            tokens[at], tokens[other] = tokens[other], tokens[at]
        case 2:
            tokens.insert(at, tokens[other])
        case 3:
            tokens[at] *= _fitting(tokens[at], draw.choice(COUNTS))
        case _:
            tokens[at] = draw.choice("=.,:;+-*/^&|<>()[]{}#\"'\\\n\t?@$%!~") * draw.choice(
                (1, 1, 2)
            )
    return "".join(tokens)


def _fitting(text: str, many: int) -> int:
    """Return how often a text is repeated, if so many times: what is cut off need not be made."""
    return min(many, LONGEST // (len(text) + 1) + 1)


def _lines(draw: random.Random, text: str, others: Sequence[str]) -> str:
    lines = text.split("\n")
    at, other = draw.randrange(len(lines)), draw.randrange(len(lines))
    match draw.randrange(6):
        case 0:
            del lines[at]
        case 1:
            lines.insert(other, lines[at])
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case 3:
            lines[at : at + 1] = [lines[at]] * _fitting(lines[at], draw.choice(COUNTS))
        case 4 if others:
            source = draw.choice(others).split("\n")
            start = draw.randrange(len(source))
            lines[at:at] = source[start : start + draw.choice((1, 3, 20))]
        case _:
            lines = lines[:at]
    return "\n".join(lines)


def _deep(draw: random.Random, text: str, _: Sequence[str]) -> str:
    """Put a token into many brackets."""
    tokens = TOKEN.findall(text)
    if not tokens:
        return text
    at, depth = draw.randrange(len(tokens)), draw.choice(DEPTHS)
    left, right = draw.choice(PAIRS)
    tokens[at] = left * depth + tokens[at] + right * draw.choice((depth, depth, depth - 1, 0))
    return "".join(tokens)


def _letters(draw: random.Random, text: str, _: Sequence[str]) -> str:
    at = draw.randrange(len(text) + 1)
    end = at + draw.choice((0, 0, 1, 5))
    return text[:at] + name(draw)[:200] + text[end:]


CHANGES = (_number, _number, _word, _word, _tokens, _tokens, _lines, _lines, _deep, _letters)


def changed_tree(draw: random.Random, tree: Any, others: Sequence[Any] = ()) -> Any:
    """Return plain data with one to five nodes changed; the given ones stay as they are."""
    new = copy.deepcopy(tree)
    for _ in range(draw.choice((1, 1, 1, 2, 3, 5))):
        places = list(_places(new))
        if not places:
            return new
        holder, key = draw.choice(places)
        with contextlib.suppress(RecursionError):  # deeper than Python copies
            _change(draw, holder, key, places, others)
    return new


def _places(tree: Any) -> Any:
    stack = [tree]
    while stack:
        node = stack.pop()
        keys = list(node) if isinstance(node, dict) else range(len(node))
        for key in keys:
            yield node, key
            if isinstance(node[key], dict | list):
                stack.append(node[key])


def _change(
    draw: random.Random, holder: Any, key: Any, places: Sequence[Any], others: Sequence[Any]
) -> None:
    old = holder[key]
    match draw.randrange(10):
        case 0:
            del holder[key]
        case 1:
            holder[key] = copy.deepcopy(draw.choice(VALUES))
        case 2:
            there, other = draw.choice(places)
            with_old = there[other] if _has(there, other) else None
            holder[key] = copy.deepcopy(with_old)
        case 3 if others:
            at, other = draw.choice(list(_places(draw.choice(others))) or [({0: 0}, 0)])
            holder[key] = copy.deepcopy(at[other])
        case 4 if isinstance(holder, dict):
            holder[draw.choice([*NAMES, *map(str, holder)])] = copy.deepcopy(old)
        case 5 if isinstance(holder, dict):
            del holder[key]
            holder[name(draw)] = old
        case 6 if isinstance(holder, list):
            many = min(draw.choice(COUNTS), 1 + 100_000 // (1 + len(str(old))))
            holder[key:key] = [copy.deepcopy(old) for _ in range(many)]
        case 7:
            for _ in range(draw.choice(DEPTHS[:5])):
                old = [old] if draw.random() < 0.5 else {"a": old}
            holder[key] = old
        case _ if isinstance(old, str):
            holder[key] = changed_text(draw, old)
        case _ if isinstance(old, int | float) and not isinstance(old, bool):
            holder[key] = draw.choice(
                [-old, 0, old * 1000, old / 1000 if abs(old) < 1e300 else 0, *VALUES[4:21]]
            )
        case _:
            holder[key] = copy.deepcopy(draw.choice(VALUES))


def _has(holder: Any, key: Any) -> bool:
    return key in holder if isinstance(holder, dict) else 0 <= key < len(holder)
