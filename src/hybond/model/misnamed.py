"""Refusals of what a user of a submodel names and it has not: ports, parameters, inputs."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from hybond.errors import ModelError
from hybond.names import did_you_mean


def no_such_end(
    bond: str, path: str, where: str, nodes: Iterable[str], ports: Iterable[str]
) -> ModelError:
    """Return the refusal of a bond that ends nowhere: HB-M101.

    Parameters
    ----------
    bond, path, where : str
        The bond as written, the end that is not there, and where the bond stands.
    nodes, ports : iterable of str
        All nodes, those inside submodels too, and all ports of submodels.

    Examples
    --------
    >>> print(no_such_end("V -> R.a", "V", "bonds[0]", ["V.i", "R.i"], ["V.plus", "V.minus"]))
    HB-M101 at bonds[0]: the bond 'V -> R.a' ends at 'V', which is a submodel and no port of it
      try: its ports are V.minus, V.plus
    """
    inside = list(nodes)
    owner, _, port = path.rpartition(".")
    if any(n.startswith(f"{path}.") for n in inside):
        what, owner = "which is a submodel and no port of it", path
    elif owner and any(n.startswith(f"{owner}.") for n in inside):
        what = f"but {owner!r} has no port {port!r}"
    else:
        # what lies deeper than the bond cannot be meant
        depth = path.count(".")
        near = [n for n in dict.fromkeys((*inside, *ports)) if n.count(".") <= depth]
        hint = did_you_mean(path, near or inside) or "add the element, or take the bond out"
        return _refusal(bond, path, where, "which is not an element", hint)
    own = [p for p in ports if p.rpartition(".")[0] == owner]
    hint = f"its ports are {', '.join(sorted(own))}" if own else "it has no ports"
    return _refusal(bond, path, where, what, hint)


def no_such_target(port: str, target: str, nodes: Iterable[str]) -> ModelError:
    """Return the refusal of a port that leads nowhere: HB-M101.

    Examples
    --------
    >>> print(no_such_target("leak.a", "leak.m", ["leak.n", "V"]))
    HB-M101 at leak.a: the port 'a' leads to 'm', which is not an element of its model
      try: did you mean 'n'?
    """
    owner, _, name = port.rpartition(".")
    dot = f"{owner}." if owner else ""
    inside = [n.removeprefix(dot) for n in nodes if n.startswith(dot)]
    inner = target.removeprefix(dot)
    hint = did_you_mean(inner, inside) or "add the element, or take the port out"
    if len(inside) == 1:
        hint = f"did you mean {inside[0]!r}?"
    return ModelError(
        f"the port {name!r} leads to {inner!r}, which is not an element of its model",
        code="HB-M101",
        where=port,
        hint=hint,
    )


def _refusal(bond: str, path: str, where: str, what: str, hint: str) -> ModelError:
    text = f"the bond {bond!r} ends at {path!r}, {what}"
    return ModelError(text, code="HB-M101", where=where, hint=hint)


def check_given(
    given: Iterable[str],
    kind: str,
    known: Mapping[str, Collection[str]],
    submodel: str,
    path: str,
) -> None:
    """Refuse values for what a submodel does not have.

    Parameters
    ----------
    given : iterable of str
        Names that values are given for.
    kind : str
        What they are to be, ``"parameter"`` or ``"input"``.
    known : mapping
        Names that the submodel has, by kind.
    submodel, path : str
        Its name, and where it stands.

    Raises
    ------
    ModelError
        HB-M107 for a parameter, HB-M111 for an input.

    Examples
    --------
    >>> known = {"parameter": ["R_on"], "input": ["gate"]}
    >>> check_given(["gate"], "parameter", known, "switch", "S1")
    Traceback (most recent call last):
        ...
    hybond.errors.ModelError: HB-M107 at S1.gate: the submodel 'switch' has no parameter 'gate'
      try: it is an input: give it under inputs
    """
    (other,) = known.keys() - {kind}
    for name in given:
        if name in known[kind]:
            continue
        hint = did_you_mean(name, known[kind])
        if name in known[other]:
            article = "an" if other == "input" else "a"
            hint = f"it is {article} {other}: give it under {other}s"
        raise ModelError(
            f"the submodel {submodel!r} has no {kind} {name!r}",
            code="HB-M107" if kind == "parameter" else "HB-M111",
            where=f"{path}.{name}",
            hint=hint or f"leave it out; it has no {kind}s",
        )
