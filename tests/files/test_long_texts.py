"""Files of millions of letters are looked at in memory of their own size; their tokens stay."""

import random
import re
import tracemalloc

import pytest

from hybond.files import json_lines, parse, toml_lines, toml_syntax

LONG = 1_000_000


@pytest.mark.parametrize(
    ("pattern", "text"),
    [
        (json_lines._TOKEN, '"' + r"\u00e9" * (LONG // 6) + '"'),
        (json_lines._TOKEN, '"' + "a" * LONG + '"'),
        (parse._MASKED, '"' + r"\n" * (LONG // 2) + '"'),
        (parse._MASKED, '"""' + '\\""a' * (LONG // 4) + '"""'),
        (toml_lines._TOKEN, '"""' + "a\n" * (LONG // 2) + '"""'),
        (toml_syntax._STRING, '"' + r"\"" * (LONG // 2) + '"'),
    ],
)
def test_a_long_text_takes_no_memory_per_letter(pattern: re.Pattern[str], text: str) -> None:
    tracemalloc.start()
    try:
        found = pattern.match(text)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert found is not None and found.end() == len(text)
    assert most < LONG / 4


@pytest.mark.parametrize(
    ("pattern", "plain"),
    [
        (json_lines._TOKEN, r'"(?:[^"\\]|\\.)*"|[\[\]{},:\n]|[^\s"\[\]{},:]+'),
        (toml_syntax._STRING, r""""(?:[^"\\\n]|\\.)*"|'[^'\n]*'"""),
        (
            parse._MASKED,
            r'"""(?:[^\\]|\\.)*?"{3,5}'
            r"|'{3}.*?'{3,5}"
            r"""|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'|\#[^\n]*""",
        ),
    ],
)
def test_texts_end_where_the_plain_rule_says(pattern: re.Pattern[str], plain: str) -> None:
    rule = re.compile(plain, pattern.flags)
    draw = random.Random(7)
    for _ in range(5000):
        text = "".join(draw.choice('""""\\\'a\n#[,') for _ in range(draw.randint(1, 14)))
        assert [m.span() for m in pattern.finditer(text)] == [
            m.span() for m in rule.finditer(text)
        ], text
