"""The Modelica model itself: what is declared, and the equations."""

from __future__ import annotations

from hybond.export.modelica.model import ModelText
from hybond.model.builder import Model


def to_modelica(model: Model) -> str:
    """Return a model as the text of one flat hybrid Modelica model.

    Stored quantities and integrated signals are its states, machines its Integers. Rules are
    equations of levels, settled by event iteration as hybond settles them; what a mode does to
    the state on entry is a formula, and `reinit` writes it when nothing fires any more. Nothing is
    needed beyond the language, 3.2 or later.

    Parameters
    ----------
    model : Model

    Raises
    ------
    ModelError
        HB-E680 for what Modelica has no words for, HB-E681 for what it would get wrong,
        HB-E683 for operations on impulses without meaning, HB-E684 for too many combinations.
    EquationError
        HB-E682 for a mode that fixes what is stored by a nonlinear law.

    Examples
    --------
    >>> from hybond.model.parts import C, I, One
    >>> m = Model("oscillator", domain="translational", parameters={"k": "100 N/m"})
    >>> m.add(mass=I("1 kg", f="1 m/s"), spring=C("1/k"), v=One())
    >>> m.bond("v -> mass", "v -> spring")
    >>> print(to_modelica(m), end="")
    model oscillator
      parameter Real k(unit = "N/m") = 100;
      parameter Real mass_I(unit = "kg") = 1;
      Real mass_p(start = 1, fixed = true, unit = "N.s") "mass.p";
      Real spring_q(start = 0, fixed = true, unit = "m") "spring.q";
    equation
      der(mass_p) = -k*spring_q;
      der(spring_q) = mass_p/mass_I;
    end oscillator;
    """
    return ModelText(model).text()
