"""What Modelica has no words for, refused before anything is derived."""

from __future__ import annotations

from hybond.errors import ModelError
from hybond.model.graph import FlatGraph


def no_words(what: str, where: str, hint: str) -> ModelError:
    """Return the refusal of what Modelica cannot say."""
    return ModelError(f"Modelica has no words for {what}", code="HB-E680", where=where, hint=hint)


def refuse(graph: FlatGraph) -> None:
    """Refuse a graph with something that Modelica has no words for.

    Raises
    ------
    ModelError
        HB-E680.
    """
    for s in graph.samples:
        raise no_words(
            "what is sampled at instants, here" if s.block is None else "code from elsewhere",
            s.path,
            "a sampled signal reads values before the instant; export C, Java or an FMU",
        )
    laws = [m for m in graph.machines if m.law is not None]
    hint = "export C or an FMU"
    for machine in laws:
        law = machine.law
        assert law is not None
        if law.planar or law.second is not None:
            raise no_words("friction in two directions", machine.path, hint)
        if law.impulsive:
            raise no_words("friction that carries impulses", machine.path, hint)
    for node in graph.nodes:
        if node.impulsive and graph.machines:
            raise no_words("a resistor that carries impulses", node.path, hint)
