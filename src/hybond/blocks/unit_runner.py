"""Running a functional mock-up unit: this loads and runs the machine code in it.

FMPy (extra ``fmu``) does the talking. The block is one for co-simulation: at each of its instants
it has stepped from the last instant with the inputs of that one, its outputs are read, and then
its new inputs are set.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from typing import Any

from hybond.blocks.description import Description, Variable
from hybond.errors import NumericsError, UsageError

_REALS = ("Real", "Float64")


class UnitRunner:
    """One instance of an FMU.

    Parameters
    ----------
    description : Description
    inputs, outputs : sequence of str
        Names of variables, in the order in which `step` takes and gives values, in SI.
    parameters : mapping
        Values of parameters, in SI.
    name : str
        What the block is called in the model.
    """

    def __init__(
        self,
        description: Description,
        inputs: Sequence[str],
        outputs: Sequence[str],
        parameters: Mapping[str, float],
        name: str,
    ) -> None:
        self._inputs = [description.variables[k] for k in inputs]
        self._outputs = [description.variables[k] for k in outputs]
        self._name = name
        self._t: float | None = None
        self._parameters = {description.variables[k]: v for k, v in parameters.items()}
        self._three = description.version == "3.0"
        self._folder = ""
        self._unit: Any = None
        self._description = description

    def step(self, t: float, values: Sequence[float]) -> list[float]:
        """Go on to `t`, take the inputs of that instant, and return the outputs.

        Raises
        ------
        UsageError
            HB-S118 if FMPy is not installed.
        NumericsError
            HB-N306 if the FMU reports an error.
        """
        try:
            if self._unit is None:
                self._begin(t, values)
            elif self._t is not None:
                self._unit.doStep(
                    currentCommunicationPoint=self._t, communicationStepSize=t - self._t
                )
            found = [self._get(v) for v in self._outputs]
            for variable, value in zip(self._inputs, values, strict=True):
                self._set(variable, _in_its_unit(variable, value))
        except UsageError:
            raise
        except Exception as error:  # whatever foreign code and its loader may raise
            raise NumericsError(
                f"the FMU {self._description.name!r} stopped at t = {t:.9g} s: {error}",
                code="HB-N306",
                where=f"blocks.{self._name}",
                hint="run the FMU alone, for instance with fmpy, with the same inputs",
            ) from error
        self._t = t
        return found

    def close(self) -> None:
        """Let the FMU go."""
        if self._unit is not None:
            try:
                self._unit.terminate()
                self._unit.freeInstance()
            finally:
                self._unit = None
        if self._folder:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder = ""

    def _begin(self, t: float, values: Sequence[float]) -> None:
        try:
            import fmpy
            from fmpy.fmi2 import FMU2Slave
            from fmpy.fmi3 import FMU3Slave
        except ImportError:
            raise UsageError(
                "running an FMU needs FMPy, which is not installed",
                code="HB-S118",
                where=f"blocks.{self._name}",
                hint="pip install 'hybond[fmu]'",
            ) from None
        d = self._description
        self._folder = str(fmpy.extract(str(d.path)))
        make = FMU3Slave if self._three else FMU2Slave
        unit = make(
            guid=d.token,
            unzipDirectory=self._folder,
            modelIdentifier=d.identifier,
            instanceName=self._name,
        )
        unit.instantiate()
        self._unit = unit
        if not self._three:
            unit.setupExperiment(startTime=t)
        for variable, value in self._parameters.items():
            self._set(variable, _in_its_unit(variable, value))
        for variable, value in zip(self._inputs, values, strict=True):
            self._set(variable, _in_its_unit(variable, value))
        if self._three:
            unit.enterInitializationMode(startTime=t)
        else:
            unit.enterInitializationMode()
        unit.exitInitializationMode()

    def _set(self, variable: Variable, value: float) -> None:
        exact = float(value) if variable.kind in (*_REALS, "Float32") else round(value)
        getattr(self._unit, f"set{variable.kind}")([variable.reference], [exact])

    def _get(self, variable: Variable) -> float:
        (value,) = getattr(self._unit, f"get{variable.kind}")([variable.reference])
        unit = variable.unit
        return float(value) if unit is None else unit.factor * float(value) + unit.offset


def _in_its_unit(variable: Variable, value: float) -> float:
    unit = variable.unit
    return value if unit is None else (value - unit.offset) / unit.factor
