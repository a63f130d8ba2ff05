"""A model on its way to text: what is known of it, the names given, what is declared and said."""

from __future__ import annotations

from hybond.export.modelica.identifiers import Identifiers
from hybond.export.modelica.jumping import jumping_of
from hybond.export.modelica.live import Live
from hybond.export.modelica.refusals import refuse
from hybond.export.modelica.rules import transitions
from hybond.export.modelica.solve import Form, without_impulses
from hybond.export.modelica.start import settled_start
from hybond.model.builder import Model
from hybond.model.expressions import uses_pre
from hybond.model.graph import FlatGraph

PATIENCE = 2
"""Event iterations in which laws, and after them rules, have their say before what follows: one
would do, but for tools that compare with the values of the iteration before."""


class Draft:
    """A model on its way to text; declarations and equations come up as they are read.

    Attributes
    ----------
    form, sudden : Form
        The equations; the same as a jump sees them.
    rules : list of list of Transition
        Of each machine.
    jumping : frozenset of int
        Stored quantities that some mode may set.
    start : Start
    careful : bool
        Whether the text counts event iterations, since one has to wait for another.
    quiet, settled : int
        Iterations without a change after which rules turn, and after which all is settled.
    used : dict
        The parameters that are read, ``p:...``, in order.
    declared, equations : list of str
        The text so far.
    made : dict of str to str
        What has been declared, to its name.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.graph: FlatGraph = model.flatten()
        refuse(self.graph)
        self.ids = Identifiers()
        self.form = Form(self.graph)
        seen = without_impulses(self.graph)
        self.sudden = self.form if seen is self.graph else Form(seen, self.form.eq.reference)
        self.used: dict[str, None] = {f"p:{p}": None for p in self.graph.parameters}
        self.declared: list[str] = []
        self.equations: list[str] = []
        self.made: dict[str, str] = {}
        self._reserve()
        self.live = Live(model, self.graph)
        self.rules = [transitions(self.graph, m, self.live) for m in self.graph.machines]
        self.jumping = jumping_of(self.graph, self.sudden)
        for storage in sorted(self.jumping):
            self.new(storage)
        self.start = settled_start(self.graph)
        laws = any(m.law is not None for m in self.graph.machines)
        self.careful = bool(self.jumping) or laws or self._reads_pre()
        self.quiet = 1 + (PATIENCE if laws else 0)
        self.settled = self.quiet + PATIENCE

    def _reserve(self) -> None:
        """Give the names that people wrote to what they wrote them for."""
        graph = self.graph
        self.name = self.ids.of("model", graph.name)
        for path in graph.parameters:
            self.ids.of(f"p:{path}", path)
        for i in graph.inputs:
            self.ids.of(f"u:{i.index}", i.path)
        for s in graph.integrals:
            self.ids.of(f"s:{s.index}", s.path)
        for m in graph.machines:
            self.ids.of(f"m:{m.index}", m.path)
        for storage in graph.storages:
            self.ids.of(f"x:{storage.index}", storage.path)
        for path in graph.signals:
            self.ids.of(f"signal:{path}", path)
        for m in graph.machines:
            for k, state in enumerate(m.states):
                self.ids.of(f"in:{m.index}:{k}", f"{m.path}_{state}")

    def _reads_pre(self) -> bool:
        graph = self.graph
        expressions = [t.guard for rules in self.rules for t in rules]
        expressions += [i.rate for i in graph.integrals] + list(graph.signals.values())
        expressions += [e for n in graph.nodes if n.law for e in n.law.expressions]
        return any(uses_pre(e) for e in expressions)

    # -- names

    def stored(self, k: int) -> str:
        """Return the name of a stored quantity."""
        return self.ids.of(f"x:{k}", "")

    def new(self, k: int) -> str:
        """Return the name of a stored quantity in the mode that is tried."""
        return self.ids.of(f"new:x:{k}", f"{self.stored(k)}_new")

    def jump(self, k: int) -> str:
        """Return the name of what the mode that is tried adds to a stored quantity."""
        return self.ids.of(f"jump:{k}", f"{self.stored(k)}_jump")

    def integral(self, k: int) -> str:
        """Return the name of an integrated signal."""
        return self.ids.of(f"s:{k}", "")

    def machine(self, m: int) -> str:
        """Return the name of the state of a machine."""
        return self.ids.of(f"m:{m}", "")

    @property
    def calm(self) -> str:
        """The name of the number of event iterations since something changed."""
        return self.ids.of("calm", "calm")

    @property
    def small(self) -> str:
        """The name of what counts as no impulse."""
        return self.ids.of("small", "impulse_small")

    @property
    def slack(self) -> str:
        """The name of the part of its terms below which a law takes a value for zero."""
        return self.ids.of("slack", "law_slack")
