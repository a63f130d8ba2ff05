"""The engine that tests of this folder run: the library, or Python where there is none."""

from __future__ import annotations

from hybond.engine.compiled.native import NativeModel, NativeRun, Unavailable, library
from hybond.engine.compiled.native_look import NativeLook
from hybond.engine.interpreted.look import PythonLook
from hybond.engine.interpreted.run import PythonModel, PythonRun

try:
    library()
    ABSENT = ""
except Unavailable as why:
    ABSENT = str(why)

ENGINE = "python" if ABSENT else "library"
EngineModel = PythonModel if ABSENT else NativeModel
EngineRun = PythonRun if ABSENT else NativeRun
EngineLook = PythonLook if ABSENT else NativeLook
