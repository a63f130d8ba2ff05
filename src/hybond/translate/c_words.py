"""The words of portable modules in C: memory, text, and the smaller of two numbers."""

from __future__ import annotations

from collections.abc import Mapping

HEADERS = ["math.h", "setjmp.h", "stdbool.h", "stdio.h", "stdlib.h", "string.h"]

TAKE = """\
/* Memory, zeroed: an arena for each engine, so that any number of them live beside each other.
 * Where there is no more, take() goes back to where setjmp() stands in what calls the engine: the
 * engine is of no use then, but release() gives all its memory back.
 */
typedef struct Taken Taken;
typedef struct Arena {
    Taken *last;
    jmp_buf spent;
} Arena;
struct Taken {
    Taken *next;
    Arena *arena;
    size_t size;
    double start;
};

static void *take(Arena *arena, int count, size_t size)
{
    const size_t total = (size_t)(count > 0 ? count : 1) * size;
    Taken *block = calloc(1, sizeof(Taken) + total);
    if (block == NULL) {
        longjmp(arena->spent, 1);
    }
    block->arena = arena;
    block->size = total;
    block->next = arena->last;
    arena->last = block;
    return block + 1;
}

static void release(Arena *arena)
{
    while (arena->last != NULL) {
        Taken *next = arena->last->next;
        free(arena->last);
        arena->last = next;
    }
}
"""
"""`start` makes what follows a block as strictly aligned as a double."""
ARENA_OF = """\
/* The arena in which something was made. */
static Arena *arena_of(const void *made)
{
    return ((const Taken *)made - 1)->arena;
}
"""

_HELPERS: Mapping[str, str] = {
    "floats": """\
static double *floats(Arena *arena, int n)
{
    return take(arena, n, sizeof(double));
}
""",
    "ints": """\
static int *ints(Arena *arena, int n)
{
    return take(arena, n, sizeof(int));
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


def c_words(words: frozenset[str], *, finding: bool) -> list[str]:
    """Return the helpers that the printed text calls; `finding` says whether an arena is found."""
    found = [*TAKE.splitlines(), *(["", *ARENA_OF.splitlines()] if finding else [])]
    for word, text in _HELPERS.items():
        if word in words:
            found += ["", *text.splitlines()]
    return found
