"""``hybond library``: the ready parts by domain or by a word, or what there is to know of one."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Iterator, Sequence

from hybond.cli.streams import say
from hybond.errors import UsageError
from hybond.library import Sheet, names, sheet
from hybond.library.sheets import Line
from hybond.library.shelves import title_of
from hybond.names import did_you_mean, in_columns


def library(given: Namespace) -> int:
    """List all parts, those of a domain or with a word, or print one."""
    domains = sorted({name.partition(".")[0] for name in names()})
    if given.part is not None and given.part not in (*names(), *domains):
        found = _with_word(given.part)
        if not found or given.file:
            raise UsageError(
                f"there is no ready part {given.part!r}",
                code="HB-X110",
                where="hybond library",
                hint=_remedy(given.part, found, domains),
            )
        say("\n".join(_lines(found)))
        return 0
    if given.part is None or given.part in domains:
        if given.file:
            raise UsageError(
                "--file prints one part",
                code="HB-X110",
                where="--file",
                hint="hybond library electrical.diode --file",
            )
        chosen = domains if given.part is None else [given.part]
        say("\n\n".join("\n".join(_listed(domain)) for domain in chosen))
        return 0
    page = sheet(given.part)
    if given.file:
        sys.stdout.write(page.text)
    else:
        say("\n".join(_page(page)))
    return 0


def _with_word(word: str) -> list[str]:
    """Return the parts with a word in name or title; a path with a dot is no word."""
    word = word.lower()
    if "." in word:
        return []
    return [n for n in names() if word in n.partition(".")[2] or word in title_of(n).lower()]


def _remedy(wanted: str, found: Sequence[str], domains: Sequence[str]) -> str:
    if found:
        return f"did you mean {', '.join(map(repr, found[:3]))}?"
    near = did_you_mean(wanted, [*names(), *domains])
    if not near.startswith("did"):  # the name without its shelf
        near = did_you_mean(wanted, sorted({n.partition(".")[2] for n in names()}))
    return near if near.startswith("did") else "hybond library lists them all"


def _listed(domain: str) -> Iterator[str]:
    yield domain
    yield from _lines([name for name in names() if name.startswith(f"{domain}.")])


def _lines(chosen: Sequence[str]) -> list[str]:
    return in_columns((f"  {name}", title_of(name)) for name in chosen)


def _page(of: Sheet) -> Iterator[str]:
    yield of.name
    yield f"{of.title}."
    yield ""
    yield of.about
    yield from _section("ports", [(p.name, f"{p.domain}, shares its {p.shares}") for p in of.ports])
    yield from _section("parameters", [(k.name, k.value, k.about) for k in of.parameters])
    yield from _section("inputs", [(k.name, _with_unit(k), k.about) for k in of.inputs])
    yield from _section("signals", [(k.name, k.unit, k.about or k.value) for k in of.signals])
    yield ""
    yield "in a model file"
    yield f"  {_element(of)}"


def _with_unit(line: Line) -> str:
    """Return the value of an input with its unit, which a quantity has already."""
    own = line.value.partition(" ")[2]
    return line.value if own else f"{line.value} {line.unit}".strip()


def _element(of: Sheet) -> str:
    """Return the line of a model file that has the part, with its first parameter and input."""
    words = [f'submodel = "{of.name}"']
    if of.parameters:
        first = of.parameters[0]
        words.append(f'parameters = {{ {first.name} = "{first.value}" }}')
    if of.inputs:
        words.append(f'inputs = {{ {of.inputs[0].name} = "..." }}')
    return f"x = {{ {', '.join(words)} }}"


def _section(title: str, rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    if rows:
        yield ""
        yield title
        yield from in_columns((f"  {row[0]}", *row[1:]) for row in rows)
