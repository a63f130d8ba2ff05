"""A model as one Java class."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from hybond._version import __version__
from hybond.errors import UsageError
from hybond.export.identifiers import identifier
from hybond.export.java_parameters import declared, putting, setting
from hybond.export.program import NAMES, SET, Exported, exported, maker_of, runtime
from hybond.export.story import story, title_of
from hybond.model.builder import Model
from hybond.translate.java_printer import JavaPrinter, ascii_only, java_number, java_text
from hybond.translate.java_words import IMPORTS, java_words
from hybond.translate.lines import block_comment, line_comments, plain, prose, wrapped
from hybond.translate.reserved import JAVA_WORDS, TYPES
from hybond.translate.tree import Member

CHUNK = 2000
"""Numbers of a table that one method may fill, and expressions that one may hold: a method of Java
has at most 64 KiB of code."""
CASES = 200


def to_java(model: Model, *, name: str = "", **options: object) -> str:
    """Return a model as one public Java class that needs nothing but the Java library.

    Parameters
    ----------
    name : str
        Of the class; by default made of the model's.
    **options
        Of the run: ``until``, ``solver``, ``rtol``, ``atol``, ``points``, ``step``, ``theta``,
        ``max_step``, ``impact``; those that are left out are the experiment's.

    Returns
    -------
    str
        To be saved as ``<class>.java``; ``java <class>.java`` prints the trajectory as a table.

    Raises
    ------
    ModelError, UsageError
        HB-E630 to HB-E632 for what the exported runtime does not have, HB-E606 for a name that no
        class can have.

    Examples
    --------
    >>> import hybond as hb
    >>> text = to_java(hb.load("examples/bouncing_ball.toml"))
    >>> print(next(line for line in text.splitlines() if "class" in line))
    public final class BouncingBall {
    """
    name = name or class_name(model.name or model.title or "model")
    _check_name(name)
    found = exported(model, language="java", options=options)
    graph = found.graph
    printer = JavaPrinter(
        found.runs.program, found.roots, effects=found.runs.effects, uses=found.runs.uses
    )
    maker = maker_of("java")
    printer.known, printer.opened = maker.texts, maker.specialist.opened
    printer.kept = SET
    printer.given = {
        **{f: _names(printer, found, f) for f in NAMES},
        "value": _values(printer, found),
        "evaluate_pair": _pairs(printer, found),
    }
    head = [plain(title_of(graph)), "", *_how_to(name), "", *story(model, graph)]
    lines = [f"import {i};" for i in IMPORTS]
    lines += ["", *(ascii_only(line) for line in _commented(head))]
    lines += [f"public final class {name} {{"]
    inside = _api(found)
    inside += [
        "",
        "// Where the values stand that the expressions of the model read.",
        *_slots(found),
        *declared(found.parameters),
    ]
    for points, numbers in found.points.items():
        listed = [java_number(x) for x in numbers]
        if points in found.parameters.tables:
            inside += ["", *_array(f"{points}_START", "double", listed)]
            inside.append(f"private static double[] {points} = {points}_START.clone();")
        else:
            inside += ["", *_array(points, "double", listed)]
    inside += java_words(printer.reached.words)
    for module in found.runs.program.modules:
        if printer.needed(module):
            inside += ["", *line_comments((f"Chapter: {module.name}.",), 0)]
            inside += line_comments(tuple(prose(module.doc)), 0)
            inside += printer.chapter(module)
            if module.name == "model":
                inside += ["", *_model(printer, found)]
    members = {m.name for m in printer.members(found.runs.program.records["Model"])}
    put = putting(printer, found.parameters, members)
    inside += ["", "// What follows from the parameters.", *put] if put else []
    known = setting(found.parameters)
    inside += ["", *known] if known else []
    lines += [ascii_only(f"    {line}".rstrip()) for line in inside]
    maker.keep()
    return "\n".join([*lines, "}"]) + "\n"


def class_name(text: str) -> str:
    """Return the name of a class.

    Examples
    --------
    >>> class_name("bouncing_ball"), class_name("RC 2"), class_name("engine")
    ('BouncingBall', 'RC2', 'EngineModel')
    """
    parts = identifier(text).split("_")
    found = "".join(p[:1].upper() + p[1:] for p in parts if p)
    return f"{found}Model" if found in TYPES or found in runtime().records else found


def _api(found: Exported) -> list[str]:
    """Return main, and what other classes call."""
    own = found.parameters
    text = API.replace("@TITLE@", java_text(title_of(found.graph))[1:-1])
    options = own.settable or own.fixed
    text = text.replace("@SET@", " [--set NAME=VALUE]" if options else "")
    text = text.replace("@SAID@", SET_USAGE if options else "")
    points = (f"    {x} = {x}_START.clone();\n" for x in sorted({x.table for x in own.points}))
    text = text.replace("@BEGUN@", SET_BEGUN + "".join(points) if own.settable else "")
    text = text.replace("@OPTION@", SET_OPTION if options else "")
    text = text.replace("@HELP@", SET_HELP if options else "")
    text = text.replace("@TAKEN@", SET_TAKEN if own.settable else "")
    return text.rstrip("\n").split("\n")


def _check_name(name: str) -> None:
    plain = re.fullmatch(r"[A-Za-z_$][A-Za-z0-9_$]*", name)
    if plain and name not in JAVA_WORDS | TYPES and name not in runtime().records:
        return
    raise UsageError(
        f"no Java class can be called {name!r}",
        code="HB-E606",
        where="name",
        hint=f"the file is called as its class: {class_name(name)}.java",
    )


def _how_to(name: str) -> list[str]:
    return [
        f"Exported by hybond {__version__}. Run with",
        "",
        f"    java {name}.java > table.csv",
        "",
        f"java {name}.java --events prints the events instead, --help says the options.",
        f'From Java: {name}.run(out, "--events").',
    ]


def _commented(lines: list[str]) -> list[str]:
    # a backslash and a u would be read as a letter, in comments too
    return block_comment([line.replace("\\u", "\\ u") for line in lines], opener="/**")


def _slots(found: Exported) -> Iterator[str]:
    for name, k, said in found.slots:
        yield f"private static final int {name} = {k}; // {plain(said)}"
    size = found.tables.slots.size
    yield f"private static final int PRE = {size}; // where the a priori values begin"


def _names(printer: JavaPrinter, found: Exported, function: str) -> list[str]:
    if function not in printer.reached.functions:
        return []
    f = found.runs.program.functions[function]
    texts: Sequence[str] = getattr(found.tables, NAMES[function])
    return [
        *_array(f"{function.upper()}S", "String", [java_text(t) for t in texts]),
        "",
        *printer.documented(f.doc, f.above, opener="/**"),
        f"{printer.signature(f)} {{",
        f"    return {function.upper()}S[k];",
        "}",
    ]


def _array(name: str, kind: str, texts: list[str]) -> list[str]:
    """Return a constant array; a long one is filled by methods."""
    if len(texts) <= CHUNK:
        listed = ", ".join(texts)
        return wrapped(f"private static final {kind}[] {name} = {{{listed}}};", 0)
    lower = name.lower()
    lines = [f"private static final {kind}[] {name} = new {kind}[{len(texts)}];", "static {"]
    starts = range(0, len(texts), CHUNK)
    lines += [f"    fill_{lower}_{k}();" for k in range(len(starts))]
    lines.append("}")
    for k, at in enumerate(starts):
        part = texts[at : at + CHUNK]
        lines += ["", f"private static void fill_{lower}_{k}() {{"]
        lines += wrapped(f"{kind}[] part = {{{', '.join(part)}}};", 4)
        lines += [f"    System.arraycopy(part, 0, {name}, {at}, {len(part)});", "}"]
    return lines


def _values(printer: JavaPrinter, found: Exported) -> list[str]:
    f = found.runs.program.functions["value"]
    cases = []
    for case in found.values:
        lines = [f"    case {case.number}: // {plain(case.text)}"[:95]]
        lines += wrapped(f"return {printer.said(case.value)};", 8)
        cases.append(lines)
    head = printer.documented(f.doc, f.above, opener="/**")
    return [*head, *_switch(f.name, "double", "Model m, int k, double[] v", "m, k, v", cases)]


def _pairs(printer: JavaPrinter, found: Exported) -> list[str]:
    f = found.runs.program.functions["evaluate_pair"]
    cases = []
    for case in found.pairs:
        lines = [f"    case {case.number}: // {plain(case.text)}"[:95]]
        cases.append([*lines, *printer.block(case.code, 8), "        break;"])
    head = printer.documented(f.doc, f.above, opener="/**")
    return [*head, *_switch(f.name, "void", "Model m, int k, Stack s", "m, k, s", cases)]


def _switch(
    name: str, kind: str, parameters: str, arguments: str, cases: list[list[str]]
) -> list[str]:
    """Return a method that chooses one of many cases; it calls others if there are very many."""
    other = "return Double.NaN;" if kind == "double" else "break;"
    lines: list[str] = []
    parts = [cases[k : k + CASES] for k in range(0, len(cases), CASES)] or [[]]
    if len(parts) > 1:
        answer = "return " if kind == "double" else ""
        lines += [f"private static {kind} {name}({parameters}) {{", f"    switch (k / {CASES}) {{"]
        for k in range(len(parts)):
            lines += [f"    case {k}:", f"        {answer}{name}_{k}({arguments});"]
            lines += [] if answer else ["        break;"]
        lines += ["    default:", f"        {other}", "    }", "}", ""]
    for k, part in enumerate(parts):
        own = f"{name}_{k}" if len(parts) > 1 else name
        lines += [f"private static {kind} {own}({parameters}) {{", "    switch (k) {"]
        lines += [line for case in part for line in case]
        lines += ["    default:", f"        {other}", "    }", "}", ""]
    return lines[:-1]


def _model(printer: JavaPrinter, found: Exported) -> list[str]:
    """Return the tables of the model: a class, and the one of it."""
    record = found.runs.program.records["Model"]
    members = printer.members(record)
    lines: list[str] = []
    for m in members:
        if m.type.is_array:
            lines += _array(f"MODEL_{m.name.upper()}", *_numbers(found, m))
    lines += [
        "",
        *printer.record(record),
        "",
        "/** Return the model, whose options may be changed. */",
    ]
    lines += ["private static Model model() {", "    Model m = new Model();"]
    t, written = found.tables, found.parameters.tables
    for m in members:
        match m.type.kind:
            case "int":
                lines.append(f"    m.{m.name} = {int(t.numbers[m.name])};")
            case "float":
                lines.append(f"    m.{m.name} = {java_number(float(t.numbers[m.name]))};")
            case _:
                own = ".clone()" if m.name in written else ""
                lines.append(f"    m.{m.name} = MODEL_{m.name.upper()}{own};")
    return [*lines, "    return m;", "}"]


def _numbers(found: Exported, m: Member) -> tuple[str, list[str]]:
    if m.type.kind == "Ints":
        return "int", [str(i) for i in found.tables.ints[m.name]]
    return "double", [java_number(x) for x in found.tables.floats[m.name]]


SET_USAGE = """\
        + "  --set NAME=VALUE gives a parameter another value, in SI; there may be several\\n"
"""
SET_BEGUN = """\
    parameter = PARAMETER_START.clone();
    parameterSet = new boolean[PARAMETERS.length];
"""
SET_OPTION = """\
        if (words[k].equals("--set") && k + 1 < words.length) {
            k++;
            if (!setParameter(words[k])) {
                return 1;
            }
            continue;
        }
"""
SET_HELP = """\
            listParameters(out);
"""
SET_TAKEN = """\
    boolean any = false;
    for (boolean set : parameterSet) {
        any = any || set;
    }
    if (any) {
        putParameters(m);
        String broken = brokenCondition();
        if (broken != null) {
            System.err.println("the model is made of other parts where not " + broken
                    + ": export it again with these values");
            return 1;
        }
    }
"""
API = """\
private static PrintStream out = System.out;
private static final String USAGE = "@TITLE@\\n"
        + "usage: [--events] [--until T] [--points N] [--rtol X] [--atol X]@SET@\\n"
        + "  prints a table of the outputs, comma separated, two rows at an event;\\n"
        + "  with --events the transitions and the final state instead\\n"
@SAID@        + "exit codes: 0 fine, 1 usage, 3 the numerics\\n";

/** Run the model as the options say, and exit. */
public static void main(String[] words) throws java.io.UnsupportedEncodingException {
    PrintStream sheet = new PrintStream(new BufferedOutputStream(System.out), false, "UTF-8");
    int code = run(sheet, words);
    sheet.flush();
    System.exit(code);
}

/** Run the model, and print what the options say; return 0, 1 (usage) or 3 (the numerics). */
public static synchronized int run(PrintStream sheet, String... words) {
    out = sheet;
    Model m = model();
@BEGUN@    boolean events = false;
    for (int k = 0; k < words.length; k++) {
        if (words[k].equals("--events")) {
            events = true;
            continue;
        }
@OPTION@        if (words[k].equals("--help")) {
            out.print(USAGE);
@HELP@            return 0;
        }
        double x = 0.0;
        try {
            x = k + 1 < words.length ? Double.parseDouble(words[k + 1]) : 0.0;
        } catch (NumberFormatException wrong) {
            x = 0.0;
        }
        switch (words[k]) {
        case "--until":
            m.until = x;
            break;
        case "--points":
            m.points = (int) x;
            break;
        case "--rtol":
            m.rtol = x;
            break;
        case "--atol":
            m.atol = x;
            break;
        default:
            System.err.print(USAGE);
            return 1;
        }
        if (!(x > 0.0)) {
            System.err.println(words[k] + ": a positive number is wanted behind it");
            return 1;
        }
        k++;
    }
@TAKEN@    Engine e = make_engine(m);
    Report report = make_report(e);
    report.events = events;
    return run_program(e, report);
}
"""
