"""Names of domains, and what words mean that are none."""

from __future__ import annotations

from hybond.errors import ModelError
from hybond.names import did_you_mean
from hybond.units import DOMAINS

_MEANT = {
    **dict.fromkeys(
        ("mechanical", "mechanics", "mechanic", "mech", "kinetic"),
        "'translational' (force, velocity) or 'rotational' (torque, angular velocity)",
    ),
    **dict.fromkeys(("translation", "linear"), "'translational'"),
    **dict.fromkeys(("rotation", "rotary", "angular"), "'rotational'"),
    **dict.fromkeys(("electric", "electronic", "electronics", "circuit"), "'electrical'"),
    **dict.fromkeys(("fluid", "fluidic", "hydraulics", "pneumatic"), "'hydraulic'"),
    **dict.fromkeys(
        ("heat", "temperature"),
        "'thermal' (entropy flow) or 'thermal_pseudo' (heat flow)",
    ),
    **dict.fromkeys(("magnetics", "magnet"), "'magnetic'"),
    **dict.fromkeys(("none", "any", "abstract", ""), "'generic'"),
}
"""What words mean that are no names of domains."""


def no_such_domain(name: object, where: str) -> ModelError:
    """Return the refusal of a domain that is none: HB-M133.

    Examples
    --------
    >>> print(no_such_domain("Electrical", "domain"))
    HB-M133 at domain: there is no domain 'Electrical'
      try: did you mean 'electrical'?
    """
    near = [d for d in DOMAINS if d.lower() == str(name).lower()]
    meant = None if near else _MEANT.get(str(name).lower())
    if near:
        hint = f"did you mean {near[0]!r}?"
    else:
        hint = f"did you mean {meant}?" if meant else did_you_mean(str(name), DOMAINS)
    return ModelError(f"there is no domain {name!r}", code="HB-M133", where=where, hint=hint)
