"""A model as a functional mock-up unit: the exported C with the functions of the standard.

One archive holds the model description, the C source, and a library compiled for the machine that
hybond runs on. It is for co-simulation, with the model's own solver and event handling inside, and
for model exchange, with those of the importer.
"""

from __future__ import annotations

import io
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from hybond.engine.compiled.compiler import compiler
from hybond.errors import UsageError
from hybond.export.c import c_file
from hybond.export.fmu.describing import describe
from hybond.export.fmu.interface import Interface, Shown, free_inputs, interface_of
from hybond.export.program import DRIVEN, Exported, exported
from hybond.model.builder import Model
from hybond.model.graph import FlatGraph
from hybond.model.inputs import Constant, Free
from hybond.translate.reserved import permitted

HOME = Path(__file__).parent
VERSIONS = ("2.0", "3.0")
_PLATFORM = {"win32": "win64", "darwin": "darwin64"}.get(sys.platform, "linux64")
_PLACES = {
    "2.0": _PLATFORM,
    "3.0": {"win64": "x86_64-windows", "darwin64": "x86_64-darwin"}.get(_PLATFORM, "x86_64-linux"),
}
_SUFFIX = {"win64": ".dll", "darwin64": ".dylib"}.get(_PLATFORM, ".so")
_WHEN = (2000, 1, 1, 0, 0, 0)  # the same model gives the same bytes


def to_fmu(model: Model, *, fmi: str = "3.0", **options: object) -> bytes:
    """Return a model as a functional mock-up unit for co-simulation and model exchange.

    Inputs that are constants become inputs of the unit; its outputs are those of the experiment.

    Parameters
    ----------
    fmi : {"3.0", "2.0"}
        The version of the standard.
    **options
        Of the run: ``until``, ``solver``, ``rtol``, ``atol``, ``step``, ``max_step``, ``impact``.

    Raises
    ------
    UsageError
        HB-E604 for another version, HB-E605 without a C compiler.
    ModelError
        What the exported runtime does not have.
    """
    own, source = functional_unit(model, fmi=fmi, **options)
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as files:

        def add(name: str, data: str | bytes) -> None:
            entry = zipfile.ZipInfo(name, _WHEN)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            files.writestr(entry, data)

        add("modelDescription.xml", describe(own, fmi))
        add(f"sources/{own.identifier}.c", source)
        library = _compiled(source, own.identifier)
        add(f"binaries/{_PLACES[fmi]}/{own.identifier}{_SUFFIX}", library)
    return archive.getvalue()


def functional_unit(model: Model, *, fmi: str, **options: object) -> tuple[Interface, str]:
    """Return what the unit of a model shows, and its C; raises as `to_fmu` does."""
    if fmi not in VERSIONS:
        raise UsageError(
            f"FMI {fmi} is not written", code="HB-E604", where="fmi", hint="fmi = '3.0' or '2.0'"
        )
    found = exported(model, roots=DRIVEN, options=options, prepared=_freed)
    tables = found.tables
    rules = tables.ints["rule_first"][-1]
    own = interface_of(
        model.flatten(),
        outputs=tables.outputs,
        parameters=[
            Shown(s.path, s.dimension, s.start, s.text, s.made_of is not None)
            for s in found.parameters.settable
        ],
        text=repr((tables.numbers, tables.ints, tables.floats, tables.values.text, fmi)),
        indicators=tables.ints["atom_first"][rules] + int(tables.numbers["jumping_gaps"]),
        until=float(tables.numbers["until"]),
        rtol=float(tables.numbers["rtol"]),
    )
    return own, unit_source(model, found, own, fmi)


def unit_source(model: Model, found: Exported, own: Interface, fmi: str) -> str:
    """Return the C of a unit."""
    inputs = free_inputs(model.flatten())
    first = {
        f"FIRST_{group.upper()[:-1]}": own.first(group)
        for group in ("inputs", "outputs", "states", "derivatives")
    }
    first["FIRST_INDICATOR"] = own.first("derivatives") + len(own.states)
    first["BEYOND_LAST"] = first["FIRST_INDICATOR"] + own.indicators
    numbers = ", ".join(map(str, inputs)) or "0"
    levels = ", ".join(repr(v.start) for v in own.inputs) or "0.0"
    lines = [
        "/* What the unit shows: where its variables begin, and its inputs. */",
        f'#define TOKEN "{own.token}"',
        f"#define PARAMETERS {len(own.parameters)}",
        "enum {",
        *(f"    {name} = {k}," for name, k in first.items()),
        f"    INPUTS = {len(inputs)}",
        "};",
        f"static const int INPUT_NUMBER[] = {{{numbers}}};",
        f"static const double INPUT_START[] = {{{levels}}};",
        "",
        *_parameters(found, own, inputs),
        _text("common.c"),
        _text(f"fmi{fmi[0]}.c").replace("@ALIKE@\n", _text("alike.c")),
    ]
    return c_file(model, found, "\n".join(lines))


def _text(name: str) -> str:
    return (HOME / name).read_text(encoding="utf-8")


def _parameters(found: Exported, own: Interface, inputs: Sequence[int]) -> list[str]:
    """Return what is known of parameters, and what finds the inputs that follow from them."""
    if not own.parameters:
        return []
    follows = ", ".join("true" if v.follows else "false" for v in own.parameters)
    first = found.tables.ints["input_first"]
    place = {first[number]: k for k, number in enumerate(inputs)}
    puts = [
        f"    level[{place[x.index]}] = m->{permitted(x.table)}[{x.index}];"
        for x in found.parameters.entries
        if x.table == "input_number" and x.index in place
    ]
    return [
        f"static const bool PARAMETER_FOLLOWS[] = {{{follows}}};",
        "",
        "/* Put the levels there at which inputs begin that follow from parameters. */",
        "static void put_inputs(const Model *m, double *level)",
        "{",
        *(puts or ["    (void)m, (void)level;"]),
        "}",
        "",
    ]


def _freed(graph: FlatGraph) -> FlatGraph:
    """Return the graph with inputs that are constants set from outside."""
    inputs = tuple(
        replace(i, waveform=Free(i.waveform.level)) if isinstance(i.waveform, Constant) else i
        for i in graph.inputs
    )
    return replace(graph, inputs=inputs)


def _compiled(source: str, name: str) -> bytes:
    command = compiler()
    if command is None:
        raise UsageError(
            "a functional mock-up unit holds a compiled library, and there is no C compiler",
            code="HB-E605",
            where="fmu",
            hint="install one (CC names it; pip install ziglang will do), or export to C",
        )
    with tempfile.TemporaryDirectory() as folder:
        text = Path(folder, f"{name}.c")
        text.write_text(source, encoding="utf-8")
        target = text.with_suffix(_SUFFIX)
        flags = ["-std=c99", "-O1", "-ffp-contract=off", "-shared", "-fvisibility=hidden"]
        flags += [] if sys.platform == "win32" else ["-fPIC"]
        libraries = [] if sys.platform == "win32" else ["-lm"]
        done = subprocess.run(
            [*command, *flags, "-o", str(target), str(text), *libraries],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=300,
            check=False,
        )
        if done.returncode:
            raise UsageError(
                f"the C compiler refuses the unit: {done.stderr.strip()[-500:]}",
                code="HB-E605",
                where="fmu",
                hint="try another compiler: CC names it",
            )
        return target.read_bytes()
