"""Parameters in printed C: the array, what puts in all that follows from it, and ``--set``.

The array, and all tables in which numbers follow from parameters, are held by the record of the
model: each copy of that has parameters of its own.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from hybond.export.formulas import ARRAY
from hybond.export.parameters import Parameters
from hybond.export.program import Exported
from hybond.translate.c_printer import CPrinter, c_number, c_text
from hybond.translate.lines import plain, wrapped
from hybond.translate.reserved import permitted
from hybond.translate.tree import Expr


@dataclass(frozen=True, slots=True)
class Held:
    """An array that the record of the model holds beside its tables.

    Parameters
    ----------
    constant : str
        What expressions call it.
    name : str
        The field.
    values : tuple of float
        As the model is written.
    note : str
    """

    constant: str
    name: str
    values: tuple[float, ...]
    note: str

    @property
    def field(self) -> str:
        """Its declaration."""
        return f"    double {self.name}[{len(self.values)}]; // {self.note}"


def held(found: Exported) -> list[Held]:
    """Return the parameters, and the tables of expressions that follow from them."""
    own = found.parameters
    starts = [s.start for s in own.settable] + [n.start for n in own.numbers]
    rows = [Held(ARRAY, ARRAY, tuple(starts), "in SI")] if starts else []
    for name, points in found.points.items():
        if name in own.tables:
            rows.append(Held(name, name.lower(), points, "arguments, then values"))
    return rows


def places(found: Parameters) -> list[str]:
    """Return where the parameters stand, and the numbers that follow from them in expressions."""
    lines = []
    rows = [(s.shown, s.path + _in(s.unit)) for s in found.settable]
    rows += [(n.shown, n.text) for n in found.numbers]
    if rows:
        lines += ["", "/* Where parameters stand, and numbers that follow from them. */", "enum {"]
        for k, (shown, said) in enumerate(rows):
            lines.append(f"    {shown} = {k}, // {plain(said)}"[:98])
        lines[-1] = lines[-1].replace(", //", " //", 1)
        lines.append("};")
    return lines


def _in(unit: str) -> str:
    return f", {unit}" if unit else ""


def putting(printer: CPrinter, found: Parameters, members: Collection[str]) -> list[str]:
    """Return the function that puts in what follows, and says which condition is broken.

    `members` are the tables of the model that are printed.
    """
    if not found.settable:
        return []

    def checked(place: str, value: Expr, indent: int) -> list[str]:
        return wrapped(f"m->{place} = checked({printer.said(value)}, &all_finite);", indent)

    made = [s for s in found.settable if s.made_of is not None]
    puts = []
    for s in made:
        assert s.made_of is not None
        puts.append(f"    if (!set[{s.shown}]) {{")
        puts += [*checked(f"{ARRAY}[{s.shown}]", s.made_of, 8), "    }"]
    for n in found.numbers:
        puts += checked(f"{ARRAY}[{n.shown}]", n.value, 4)
    for x in found.points:
        puts += checked(f"{x.table.lower()}[{x.index}]", x.value, 4)
    for x in found.entries:
        if x.table in members:
            puts += checked(f"{permitted(x.table)}[{x.index}]", x.value, 4)
    lines = [*CHECKED.splitlines(), ""] if puts else []
    lines += PUT_PARAMETERS.splitlines()
    if not puts and not found.conditions:
        lines.append("    (void)m;")
    if not made:
        lines.append("    (void)set;")
    lines += ["    bool all_finite = true;", *puts] if puts else []
    for c in found.conditions:
        lines += wrapped(f"if (!({printer.said(c.holds)})) {{", 4)
        lines += [f"        return {c_text(c.text)};", "    }"]
    said = 'all_finite ? NULL : "every number is finite"' if puts else "NULL"
    return [*lines, f"    return {said};", "}"]


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
            "@PUT@", f"m->{ARRAY}[k] = x;" if found.settable else "(void)x, (void)m;"
        ).splitlines(),
        *(PUT.splitlines() if found.settable else ()),
    ]


CHECKED = """\
/* Return a number that follows from parameters; note where it has no value. */
static double checked(double x, bool *all_finite)
{
    *all_finite = *all_finite && isfinite(x);
    return x;
}
"""
PUT_PARAMETERS = """\
/* Put in what follows from the parameters; `set` says which of them are not to follow. Return what
 * does not hold of them, so that the model is made of other parts, or NULL. */
static const char *put_parameters(Model *m, const bool *set)
{
"""
SETTING = """\
static bool is_called(const char *name, const char *text, size_t n)
{
    return strlen(name) == n && strncmp(name, text, n) == 0;
}

/* Take "NAME=VALUE"; note in `set` which parameter it is. */
static void set_parameter(Model *m, bool *set, const char *text)
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
            set[k] = true;
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
static void take_parameters(Model *m, const bool *set, int argc, char **argv)
{
    bool any = false;
    for (int k = 0; k < PARAMETERS; k++) {
        any = any || set[k];
    }
    if (!any) {
        return;
    }
    const char *broken = put_parameters(m, set);
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
