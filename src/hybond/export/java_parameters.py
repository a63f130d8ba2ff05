"""Parameters in printed Java: the array, what puts in all that follows from it, and ``--set``."""

from __future__ import annotations

from collections.abc import Collection

from hybond.export.formulas import ARRAY
from hybond.export.parameters import Parameters
from hybond.translate.java_printer import JavaPrinter, java_number, java_text
from hybond.translate.lines import plain, wrapped

PART = 400
"""Statements that one method may hold: a method of Java has at most 64 KiB of code."""


def declared(found: Parameters) -> list[str]:
    """Return the parameters, and the numbers that follow from them in expressions."""
    if not found.settable:
        return []
    places = [(s.shown, s.path + (f", {s.unit}" if s.unit else "")) for s in found.settable]
    places += [(n.shown, n.text) for n in found.numbers]
    lines = ["", "// Where parameters stand, and numbers that follow from them."]
    for k, (shown, said) in enumerate(places):
        lines.append(f"private static final int {shown} = {k}; // {plain(said)}"[:95])
    starts = [s.start for s in found.settable] + [n.start for n in found.numbers]
    listed = ", ".join(map(java_number, starts))
    return [
        *lines,
        "",
        "/** In SI. */",
        *wrapped(f"private static final double[] PARAMETER_START = {{{listed}}};", 0),
        f"private static double[] {ARRAY} = PARAMETER_START.clone();",
    ]


def putting(printer: JavaPrinter, found: Parameters, members: Collection[str]) -> list[str]:
    """Return the methods that put in what follows, and say which condition is broken.

    `members` are the tables of the model that are printed.
    """
    if not found.settable:
        return []
    puts = []
    for s in found.settable:
        if s.made_of is not None:
            put = wrapped(f"{ARRAY}[{s.shown}] = checked({printer.said(s.made_of)});", 8)
            puts.append([f"    if (!parameterSet[{s.shown}]) {{", *put, "    }"])
    for n in found.numbers:
        puts.append(wrapped(f"{ARRAY}[{n.shown}] = checked({printer.said(n.value)});", 4))
    for x in found.points:
        puts.append(wrapped(f"{x.table}[{x.index}] = checked({printer.said(x.value)});", 4))
    for x in found.entries:
        if x.table in members:
            puts.append(wrapped(f"m.{x.table}[{x.index}] = checked({printer.said(x.value)});", 4))
    tests = []
    for c in found.conditions:
        test = wrapped(f"if (!({printer.said(c.holds)})) {{", 4)
        tests.append([*test, f"        return {java_text(c.text)};", "    }"])
    lines = CHECKED.splitlines()
    parts = [puts[k : k + PART] for k in range(0, len(puts), PART)]
    lines += ["private static void putParameters(Model m) {", "    unfit = false;"]
    lines += [*(f"    putPart{k}(m);" for k in range(len(parts))), "}"]
    for k, part in enumerate(parts):
        lines += ["", f"private static void putPart{k}(Model m) {{"]
        lines += [*(line for put in part for line in put), "}"]
    parts = [tests[k : k + PART] for k in range(0, len(tests), PART)]
    lines += [
        "",
        *BROKEN.splitlines(),
        "    String broken = null;",
    ]
    for k in range(len(parts)):
        lines.append(f"    broken = broken == null ? brokenPart{k}() : broken;")
    last = 'broken == null && unfit ? "every number is finite" : broken'
    lines += [f"    return {last};", "}"]
    for k, part in enumerate(parts):
        lines += ["", f"private static String brokenPart{k}() {{"]
        lines += [*(line for test in part for line in test), "    return null;", "}"]
    return lines


def setting(found: Parameters) -> list[str]:
    """Return what ``--set`` calls."""
    if not found.settable and not found.fixed:
        return []
    rows = [
        f"    {{{java_text(s.path)}, {java_text(java_number(s.start))}, {java_text(s.unit)}, "
        f"{java_text(s.text)}}},"
        for s in found.settable
    ]
    fixed = [f"    {{{java_text(k)}, {java_text(why)}}}," for k, why in found.fixed.items()]
    head = [
        "/** What --set knows: name, start, unit, what it is made of if it is not set. */",
        "private static final String[][] PARAMETERS = {",
        *rows,
        "};",
        "/** Parameters for whose values this class was made, and why. */",
        "private static final String[][] FIXED = {",
        *fixed,
        "};",
        "private static boolean[] parameterSet = new boolean[PARAMETERS.length];",
        "",
    ]
    body = SETTING.replace(
        "@PUT@", f"{ARRAY}[k] = x;" if found.settable else "parameterSet[k] = true;"
    )
    return [*head, *body.splitlines()]


CHECKED = """\
/** Whether a number that follows from parameters has no value. */
private static boolean unfit;

private static double checked(double x) {
    unfit = unfit || Double.isNaN(x) || Double.isInfinite(x);
    return x;
}

/** Put in what follows from the parameters. */
"""
BROKEN = """\
/** Return what does not hold of the parameters, so that the model is made of other parts. */
private static String brokenCondition() {
"""
SETTING = """\
/** Take "NAME=VALUE"; say whether it could be taken. */
private static boolean setParameter(String text) {
    int n = text.indexOf('=');
    String name = n < 0 ? text : text.substring(0, n);
    double x = Double.NaN;
    try {
        x = Double.parseDouble(text.substring(n + 1));
    } catch (NumberFormatException wrong) {
        x = Double.NaN;
    }
    if (n < 0 || Double.isNaN(x) || Double.isInfinite(x)) {
        System.err.println("--set " + text + ": NAME=VALUE is wanted, a number in SI");
        return false;
    }
    for (int k = 0; k < PARAMETERS.length; k++) {
        if (PARAMETERS[k][0].equals(name)) {
            @PUT@
            parameterSet[k] = true;
            return true;
        }
    }
    for (String[] other : FIXED) {
        if (other[0].equals(name)) {
            System.err.println(name + " is fixed in this class: " + other[1]
                    + "; export it again with --set " + text);
            return false;
        }
    }
    System.err.println("--set " + text + ": there is no such parameter; --help lists them");
    return false;
}

private static void listParameters(PrintStream to) {
    to.print("parameters, in SI:\\n");
    for (String[] known : PARAMETERS) {
        String unit = known[2].isEmpty() ? "" : " " + known[2];
        String from = known[3].isEmpty() ? "" : ", from " + known[3];
        to.print("  " + known[0] + " = " + known[1] + unit + from + "\\n");
    }
    for (String[] known : FIXED) {
        to.print("  " + known[0] + " is fixed: " + known[1] + "\\n");
    }
}
"""
