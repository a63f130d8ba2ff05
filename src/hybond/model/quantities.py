"""Efforts, flows and what is stored by the words of each trade: a voltage is an effort, ``C.e``."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from hybond.model.graph import Node

_EFFORTS: Mapping[str, tuple[str, ...]] = {
    "electrical": ("voltage", "v", "u", "volt", "volts", "potential", "emf"),
    "translational": ("force", "tension", "load"),
    "rotational": ("torque", "moment", "tau", "m", "t"),
    "hydraulic": ("pressure", "p", "dp", "head"),
    "thermal": ("temperature", "temp", "t"),
    "thermal_pseudo": ("temperature", "temp", "t"),
    "magnetic": ("mmf", "magnetomotive_force"),
}
_FLOWS: Mapping[str, tuple[str, ...]] = {
    "electrical": ("current", "i", "amps", "amperes", "curr"),
    "translational": ("velocity", "speed", "v", "vel"),
    "rotational": ("speed", "omega", "w", "velocity", "angular_velocity", "rpm"),
    "hydraulic": ("flow", "flow_rate", "flowrate", "volume_flow", "discharge"),
    "thermal": ("entropy_flow", "flow"),
    "thermal_pseudo": ("heat_flow", "heatflow", "heat_rate", "flow", "qdot"),
    "magnetic": ("flux_rate", "dphi"),
}
_STORED = {
    "q": ("charge", "displacement", "position", "deflection", "extension", "x", "angle", "volume")
    + ("entropy", "heat", "flux"),
    "p": ("momentum", "flux", "flux_linkage", "impulse", "pressure_momentum"),
}
_GENERAL = {"e": ("effort", "across"), "f": ("flow", "through")}
_LETTERS = {
    ("hydraulic", "Q"): "f",
    ("translational", "F"): "e",
    ("thermal_pseudo", "Q"): "f",
}
"""Capital letters: small ones mean something else here."""
_OWN = {("C", "q"): "e", ("I", "p"): "f"} | {(r, x): y for r in "RG" for x, y in ("fe", "ef")}
"""What an element makes of a variable of its own, of its kind and that."""
_POWER = ("power", "pow", "watt", "watts")


def _variable(word: str, domain: str) -> str:
    """Return ``e`` or ``f`` for a word, in a domain or, if that has no such word, in any."""
    if (domain, word) in _LETTERS:
        return _LETTERS[domain, word]
    word = word.lower()
    for kind, by_domain in (("e", _EFFORTS), ("f", _FLOWS)):
        if word in by_domain.get(domain, ()) or word in _GENERAL[kind]:
            return kind
    for kind, by_domain in (("e", _EFFORTS), ("f", _FLOWS)):
        # of one letter, and of a speed, only the own domain tells which
        if len(word) > 1 and any(word in words for words in by_domain.values()):
            return kind
    return ""


def called_otherwise(text: str, node: Node, known: Collection[str]) -> str:
    """Return the remedy for a quantity of an element that is written in words of a trade.

    Parameters
    ----------
    text : str
        What is not known, such as ``C.voltage``.
    node : Node
        What stands before its last point.
    known : collection of str
        The names that there are.

    Returns
    -------
    str
        Nothing where the word says no quantity.
    """
    owner, _, said = text.rpartition(".")
    word = said.lower()
    domain = node.domain
    if word in _POWER and f"{owner}.e" in known and f"{owner}.f" in known:
        return f"the power of {owner} is {owner}.e*{owner}.f"
    for stored, words in () if (domain.name, said) in _LETTERS else _STORED.items():
        if word in words and f"{owner}.{stored}" in known:
            return f"the {said} of {owner} is {owner}.{stored}"
    variable = _variable(said, domain.name)
    if not variable:
        return ""
    kind = "effort" if variable == "e" else "flow"
    unit = domain.effort_unit if variable == "e" else domain.flow_unit
    name = f"{owner}.{variable}"
    in_unit = f", in {unit}" if unit else ""
    if name in known:
        return f"the {kind} of {owner} is {name}{in_unit}"
    if node.is_junction and not node.controlled:
        other = "f" if variable == "e" else "e"
        one = "flow" if variable == "e" else "effort"
        return (
            f"a {node.kind}-junction has one {one}, {owner}.{other}; each element at it has its "
            f"own {kind}"
        )
    if len(node.ends) > 1 and not node.is_junction:
        return f"{owner} has {len(node.ends)} ports: {owner}.1.{variable}, {owner}.2.{variable}"
    return ""


def made_of_its_own(text: str, where: str) -> str:
    """Return the remedy for a value of an element that reads a variable of the same element.

    Parameters
    ----------
    text : str
        What is not known.
    where : str
        The place of the value, such as ``elements.spring.C``.

    Returns
    -------
    str
        Nothing where that is no value of an element, or no variable of its own.

    Examples
    --------
    >>> made_of_its_own("q", "elements.spring.C")
    'a law in q of the element itself says what it makes: {"e": "..."}'
    """
    room, _, kind = where.rpartition(".")
    made = _OWN.get((kind, text), "") if room.startswith("elements.") else ""
    law = f'{{"{made}": "..."}}'
    return f"a law in {text} of the element itself says what it makes: {law}" if made else ""
