"""A part of control alone in a model, and the instants at which something happened."""

import hybond as hb


def alone(name: str, until: float, *, rtol: float = 1e-9, **given: object) -> hb.Result:
    """Run a part by itself; keywords are its inputs if it has them, else its parameters."""
    part = hb.library.part(name)
    inputs = {k: v for k, v in given.items() if k in part.inputs}
    values = {k: v for k, v in given.items() if k in part.parameters}
    assert {*inputs, *values} == set(given)
    m = hb.Model("alone")
    m.add(p=hb.Submodel(name, inputs=inputs, **values))
    return hb.simulate(m, until=until, rtol=rtol, atol=1e-12)


def guards(run: hb.Result) -> list[float]:
    return [e.t for e in run.events if e.cause != "start"]
