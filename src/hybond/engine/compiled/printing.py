"""The engine printed as one library: nothing of any model in it, which is data."""

from __future__ import annotations

from pathlib import Path

from hybond.engine.compiled.sources import ENGINE, SHOWN, digest, portable_paths
from hybond.engine.expressions.code import DEEPEST
from hybond.translate.c_printer import CPrinter, c_text
from hybond.translate.c_words import HEADERS, c_words
from hybond.translate.effects import effects_of
from hybond.translate.lines import block_comment, prose, wrapped
from hybond.translate.modules import Program, load

HERE = Path(__file__).parent
ROOTS = (
    *("make_engine", "make_report", "make_run", "run_to_end", "forget_rows", "report_broken"),
    *("make_look", "look_into", "points_at", "points_within", "ask_for"),
    "look_from",
    *("look_values", "look_parts", "parts_of", "make_meter", "look_powers", "look_energies"),
    *("look_stored", "look_sources", "look_by_knowns", "try_at_start"),
    *("run_code", "run_pair_code", "make_carrier", "take_out", "take_over"),
)
"""What `library.c` calls, and what evaluates expressions."""
COLUMNS = """\
    const int *code;
    const int *value_begins;
    const int *pair_begins;
    const double *code_number;
    const char *const *node_names;
    const char *const *bond_names;
    const char *const *rule_texts;
    const char *const *machine_names;
    const char *const *state_names;
    const char *const *stored_names;
    const char *const *output_names;
"""
"""Columns of a model that the functions below read, behind those of the record."""
GIVEN = {
    "value": """\
static double value(const Model *m, int k, const double *v)
{
    double stack[@DEEPEST@];
    return run_code(m->code, m->value_begins[k], m->code_number, v, stack);
}
""",
    "evaluate_pair": """\
static void evaluate_pair(const Model *m, int k, Stack *s)
{
    run_pair_code(m->code, m->pair_begins[k], m->code_number, s);
}
""",
    "copy_floats": """\
static void copy_floats(int n, const double *a, double *b)
{
    memmove(b, a, (size_t)n * sizeof(double));
}
""",
    "copy_part": """\
static void copy_part(int n, const double *a, int first, double *b, int at)
{
    memmove(b + at, a + first, (size_t)n * sizeof(double));
}
""",
    "call_input": """\
/* A run has its arena: `library.c` knows which run it is, and whom to ask. */
enum { VALUE, RATE, BLOCK, OUTSIDE };
static double ask_run(Arena *arena, int what, int k, double t, int piece, double *values);

static double call_input(Calls *c, int i, double t, int piece)
{
    return ask_run(arena_of(c), VALUE, i, t, piece, c->values);
}
""",
    "call_input_rate": """\
static double call_input_rate(Calls *c, int i, double t, int piece)
{
    return ask_run(arena_of(c), RATE, i, t, piece, c->values);
}
""",
    "call_block": """\
static void call_block(Calls *c, int block, double t)
{
    (void)ask_run(arena_of(c), BLOCK, block, t, 0, c->values);
}
""",
    "call_outside": """\
static void look_outside(Arena *arena);

static void call_outside(Calls *c)
{
    look_outside(arena_of(c));
}
""",
}
LOOKING = ("asked", "look", "energies", "known")
"""Modules that exports do not have; they have `report` instead of `log`."""
NAMES = {
    "machine_name": "machine_names",
    "state_name": "state_names",
    "stored_name": "stored_names",
    "output_name": "output_names",
    "node_name": "node_names",
    "bond_name": "bond_names",
    "rule_text": "rule_texts",
}


def program() -> Program:
    """Return the engine as a program, which logs what it does."""
    looking = [ENGINE / "looking" / f"{name}.py" for name in LOOKING]
    running = [ENGINE / "run" / f"{name}.py" for name in ("motion", "trying")]
    roots = [*running, ENGINE / "expressions" / "code.py", *looking]
    return load(roots, portable_paths())


def _columns(printer: CPrinter) -> list[str]:
    """Return the columns of a model in the library, in order: type and name.

    Types are ``int``, ``float``, ``Ints``, ``Floats`` and ``Texts``.
    """
    kinds = {"const int *": "Ints", "const double *": "Floats", "const char *const *": "Texts"}
    members = printer.members(printer.program.records["Model"])
    found = [f"{m.type.kind} {m.name}" for m in members]
    for line in COLUMNS.splitlines():
        kind, _, name = line.strip().rstrip(";").rpartition("*")
        found.append(f"{kinds[f'{kind}*']} {name}")
    return found


def library_text() -> str:
    """Return the library as one file of C99."""
    found = program()
    printer = _printer(found)
    words = c_words(printer.reached.words, finding=printer.finds_arena)
    lines = block_comment(["The engine of hybond, for models that are data."])
    lines += ["#if defined(__clang__) || !defined(__GNUC__)", "#pragma STDC FP_CONTRACT OFF"]
    lines += ["#endif", "", *(f"#include <{h}>" for h in HEADERS), "", *words, ""]
    lines += printer.typedefs()
    modules = {m.name: m for m in found.modules}
    first = ["functions", "lookup", "pairs", "code", "model", "answers"]
    for name in [*first, *(n for n in modules if n not in first)]:
        if printer.needed(modules[name]):
            head = prose(modules[name].doc)
            lines += ["", *block_comment([f"Chapter: {name}. {head[0]}", *head[1:]])]
            lines += printer.chapter(modules[name])
    lines += ["", f'#define HYBOND_SOURCE "{digest()}"']
    listed = ", ".join(c_text(column) for column in _columns(printer))
    lines += wrapped(f"static const char *const HYBOND_COLUMNS[] = {{{listed}, NULL}};", 0)
    shown = [(HERE / name).read_text(encoding="utf-8") for name in SHOWN]
    return "\n".join([*lines, "", *shown])


def _printer(found: Program) -> CPrinter:
    printer = CPrinter(found, ROOTS, effects=effects_of(found, ROOTS))
    names = {f: _name_text(f, column) for f, column in NAMES.items()}
    texts = {n: t.replace("@DEEPEST@", str(DEEPEST)) for n, t in {**GIVEN, **names}.items()}
    reached = printer.reached.functions
    printer.given = {name: text.splitlines() for name, text in texts.items() if name in reached}
    printer.beside = COLUMNS.splitlines()
    return printer


def _name_text(function: str, column: str) -> str:
    return f"""\
static const char *{function}(const Model *m, int k)
{{
    return m->{column}[k];
}}
"""
