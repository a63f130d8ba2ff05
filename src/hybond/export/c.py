"""A model as one file of C99."""

from __future__ import annotations

from collections.abc import Sequence

from hybond._version import __version__
from hybond.export.c_parameters import held, places, putting, setting
from hybond.export.program import NAMES, SET, Exported, exported, maker_of
from hybond.export.story import story, title_of
from hybond.model.builder import Model
from hybond.translate.c_printer import CPrinter, c_number, c_table, c_text
from hybond.translate.c_words import HEADERS, c_words
from hybond.translate.lines import block_comment, plain, prose, wrapped
from hybond.uncollected import uncollected

LEAVES = ["functions", "lookup"]
"""Chapters that stand before the model's expressions, which call them."""


def to_c(model: Model, **options: object) -> str:
    """Return a model as one readable C99 file that needs nothing but the C library.

    Parameters
    ----------
    **options
        Of the run: ``until``, ``solver``, ``rtol``, ``atol``, ``points``, ``step``, ``theta``,
        ``max_step``, ``impact``; those that are left out are the experiment's.

    Returns
    -------
    str
        ``cc -std=c99 -O2 model.c -lm && ./a.out`` prints the trajectory as a table.

    Raises
    ------
    ModelError, UsageError
        HB-E630 to HB-E632 for what the exported runtime does not have.

    Examples
    --------
    >>> import hybond as hb
    >>> print(to_c(hb.load("examples/bouncing_ball.toml")).splitlines()[0])
    /* Ball on a springy floor (Margetts & Ngwompo)
    """
    found = exported(model, options=options)
    return c_file(model, found, main_of(found))


def main_of(found: Exported) -> str:
    """Return the main of a program."""
    own = found.parameters
    main = MAIN.replace("@TITLE@", c_text(title_of(found.graph))[1:-1])
    if not own.settable and not own.fixed:
        for text in (SET_USAGE, SET_NONE, SET_OPTION, SET_HELP, SET_TAKEN):
            main = main.replace(text, "")
        return main.replace("@SET@", "")
    main = main.replace("@SET@", " [--set NAME=VALUE]")
    if not own.settable:
        main = main.replace(SET_TAKEN, "")
    return "\n".join([*setting(own), "", main])


@uncollected
def c_file(model: Model, found: Exported, tail: str) -> str:
    """Return a model and the runtime as one text, with `tail`, its main or what stands for it."""
    graph = found.graph
    printer = CPrinter(
        found.runs.program, found.roots, effects=found.runs.effects, uses=found.runs.uses
    )
    maker = maker_of("c")
    printer.known, printer.opened = maker.texts, maker.specialist.opened
    printer.kept = SET
    beside = held(found)
    written = found.parameters.tables
    tables = found.tables.floats
    printer.held = {name: max(len(tables[name]), 1) for name in written if name in tables}
    printer.beside = [row.field for row in beside]
    printer.placed = {row.constant: f"m->{row.name}" for row in beside}
    printer.given = {
        **{name: _names(printer, found, name) for name in NAMES},
        "evaluate_pair": _pairs(printer, found),
        "value": _values(printer, found),
    }
    title = title_of(graph)
    lines = block_comment([*wrapped(plain(title), 0), "", *_how_to(), "", *story(model, graph)])
    lines += ["", *_contraction(), *(f"#include <{h}>" for h in HEADERS)]
    lines += [
        "",
        "/* Names of the values that the expressions of the model read. */",
        *_slots(found),
        *places(found.parameters),
    ]
    for name, points in found.points.items():
        if name not in written:
            lines += ["", *c_table(name, points)]
    lines += [
        "",
        *c_words(printer.reached.words, finding=printer.finds_arena),
        "",
        *printer.typedefs(),
    ]
    modules = {m.name: m for m in found.runs.program.modules}
    order = [m.name for m in found.runs.program.modules]
    first = [n for n in LEAVES if n in modules]
    for name in [*first, "model", *(n for n in order if n not in first and n != "model")]:
        module = modules[name]
        if not printer.needed(module):
            continue
        lines += ["", *_heading(module.name, module.doc)]
        lines += printer.chapter(module)
        if name == "model":
            lines += ["", *_model(printer, found)]
    members = {m.name for m in printer.members(found.runs.program.records["Model"])}
    put = putting(printer, found.parameters, members)
    lines += ["", "/* What follows from the parameters. */", *put] if put else []
    lines += ["", *tail.rstrip("\n").split("\n")]
    maker.keep()
    return "\n".join(lines) + "\n"


def _how_to() -> list[str]:
    return [
        f"Exported by hybond {__version__}. Compile and run with",
        "",
        "    cc -std=c99 -O2 FILE.c -lm -o model && ./model > table.csv",
        "",
        "./model --events prints the events instead, ./model --help the options.",
    ]


def _contraction() -> list[str]:
    """Products and sums are rounded one by one, as hybond does it."""
    return [
        "#if defined(__clang__) || !defined(__GNUC__)",
        "#pragma STDC FP_CONTRACT OFF",
        "#endif",
        "",
    ]


def _slots(found: Exported) -> list[str]:
    rows = [(name, k, said) for name, k, said in found.slots]
    rows.append(("PRE", found.tables.slots.size, "where the a priori values begin"))
    lines = ["enum {"]
    for name, k, said in rows:
        lines.append(f"    {name} = {k}, // {plain(said)}")
    lines[-1] = lines[-1].replace(", //", " //", 1)
    return [*lines, "};"]


def _heading(name: str, doc: str) -> list[str]:
    return block_comment([f"Chapter: {name}. {prose(doc)[0]}", *prose(doc)[1:]])


def _names(printer: CPrinter, found: Exported, function: str) -> list[str]:
    if function not in printer.reached.functions:
        return []
    f = found.runs.program.functions[function]
    texts: Sequence[str] = getattr(found.tables, NAMES[function])
    listed = ", ".join(c_text(t) for t in texts) or '""'
    return [
        *printer.documented(f.doc, f.above),
        printer.signature(f),
        "{",
        *wrapped(f"static const char *const names[] = {{{listed}}};", 4),
        "    (void)m;",
        "    return names[k];",
        "}",
    ]


def _values(printer: CPrinter, found: Exported) -> list[str]:
    f = found.runs.program.functions["value"]
    lines = [*printer.documented(f.doc, f.above), printer.signature(f), "{", "    (void)m;"]
    if not found.values:
        lines += ["    (void)v;"]
    lines += ["    switch (k) {"]
    for case in found.values:
        lines.append(f"    case {case.number}: // {plain(case.text)}"[:99])
        lines += wrapped(f"return {printer.said(case.value)};", 8)
    return [*lines, "    default:", "        return (double)NAN;", "    }", "}"]


def _pairs(printer: CPrinter, found: Exported) -> list[str]:
    f = found.runs.program.functions["evaluate_pair"]
    lines = [*printer.documented(f.doc, f.above), printer.signature(f), "{", "    (void)m;"]
    if not found.pairs:
        return [*lines, "    (void)k;", "    (void)s;", "}"]
    lines += ["    switch (k) {"]
    for case in found.pairs:
        lines.append(f"    case {case.number}: // {plain(case.text)}"[:99])
        lines += printer.block(case.code, 8)
        lines.append("        break;")
    return [*lines, "    default:", "        break;", "    }", "}"]


def _model(printer: CPrinter, found: Exported) -> list[str]:
    """Return the tables of the model as one record."""
    t = found.tables
    lines = ["static const Model MODEL = {"]
    for m in printer.members(found.runs.program.records["Model"]):
        if m.name in printer.held:
            numbers = ", ".join(c_number(x) for x in t.floats[m.name])
            lines += wrapped(f".{m.name} = {{{numbers}}},", 4)
            continue
        match m.type.kind:
            case "int":
                lines.append(f"    .{m.name} = {int(t.numbers[m.name])},")
            case "float":
                lines.append(f"    .{m.name} = {c_number(float(t.numbers[m.name]))},")
            case "Ints":
                numbers = ", ".join(map(str, t.ints[m.name])) or "0"
                lines += wrapped(f".{m.name} = (const int[]){{{numbers}}},", 4)
            case _:
                numbers = ", ".join(c_number(x) for x in t.floats[m.name]) or "0.0"
                lines += wrapped(f".{m.name} = (const double[]){{{numbers}}},", 4)
    for row in held(found):
        numbers = ", ".join(map(c_number, row.values))
        lines += wrapped(f".{row.name} = {{{numbers}}},", 4)
    return [*lines, "};"]


SET_USAGE = """\
    "  --set NAME=VALUE gives a parameter another value, in SI; there may be several\\n"
"""
SET_NONE = """\
    bool set[PARAMETERS + 1] = {false};
"""
SET_OPTION = """\
        if (strcmp(argv[k], "--set") == 0 && k + 1 < argc) {
            set_parameter(&model, set, argv[++k]);
            continue;
        }
"""
SET_HELP = """\
            list_parameters(asked ? stdout : stderr);
"""
SET_TAKEN = """\
    take_parameters(&model, set, argc, argv);
"""
MAIN = f"""\
/* The program. */
static const char USAGE[] =
    "@TITLE@\\n"
    "usage: model [--events] [--until T] [--points N] [--rtol X] [--atol X]@SET@\\n"
    "  prints a table of the outputs, comma separated, two rows at an event;\\n"
    "  with --events the transitions and the final state instead\\n"
{SET_USAGE}    "exit codes: 0 fine, 1 usage, 3 the numerics\\n";

static double number_after(int argc, char **argv, int k)
{{
    char *end = NULL;
    const double x = k + 1 < argc ? strtod(argv[k + 1], &end) : 0.0;
    if (end == NULL || end == argv[k + 1] || *end != '\\0' || !(x > 0.0)) {{
        fprintf(stderr, "%s: a positive number is wanted behind it\\n", argv[k]);
        exit(1);
    }}
    return x;
}}

/* Run, and print; return the exit code. Where memory ends, take() leads back to here. */
static int run_model(Arena *arena, const Model *model, bool events)
{{
    if (setjmp(arena->spent) != 0) {{
        fputs("out of memory\\n", stderr);
        return 3;
    }}
    Engine *e = make_engine(arena, model);
    Report *report = make_report(e);
    report->events = events;
    return run_program(e, report);
}}

int main(int argc, char **argv)
{{
    Model model = MODEL;
    bool events = false;
{SET_NONE}    for (int k = 1; k < argc; k++) {{
{SET_OPTION}        if (strcmp(argv[k], "--events") == 0) {{
            events = true;
        }} else if (strcmp(argv[k], "--until") == 0) {{
            model.until = number_after(argc, argv, k++);
        }} else if (strcmp(argv[k], "--points") == 0) {{
            const double points = number_after(argc, argv, k++);
            model.points = points < 1e9 ? (int)points : 1000000000;
        }} else if (strcmp(argv[k], "--rtol") == 0) {{
            model.rtol = number_after(argc, argv, k++);
        }} else if (strcmp(argv[k], "--atol") == 0) {{
            model.atol = number_after(argc, argv, k++);
        }} else {{
            const bool asked = strcmp(argv[k], "--help") == 0;
            fputs(USAGE, asked ? stdout : stderr);
{SET_HELP}            return asked ? 0 : 1;
        }}
    }}
{SET_TAKEN}    Arena arena;
    memset(&arena, 0, sizeof(arena));
    const int code = run_model(&arena, &model, events);
    release(&arena);
    return code;
}}
"""
