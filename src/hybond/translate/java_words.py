"""The words of portable modules in Java: text, and the smaller of two numbers."""

from __future__ import annotations

from collections.abc import Mapping

_HELPERS: Mapping[str, str] = {
    "min float": """\
private static double smaller(double a, double b) {
    return b < a ? b : a;
}
""",
    "max float": """\
private static double larger(double a, double b) {
    return b > a ? b : a;
}
""",
    "min int": """\
private static int smaller_int(int a, int b) {
    return b < a ? b : a;
}
""",
    "max int": """\
private static int larger_int(int a, int b) {
    return b > a ? b : a;
}
""",
    "empty": """\
private static boolean empty(String text) {
    return text == null || text.isEmpty();
}
""",
    "put_text": """\
private static void put_text(String text) {
    out.print(text == null ? "" : text);
}
""",
    "put_number": """\
/** Write a number with 15, 16 or 17 digits, the fewest of these that read back as it. */
private static void put_number(double x) {
    out.print(number_text(x));
}

private static String number_text(double x) {
    if (Double.isNaN(x)) {
        return "nan";
    }
    if (Double.isInfinite(x)) {
        return x > 0.0 ? "inf" : "-inf";
    }
    if (x == 0.0) {
        return 1.0 / x > 0.0 ? "0" : "-0";
    }
    for (int digits = 15; digits < 17; digits++) {
        String text = rounded(x, digits);
        if (Double.parseDouble(text) == x) {
            return text;
        }
    }
    return rounded(x, 17);
}

/** Return a number as printf's %.17g writes it, with this number of digits. */
private static String rounded(double x, int digits) {
    BigDecimal exact = new BigDecimal(Math.abs(x));
    BigDecimal near = exact.round(new MathContext(digits, RoundingMode.HALF_EVEN));
    String figures = near.unscaledValue().toString();
    int exponent = figures.length() - 1 - near.scale();
    figures = figures.replaceAll("0+$", "");
    StringBuilder text = new StringBuilder(x < 0.0 ? "-" : "");
    if (exponent < -4 || exponent >= digits) {
        text.append(figures.charAt(0));
        if (figures.length() > 1) {
            text.append('.').append(figures, 1, figures.length());
        }
        int size = Math.abs(exponent);
        text.append(exponent < 0 ? "e-" : "e+").append(size < 10 ? "0" : "");
        return text.append(size).toString();
    }
    if (exponent < 0) {
        return text.append("0.").append("0".repeat(-exponent - 1)).append(figures).toString();
    }
    if (figures.length() <= exponent + 1) {
        return text.append(figures).append("0".repeat(exponent + 1 - figures.length())).toString();
    }
    text.append(figures, 0, exponent + 1).append('.');
    return text.append(figures, exponent + 1, figures.length()).toString();
}
""",
    "put_int": """\
private static void put_int(int i) {
    out.print(i);
}
""",
    "put_line": """\
private static void put_line() {
    out.print('\\n');
}
""",
}

IMPORTS = [
    "java.io.BufferedOutputStream",
    "java.io.PrintStream",
    "java.math.BigDecimal",
    "java.math.MathContext",
    "java.math.RoundingMode",
]


def java_words(words: frozenset[str]) -> list[str]:
    """Return the helpers that the printed text calls."""
    found: list[str] = []
    for word, text in _HELPERS.items():
        if word in words:
            found += ["", *text.splitlines()]
    return found
