"""The words of portable modules in C: memory, text, and the smaller of two numbers."""

from __future__ import annotations

from collections.abc import Mapping

HEADERS = ["math.h", "setjmp.h", "stdbool.h", "stdio.h", "stdlib.h", "string.h"]

TAKE = """\
/* Memory, zeroed: an arena for each engine, so that any number of them live beside each other.
 * Where there is no more, take() goes back to where setjmp() stands in what calls the engine: the
 * engine is of no use then, but release() gives all its memory back.
 *
 * Small things share chunks, in the order in which they are made; what is large has one of its
 * own, and so has everything where a checker of addresses watches over their ends.
 */
typedef struct Chunk Chunk;
typedef struct Arena {
    Chunk *large;         /* those of one thing each */
    Chunk *first, *now;   /* those that are shared, and which is filled; none behind it is in use */
    jmp_buf spent;
} Arena;
struct Chunk {
    Chunk *next;
    size_t size, used;
    double start;         /* what follows is as strictly aligned as a double */
};
typedef union Taken {
    Arena *arena;
    double start;
} Taken;
enum { CHUNK_SIZE = 16384 };
#if defined(__SANITIZE_ADDRESS__)
enum { CHUNK_PART = 0 };
#else
enum { CHUNK_PART = CHUNK_SIZE / 8 };
#endif

static Chunk *chunk_of(Arena *arena, size_t size)
{
    Chunk *chunk = calloc(1, sizeof(Chunk) + size);
    if (chunk == NULL) {
        longjmp(arena->spent, 1);
    }
    chunk->size = size;
    return chunk;
}

static void *take(Arena *arena, int count, size_t size)
{
    const size_t wanted = (size_t)(count > 0 ? count : 1) * size;
    const size_t total = (1 + (wanted + sizeof(Taken) - 1) / sizeof(Taken)) * sizeof(Taken);
    Chunk *chunk = arena->now;
    if (total > CHUNK_PART) {
        chunk = chunk_of(arena, total);
        chunk->next = arena->large;
        arena->large = chunk;
    } else if (chunk == NULL) {
        arena->first = arena->now = chunk = chunk_of(arena, CHUNK_SIZE);
    } else if (chunk->size - chunk->used < total) {
        if (chunk->next == NULL) {
            chunk->next = chunk_of(arena, CHUNK_SIZE);
        }
        arena->now = chunk = chunk->next;
    }
    Taken *taken = (void *)((char *)(chunk + 1) + chunk->used);
    chunk->used += total;
    taken->arena = arena;
    return taken + 1;
}

static void release_chunks(Chunk *chunk)
{
    while (chunk != NULL) {
        Chunk *next = chunk->next;
        free(chunk);
        chunk = next;
    }
}

static void release(Arena *arena)
{
    release_chunks(arena->large);
    release_chunks(arena->first);
    arena->large = arena->first = arena->now = NULL;
}
"""
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
