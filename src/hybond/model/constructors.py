"""What a modeller writes in Python: `C`, `I`, `R`, `G`, `Se`, `Sf`, `TF`, `GY`, `Zero`, `One`.

They return the same records that a model file is read into. What a value may be is the same for
all of them: a number in SI (``0.001``), a quantity (``"1 mF"``), an expression of parameters
(``"2*k"``), and for some a law in full (``{"e": "k*q^3"}``) or the matrix of a field.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from functools import wraps
from typing import Any, Literal, ParamSpec, TypeAlias

from hybond.calls import called
from hybond.errors import ModelError
from hybond.model.kinds import law_hint
from hybond.model.parts import Part

Scalar: TypeAlias = float | str
"""A number in SI, a quantity or an expression as text."""
LawValue: TypeAlias = Scalar | Sequence[Sequence[Scalar]] | Mapping[str, Any]
"""A coefficient, the matrix of a field, or a law in full."""
Start: TypeAlias = Scalar | Sequence[Scalar]
"""Where a storage starts, of a field a value per port."""
Domain: TypeAlias = Literal[
    "electrical",
    "translational",
    "rotational",
    "hydraulic",
    "thermal",
    "thermal_pseudo",
    "magnetic",
    "generic",
    "generic_pseudo",
]
LawName: TypeAlias = Literal["diode", "thyristor", "unilateral", "coulomb", "relay"]


STARTS = ("q", "e", "p", "f")
LAW_OPTIONS = ("law", "gate", "gap", "restitution", "stiffness", "limit", "breakaway", "pair")
P = ParamSpec("P")


def _part(kind: str, value: Any, **options: Any) -> Part:
    return Part(kind, value, {k: v for k, v in options.items() if v is not None})


def _element(
    example: str, *, starts: tuple[str, ...] = ()
) -> Callable[[Callable[P, Part]], Callable[P, Part]]:
    """Return a decorator that refuses what an element does not have: HB-M164, M165, M201."""
    fits = called(example, code="HB-M164", kind=ModelError)

    def decorate(function: Callable[P, Part]) -> Callable[P, Part]:
        checked = fits(function)
        kind = function.__name__
        own = frozenset(inspect.signature(function).parameters)

        @wraps(function)
        def call(*args: P.args, **options: P.kwargs) -> Part:
            for name in options.keys() - own:
                if name in STARTS and starts:
                    raise ModelError(
                        f"the start of a {kind} is {' or '.join(starts)}; given: {name}",
                        code="HB-M165",
                        where=kind,
                        hint=f'{starts[0]} = "..."',
                    )
                if name in LAW_OPTIONS:
                    raise ModelError(
                        f"a {kind} has no {name}",
                        code="HB-M201",
                        where=kind,
                        hint=law_hint(kind, 'hb.{kind}({{"{of}": "..."}})'),
                    )
            return checked(*args, **options)

        return call

    return decorate


@_element('hb.C("1 mF", e="10 V") or hb.C({"e": "k*q^3"}, q=1)', starts=("q", "e"))
def C(
    value: LawValue,
    *,
    q: Start | None = None,
    e: Start | None = None,
    domain: Domain | None = None,
    label: str | None = None,
) -> Part:
    """Return a C: a capacitor, a spring, a tank; it stores a displacement q, the integral of flow.

    Parameters
    ----------
    value : number, str, mapping or matrix
        The compliance, q = C e; a law ``{"e": "k*q^3"}`` or ``{"e": {"table": [...]}}``; or the
        matrix of a field, a row per port.
    q : number or str, optional
        Where it starts, of a field a list. Give `q` or `e`, not both. Default 0.
    e : number or str, optional
        The effort at which it starts.
    domain : str, optional
        Its domain, if it is not that of the model.
    label : str, optional
        What drawings write beside it instead of its value.

    Examples
    --------
    >>> C("1 mF", e="10 V").options
    {'e': '10 V'}
    """
    return _part("C", value, q=q, e=e, domain=domain, label=label)


@_element('hb.I("2 kg", f="1 m/s") or hb.I({"f": "k*p^3"}, p=1)', starts=("p", "f"))
def I(
    value: LawValue,
    *,
    p: Start | None = None,
    f: Start | None = None,
    domain: Domain | None = None,
    label: str | None = None,
) -> Part:
    """Return an I: a coil, a mass; it stores a momentum p, the integral of effort.

    Parameters
    ----------
    value : number, str, mapping or matrix
        The inertia, p = I f; a law ``{"f": "p/m0"}``; or the matrix of a field.
    p : number or str, optional
        Where it starts, of a field a list. Give `p` or `f`, not both. Default 0.
    f : number or str, optional
        The flow at which it starts.
    domain, label : str, optional
        As of `C`.

    Examples
    --------
    >>> I("m", f="2 m/s")
    Part(kind='I', value='m', options={'f': '2 m/s'})
    """
    return _part("I", value, p=p, f=f, domain=domain, label=label)


@_element('hb.R("10 ohm") or hb.R({"e": "r*f*abs(f)"})')
def R(
    value: LawValue,
    *,
    impulsive: bool | None = None,
    domain: Domain | None = None,
    label: str | None = None,
) -> Part:
    """Return an R: a resistor, a damper; effort = R times flow.

    Parameters
    ----------
    value : number, str, mapping or matrix
        The resistance; a law ``{"e": "r*f*abs(f)"}`` or ``{"f": ...}``; or the matrix of a field.
    impulsive : bool, optional
        Whether its law acts on impulses too.
    domain, label : str, optional
        As of `C`.

    Examples
    --------
    >>> R("10 ohm").value
    '10 ohm'
    """
    return _part("R", value, impulsive=impulsive, domain=domain, label=label)


@_element('hb.G("10 m/(N*s)") or hb.G({"f": "k*e^3"})')
def G(
    value: LawValue,
    *,
    impulsive: bool | None = None,
    domain: Domain | None = None,
    label: str | None = None,
) -> Part:
    """Return a G: a conductance, a mobility; flow = G times effort. It may be 0, as an R may not.

    Parameters
    ----------
    value, impulsive, domain, label
        As of `R`.

    Examples
    --------
    >>> G("0.1 S").kind
    'G'
    """
    return _part("G", value, impulsive=impulsive, domain=domain, label=label)


@_element('hb.Se("10 V")')
def Se(
    value: Scalar,
    *,
    impulsive: bool | None = None,
    domain: Domain | None = None,
    label: str | None = None,
) -> Part:
    """Return a source of effort: a voltage, a force, a pressure.

    Parameters
    ----------
    value : number or str
        The effort: it may read time, inputs and signals, ``"10 V*sin(314*time)"``.
    impulsive : bool, optional
        Whether an impulse of what it reads gives it one. By default it does if the value is a
        multiple of what it reads, by a factor of parameters, inputs and time: ``"2*node.e"``.
    domain, label : str, optional
        As of `C`.

    Examples
    --------
    >>> Se("10 V")
    Part(kind='Se', value='10 V', options={})
    """
    return _part("Se", value, impulsive=impulsive, domain=domain, label=label)


@_element('hb.Sf("1 A")')
def Sf(
    value: Scalar,
    *,
    impulsive: bool | None = None,
    domain: Domain | None = None,
    label: str | None = None,
) -> Part:
    """Return a source of flow: a current, a velocity, a volume flow.

    Parameters
    ----------
    value, impulsive, domain, label
        As of `Se`.

    Examples
    --------
    >>> Sf("2 A").kind
    'Sf'
    """
    return _part("Sf", value, impulsive=impulsive, domain=domain, label=label)


@_element('hb.TF("n")')
def TF(value: Scalar, *, domain: Domain | None = None, label: str | None = None) -> Part:
    """Return a transformer: e1 = n e2 and f2 = n f1, from the bond that enters to the other.

    Parameters
    ----------
    value : number or str
        The modulus n; it may read signals.
    domain, label : str, optional
        As of `C`.

    Examples
    --------
    >>> TF("10 rad/m").value
    '10 rad/m'
    """
    return _part("TF", value, domain=domain, label=label)


@_element('hb.GY("0.1 N*m/A")')
def GY(value: Scalar, *, domain: Domain | None = None, label: str | None = None) -> Part:
    """Return a gyrator: e1 = r f2 and e2 = r f1, as a motor between current and torque.

    Parameters
    ----------
    value : number or str
        The modulus r; it may read signals.
    domain, label : str, optional
        As of `C`.

    Examples
    --------
    >>> GY("0.1 N*m/A").kind
    'GY'
    """
    return _part("GY", value, domain=domain, label=label)


@_element('hb.Zero(law="diode")')
def Zero(
    *,
    law: LawName | None = None,
    gate: str | None = None,
    gap: str | None = None,
    restitution: Scalar | None = None,
    stiffness: Scalar | None = None,
    limit: Scalar | None = None,
    breakaway: Scalar | None = None,
    pair: str | None = None,
    impulsive: bool | None = None,
    domain: Domain | None = None,
) -> Part:
    """Return a 0-junction: its bonds have one effort, and their flows add up to zero.

    Parameters
    ----------
    law : {"diode", "thyristor", "unilateral", "coulomb", "relay"}, optional
        A law of the junction itself, with which it needs no machine.
    gate : str, optional
        Of a thyristor: the condition on which it begins to conduct.
    gap, restitution, stiffness : optional
        Of ``"unilateral"``: the distance that is closed at zero, Newton's coefficient, and the
        stiffness of the contact.
    limit, breakaway, pair, impulsive : optional
        Of ``"coulomb"`` and ``"relay"``: the largest friction, what breaks it loose, the junction
        that shares a disk of friction, and whether it acts on impulses.
    domain : str, optional
        As of `C`.

    Examples
    --------
    >>> Zero(law="unilateral", gap="height").options
    {'law': 'unilateral', 'gap': 'height'}
    """
    return _part(
        "0",
        None,
        law=law,
        gate=gate,
        gap=gap,
        restitution=restitution,
        stiffness=stiffness,
        limit=limit,
        breakaway=breakaway,
        pair=pair,
        impulsive=impulsive,
        domain=domain,
    )


@_element('hb.One(law="diode")')
def One(
    *,
    law: LawName | None = None,
    gate: str | None = None,
    gap: str | None = None,
    restitution: Scalar | None = None,
    stiffness: Scalar | None = None,
    limit: Scalar | None = None,
    breakaway: Scalar | None = None,
    pair: str | None = None,
    impulsive: bool | None = None,
    domain: Domain | None = None,
) -> Part:
    """Return a 1-junction: its bonds have one flow, and their efforts add up to zero.

    Parameters
    ----------
    law, gate, gap, restitution, stiffness, limit, breakaway, pair, impulsive, domain
        As of `Zero`.

    Examples
    --------
    >>> One()
    Part(kind='1', value=None, options={})
    """
    return _part(
        "1",
        None,
        law=law,
        gate=gate,
        gap=gap,
        restitution=restitution,
        stiffness=stiffness,
        limit=limit,
        breakaway=breakaway,
        pair=pair,
        impulsive=impulsive,
        domain=domain,
    )
