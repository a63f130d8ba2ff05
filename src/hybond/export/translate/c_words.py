"""The words of portable modules in C: memory, text, and the smaller of two numbers."""

from __future__ import annotations

from collections.abc import Mapping

HEADERS = ["math.h", "stdbool.h", "stdio.h", "stdlib.h", "string.h"]

TAKE = """\
/* Memory: zeroed, taken while the program begins and when a mode is first entered, given back at
 * the end by release(). A program that cannot have it ends here.
 */
typedef struct Taken Taken;
struct Taken {
    Taken *next;
    double start;
};
static Taken *last_taken = NULL;

static void *take(int count, size_t size)
{
    const size_t total = (size_t)(count > 0 ? count : 1) * size;
    Taken *block = calloc(1, sizeof(Taken) + total);
    if (block == NULL) {
        fputs("out of memory\\n", stderr);
        exit(3);
    }
    block->next = last_taken;
    last_taken = block;
    return block + 1;
}

static void release(void)
{
    while (last_taken != NULL) {
        Taken *next = last_taken->next;
        free(last_taken);
        last_taken = next;
    }
}
"""
"""`start` makes what follows a block as strictly aligned as a double."""

_HELPERS: Mapping[str, str] = {
    "floats": """\
static double *floats(int n)
{
    return take(n, sizeof(double));
}
""",
    "ints": """\
static int *ints(int n)
{
    return take(n, sizeof(int));
}
""",
    "min float": """\
static double smaller(double a, double b)
{
    return b < a ? b : a;
}
""",
    "max float": """\
static double larger(double a, double b)
{
    return b > a ? b : a;
}
""",
    "min int": """\
static int smaller_int(int a, int b)
{
    return b < a ? b : a;
}
""",
    "max int": """\
static int larger_int(int a, int b)
{
    return b > a ? b : a;
}
""",
    "empty": """\
static bool empty(const char *text)
{
    return text == NULL || text[0] == '\\0';
}
""",
    "put_text": """\
static void put_text(const char *text)
{
    if (text != NULL)
        fputs(text, stdout);
}
""",
    "put_number": """\
/* Write a number with 15, 16 or 17 digits, the fewest of these that read back as it. */
static void put_number(double x)
{
    char text[40];
    if (isnan(x)) {
        fputs("nan", stdout);
        return;
    }
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, x);
        if (strtod(text, NULL) == x)
            break;
    }
    fputs(text, stdout);
}
""",
    "put_int": """\
static void put_int(int i)
{
    printf("%d", i);
}
""",
    "put_line": """\
static void put_line(void)
{
    putchar('\\n');
}
""",
}


def c_words(words: frozenset[str]) -> list[str]:
    """Return the helpers that the printed text calls."""
    found = TAKE.splitlines()
    for word, text in _HELPERS.items():
        if word in words:
            found += ["", *text.splitlines()]
    return found
