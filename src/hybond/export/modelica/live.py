"""Guards and signals with parameters as names, where the graph has their values."""

from __future__ import annotations

from collections.abc import Mapping

from hybond.errors import HybondError
from hybond.model.arrays import index_texts
from hybond.model.builder import Model
from hybond.model.expressions import (
    Compare,
    Expr,
    Name,
    Number,
    String,
    names,
    parse,
    simplify,
    substitute,
    to_text,
    transform,
)
from hybond.model.graph import FlatGraph
from hybond.model.parts import Integral, SubmodelPart
from hybond.names import join


class Live:
    """Reads texts of a model again, parameters staying names ``p:...``.

    Parameters
    ----------
    graph : FlatGraph
        Of that model.
    """

    def __init__(self, model: Model, graph: FlatGraph) -> None:
        self.graph = graph
        self.values = {f"p:{path}": Number(float(v)) for path, v in graph.parameters.items()}
        self.written = {
            path: s.rate if isinstance(s, Integral) else s
            for path, s in model.signals.items()
            if isinstance(s, str | Integral)
        }
        self.rates = {i.path for i in graph.integrals if i.path in model.signals}
        self.watches = {f"at:{w.index}": w.compare for w in graph.watches}
        self.model = model
        self.fixed: set[str] = set()
        """Parameters whose values stand as numbers somewhere."""
        self._seen: set[str] = set()
        self._fix_elements()

    def expression(self, text: str, prefix: str, known: Expr) -> Expr:
        """Return what a text says, parameters as names.

        Parameters
        ----------
        text : str
            As written.
        prefix : str
            The path of the model that it is written in.
        known : Expr
            What it says with the values of parameters put in: returned as it is unless the text,
            read again, says exactly that.
        """
        try:
            found = self._read(text, prefix, ())
        except HybondError:
            self._fix(text, prefix)
            return known
        put_in = simplify(substitute(found, self.values))
        if _same(put_in, simplify(substitute(known, self.watches))):
            return found
        self._fix(text, prefix)
        return known

    def _fix(self, value: object, prefix: str = "") -> None:
        """Note that the parameters that a text reads, through signals too, stand as numbers."""
        if isinstance(value, Mapping):
            for part in value.values():
                self._fix(part, prefix)
            return
        if isinstance(value, list | tuple):
            for part in value:
                self._fix(part, prefix)
            return
        if not isinstance(value, str):
            return
        try:
            read = names(parse(value))
        except HybondError:
            return
        for name in sorted(read):
            path = join(prefix, name)
            if path in self.graph.parameters and path not in self.fixed:
                self.fixed.add(path)
                self._fix(self.model.parameters.get(path))
            elif path in self.written and path not in self._seen:
                self._seen.add(path)
                self._fix(self.written[path])

    def _fix_elements(self) -> None:
        """Note what start values, inputs, submodels and signals within laws take as numbers."""
        self.fixed |= {path for path in self.graph.parameters if "." in path}
        self._fix(list(index_texts(self.model)))
        for part in self.model.elements.values():
            if isinstance(part, SubmodelPart):
                self._fix(dict(part.parameters))
                self._fix(dict(part.inputs))
                continue
            self._fix({k: v for k, v in part.options.items() if k in ("e", "f", "p", "q")})
            self._fix_signals(part.value)
            self._fix(part.options.get("restitution"))
        for signal in self.model.signals.values():
            if isinstance(signal, Integral):
                self._fix(signal.start)
        for given in self.model.inputs.values():
            self._fix([given.constant, given.pwm or {}, list(given.table or ())])

    def _fix_signals(self, value: object) -> None:
        """Note what the signals in a law's text read: the equations have them in numbers."""
        texts = value.values() if isinstance(value, Mapping) else [value]
        for text in texts:
            if not isinstance(text, str):
                continue
            try:
                read = names(parse(text))
            except HybondError:
                continue
            for name in sorted(read & (self.written.keys() - self.rates)):
                self._fix(self.written[name])

    def signal(self, path: str, known: Expr) -> Expr:
        """Return a named signal of the model, or the rate of an integrated one."""
        text = self.written.get(path)
        return known if text is None else self.expression(text, "", known)

    def _read(self, text: str, prefix: str, inside: tuple[str, ...]) -> Expr:
        read = self.graph.read
        assert read is not None

        def named(e: Expr) -> Expr:
            if isinstance(e, Compare) and isinstance(e.right, String):
                return Name(f"?{to_text(Compare(e.op, _full(e.left, prefix), e.right))}")
            return e

        tree = transform(parse(text), named)
        mapping: dict[str, Expr] = {}
        for name in names(tree):
            if name.startswith("?"):
                mapping[name] = read(name[1:])
                continue
            path = join(prefix, name)
            if path in self.graph.parameters:
                mapping[name] = Name(f"p:{path}")
            elif path in self.written and path not in self.rates and path not in inside:
                mapping[name] = self._read(self.written[path], "", (*inside, path))
            elif name not in ("time", "pi"):
                mapping[name] = read(path)
        return substitute(tree, mapping)


def _full(e: Expr, prefix: str) -> Expr:
    return Name(join(prefix, e.path)) if isinstance(e, Name) else e


def _same(a: Expr, b: Expr) -> bool:
    """Whether two expressions say the same, dimensions of numbers aside."""

    def bare(e: Expr) -> Expr:
        return transform(e, lambda n: Number(n.value) if isinstance(n, Number) else n)

    return simplify(bare(a)) == simplify(bare(b))
