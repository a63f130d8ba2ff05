"""Style sheets of several drawings in one page, as in a notebook: each is of its own drawing."""

from __future__ import annotations

import re

import hybond as hb


def rod(*, rigid: bool) -> hb.Model:
    m = hb.Model("rod", domain="rotational")
    m.add(T=hb.Se("1 N*m"), w=hb.One(), J=hb.I("1 kg*m^2"), load=hb.I("2 kg*m^2"))
    m.add(k=hb.C("1 rad/(N*m)"), z=hb.Zero(), v=hb.One())
    m.bond("T -> w -> J", *(["w -> load"] if rigid else ["w -> z -> v -> load", "z -> k"]))
    if rigid:
        for name in ("k", "z", "v"):
            del m.elements[name]
    return m


def scopes(drawing: str) -> tuple[set[str], set[str], str]:
    """Return the classes of a drawing, those that its sheet begins its selectors with, and it."""
    root = re.search(r'<svg [^>]*class="([^"]*)"', drawing)
    sheet = re.search(r"<style>(.*?)</style>", drawing, re.DOTALL)
    assert root is not None and sheet is not None
    heads = [one for rule in re.findall(r"([^{}]+)\{", sheet[1]) for one in rule.split(",")]
    first = {m[1] for h in heads if (m := re.match(r"\s*\.([\w-]+)", h))}
    return set(root[1].split()), first, sheet[1]


def test_a_drawing_below_does_not_take_the_colour_of_derivative_causality() -> None:
    """The sheet of the second said how a stroke looks, and came after that of the first."""
    one, other = (rod(rigid=rigid).draw()._repr_svg_() for rigid in (True, False))
    classes, own, sheet = scopes(one)
    _, foreign, second = scopes(other)
    assert "derivative" in sheet and "derivative" not in second and ".stroke" in second
    assert own <= classes and own
    assert not foreign & classes


def test_drawings_of_the_same_words_share_their_sheet() -> None:
    turned = rod(rigid=True)
    turned.bonds = ["T -> w", "w -> J", "w -> load"]
    one, other = (m.draw()._repr_svg_() for m in (rod(rigid=True), turned))
    assert scopes(one) == scopes(other)
