"""Laws of one variable, bent in the ways that models bend them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

STORED = ("linear", "cubic", "sinh", "bent")
"""Curves of storages: they rise, and beyond any limit."""
RESISTIVE = (
    *("linear", "linear", "tanh", "table", "clipped", "one-sided", "sign", "root", "quadratic"),
    *("cubic", "knee"),
)
"""Curves of resistors: none falls, so none makes energy."""

_TEXT = {
    "linear": "{a}*({x}/{b})",
    "cubic": "{a}*(({x}/{b}) + ({x}/{b})^3)",
    "sinh": "{a}*sinh({x}/{b})",
    "tanh": "{a}*tanh({x}/{b})",
    "clipped": "{a}*max(-1, min(1, {x}/{b}))",
    "one-sided": "if {x} > 0 then {a}*({x}/{b}) else 0",
    "sign": "{a}*sign({x})",
    "root": "{a}*sign({x})*sqrt(abs({x})/{b})",
    "quadratic": "{a}*({x}/{b})*abs({x}/{b})",
    "knee": "if {x} > {b} then {a}*(1 + 3*({x}/{b} - 1)) else {a}*({x}/{b})",
}
_POINTS = {
    "table": ((-2.0, -1.0, 0.0, 1.0, 3.0), (-1.0, -1.0, 0.0, 1.0, 1.0)),
    "bent": ((-2.0, -1.0, 0.0, 1.0, 3.0), (-3.0, -1.0, 0.0, 1.0, 1.5)),
}


@dataclass(frozen=True)
class Curve:
    """A law of one variable: `height` times a function of the argument over `width`.

    Parameters
    ----------
    kind : str
        One of `STORED` or `RESISTIVE`.
    height, width : float
        In SI, positive.
    mirrored : bool
        Whether output and argument are both turned round.

    Examples
    --------
    >>> Curve("tanh", 2.0, 0.5).law("f")
    '2.0*tanh(f/0.5)'
    >>> Curve("tanh", 2.0, 0.5, mirrored=True).law("f")
    '-(2.0*tanh((-f)/0.5))'
    """

    kind: str
    height: float
    width: float
    mirrored: bool = False

    @property
    def is_linear(self) -> bool:
        """Whether it is a straight line."""
        return self.kind == "linear"

    def turned(self) -> Curve:
        """Return the law between the negatives of output and argument."""
        return replace(self, mirrored=not self.mirrored)

    def law(self, argument: str) -> str | dict[str, Any]:
        """Return it as the text or the table of a model's law."""
        if self.kind in _POINTS:
            arguments, values = _POINTS[self.kind]
            pairs = [
                (self.width * x, self.height * y) for x, y in zip(arguments, values, strict=True)
            ]
            if self.mirrored:
                pairs = [(-x, -y) for x, y in reversed(pairs)]
            return {
                "table": [[x for x, _ in pairs], [y for _, y in pairs]],
                "extrapolate": "linear",
            }
        x = f"(-{argument})" if self.mirrored else argument
        text = _TEXT[self.kind].format(a=repr(self.height), b=repr(self.width), x=x)
        return f"-({text})" if self.mirrored else text
