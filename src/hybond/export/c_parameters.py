"""Parameters in printed C: the array, what puts in all that follows from it, and ``--set``."""

from __future__ import annotations

from collections.abc import Collection

from hybond.export.formulas import ARRAY
from hybond.export.parameters import Parameters
from hybond.export.translate.c_printer import CPrinter, c_number, c_text
from hybond.export.translate.lines import plain, wrapped
from hybond.export.translate.tree import Expr


def table_name(member: str) -> str:
    """Return what a table of the model is called that is written to."""
    return f"MODEL_{member.upper()}"


def declared(found: Parameters) -> list[str]:
    """Return the parameters, and the numbers that follow from them in expressions."""
    if not found.settable and not found.fixed:
        return []
    lines = []
    places = [(s.shown, s.path + _in(s.unit)) for s in found.settable]
    places += [(n.shown, n.text) for n in found.numbers]
    if places:
        lines += ["", "/* Where parameters stand, and numbers that follow from them. */", "enum {"]
        for k, (shown, said) in enumerate(places):
            lines.append(f"    {shown} = {k}, // {plain(said)}"[:98])
        lines[-1] = lines[-1].replace(", //", " //", 1)
        starts = [s.start for s in found.settable] + [n.start for n in found.numbers]
        listed = ", ".join(map(c_number, starts))
        lines += ["};", "", "/* In SI. */"]
        lines += wrapped(f"static double {ARRAY}[] = {{{listed}}};", 0)
    return lines


def _in(unit: str) -> str:
    return f", {unit}" if unit else ""


def putting(printer: CPrinter, found: Parameters, members: Collection[str]) -> list[str]:
    """Return the functions that put in what follows, and say which condition is broken.

    `members` are the tables of the model that are printed.
    """
    if not found.settable:
        return []

    def checked(place: str, value: Expr, indent: int) -> list[str]:
        return wrapped(f"{place} = checked({printer.said(value)});", indent)

    made = [s for s in found.settable if s.made_of is not None]
    puts = []
    for s in made:
        assert s.made_of is not None
        puts.append(f"    if (!set[{s.shown}]) {{")
        puts += [*checked(f"{ARRAY}[{s.shown}]", s.made_of, 8), "    }"]
    for n in found.numbers:
        puts += checked(f"{ARRAY}[{n.shown}]", n.value, 4)
    for x in found.points:
        puts += checked(f"{x.table}[{x.index}]", x.value, 4)
    for x in found.entries:
        if x.table in members:
            puts += checked(f"{table_name(x.table)}[{x.index}]", x.value, 4)
    lines = UNFIT.splitlines()
    if puts:
        lines += CHECKED.splitlines()
    lines += PUT_PARAMETERS.splitlines()
    if not made:
        lines.append("    (void)set;")
    lines += ["    unfit = false;", *puts, "}", "", *BROKEN.splitlines()]
    for c in found.conditions:
        lines += wrapped(f"if (!({printer.said(c.holds)})) {{", 4)
        lines += [f"        return {c_text(c.text)};", "    }"]
    return [*lines, '    return unfit ? "every number is finite" : NULL;', "}"]


def setting(found: Parameters) -> list[str]:
    """Return what ``--set`` calls."""
    if not found.settable and not found.fixed:
        return []
    rows = [
        f"    {{{c_text(s.path)}, {c_text(s.unit)}, {c_text(s.text)}, {c_number(s.start)}}},"
        for s in found.settable
    ]
    fixed = [f"    {{{c_text(k)}, {c_text(why)}}}," for k, why in found.fixed.items()]
    return [
        "/* What --set knows: parameters, with what they are made of if they are not set; and the",
        " * others, for whose values this file was made. */",
        f"enum {{ PARAMETERS = {len(rows)}, FIXED = {len(fixed)} }};",
        "static const struct {",
        "    const char *name, *unit, *made_of;",
        "    double start;",
        "} PARAMETER[] = {",
        *(rows or ['    {"", "", "", 0.0},']),
        "};",
        "static const struct {",
        "    const char *name, *why;",
        "} FIXED_PARAMETER[] = {",
        *(fixed or ['    {"", ""},']),
        "};",
        "",
        *SETTING.replace(
            "@PUT@", f"{ARRAY}[k] = x;" if found.settable else "(void)x;"
        ).splitlines(),
        *(PUT.splitlines() if found.settable else ()),
    ]


UNFIT = """\
/* Whether a number that follows from parameters has no value. */
static bool unfit = false;
"""
CHECKED = """\

static double checked(double x)
{
    unfit = unfit || !isfinite(x);
    return x;
}
"""
PUT_PARAMETERS = """\

/* Put in what follows from the parameters; `set` says which of them are not to follow. */
static void put_parameters(const bool *set)
{
"""
BROKEN = """\
/* Return what does not hold of the parameters, so that the model is made of other parts. */
static const char *broken_condition(void)
{
"""
SETTING = """\
static bool parameter_set[PARAMETERS + 1];

static bool is_called(const char *name, const char *text, size_t n)
{
    return strlen(name) == n && strncmp(name, text, n) == 0;
}

/* Take "NAME=VALUE". */
static void set_parameter(const char *text)
{
    const size_t n = strcspn(text, "=");
    char *end = NULL;
    const double x = text[n] == '=' ? strtod(text + n + 1, &end) : 0.0;
    if (end == NULL || end == text + n + 1 || *end != '\\0' || !isfinite(x)) {
        fprintf(stderr, "--set %s: NAME=VALUE is wanted, a number in SI\\n", text);
        exit(1);
    }
    for (int k = 0; k < PARAMETERS; k++) {
        if (is_called(PARAMETER[k].name, text, n)) {
            @PUT@
            parameter_set[k] = true;
            return;
        }
    }
    for (int k = 0; k < FIXED; k++) {
        if (is_called(FIXED_PARAMETER[k].name, text, n)) {
            fprintf(stderr, "%s is fixed in this file: %s; export it again with --set %s\\n",
                    FIXED_PARAMETER[k].name, FIXED_PARAMETER[k].why, text);
            exit(1);
        }
    }
    fprintf(stderr, "--set %s: there is no such parameter; --help lists them\\n", text);
    exit(1);
}

static void list_parameters(FILE *to)
{
    fputs("parameters, in SI:\\n", to);
    for (int k = 0; k < PARAMETERS; k++) {
        fprintf(to, "  %s = %.9g%s%s%s%s\\n", PARAMETER[k].name, PARAMETER[k].start,
                PARAMETER[k].unit[0] != '\\0' ? " " : "", PARAMETER[k].unit,
                PARAMETER[k].made_of[0] != '\\0' ? ", from " : "", PARAMETER[k].made_of);
    }
    for (int k = 0; k < FIXED; k++) {
        fprintf(to, "  %s is fixed: %s\\n", FIXED_PARAMETER[k].name, FIXED_PARAMETER[k].why);
    }
}
"""
PUT = """\

/* Put in what follows from the values that were set; end where the model is another one. */
static void take_parameters(int argc, char **argv)
{
    bool any = false;
    for (int k = 0; k < PARAMETERS; k++) {
        any = any || parameter_set[k];
    }
    if (!any) {
        return;
    }
    put_parameters(parameter_set);
    const char *broken = broken_condition();
    if (broken == NULL) {
        return;
    }
    fprintf(stderr, "the model is made of other parts where not %s: export it again with", broken);
    for (int k = 1; k + 1 < argc; k++) {
        if (strcmp(argv[k], "--set") == 0) {
            fprintf(stderr, " --set %s", argv[k + 1]);
        }
    }
    fputc('\\n', stderr);
    exit(1);
}
"""
