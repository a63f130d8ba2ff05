"""Memory of printed C: things in chunks, apart, zeroed, and put back as they were."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from export.programs import compile_quickly

import hybond
from hybond.translate.c_words import HEADERS, c_words

MEMBERS = Path(hybond.__file__).parent / "engine" / "compiled" / "members.c"
COUNTED = """
static long held = 0, left = -1;

static void *counted(size_t n, size_t size)
{
    if (left == 0)
        return NULL;
    left -= left > 0;
    held++;
    return calloc(n, size);
}

static void given_back(void *p)
{
    held -= p != NULL;
    free(p);
}
#define calloc(n, size) counted(n, size)
#define free(p) given_back(p)
"""
MAIN = """
enum { THINGS = 4000 };
static Arena arena;
static unsigned char *thing[THINGS], *again[THINGS];
static int many[THINGS];

static void check(bool holds, const char *what, int k)
{
    if (!holds)
        printf("%s: %d\\n", what, k);
}

/* Take things number `from` to `to`, mostly small: zeroed, aligned, with a way to their arena. */
static void take_some(unsigned char **where, int from, int to)
{
    for (int k = from; k < to; k++) {
        where[k] = take(&arena, many[k], 1);
        check((size_t)where[k] % sizeof(double) == 0, "not aligned", k);
        check(arena_of(where[k]) == &arena, "of another arena", k);
        for (int i = 0; i < many[k]; i++)
            check(where[k][i] == 0, "not zeroed", k);
    }
}

static void fill(unsigned char **where, int from, int to, int by)
{
    for (int k = from; k < to; k++)
        memset(where[k], 1 + (k + by) % 250, (size_t)many[k]);
}

static void look(unsigned char **where, int from, int to, const char *what)
{
    for (int k = from; k < to; k++)
        for (int i = 0; i < many[k]; i++)
            check(where[k][i] == 1 + k % 250, what, k);
}

static void keeps(int first)
{
    Image image;
    take_some(thing, 0, first);
    fill(thing, 0, first, 0);
    check(keep_image(&arena, &image), "no image", first);
    for (int round = 0; round < 3; round++) {
        take_some(again, first, THINGS);
        fill(again, first, THINGS, 0);
        look(thing, 0, first, "lies on another");
        look(again, first, THINGS, "lies on another");
        for (int k = first; k < THINGS && round > 0; k++)
            if (many[k] <= CHUNK_PART / 2 && CHUNK_PART > 0)
                check(again[k] == thing[k], "elsewhere", k);
        memcpy(thing + first, again + first, (THINGS - first) * sizeof(*thing));
        fill(thing, 0, first, 1 + round);
        restore(&arena, &image);
        look(thing, 0, first, "not put back");
    }
    (free)(image.bytes);
    release(&arena);
    check(held == 0, "blocks left", (int)held);
}

/* As a caller does whose memory ends after so many blocks; whether it did. */
static bool spent_after(long blocks)
{
    left = blocks;
    const bool spent = setjmp(arena.spent) != 0;
    if (!spent)
        take_some(again, 0, THINGS);
    release(&arena);
    left = -1;
    check(held == 0, "blocks left", (int)held);
    return spent;
}

int main(void)
{
    unsigned seed = 1;
    for (int k = 0; k < THINGS; k++) {
        seed = seed * 1103515245u + 12345u;
        const int dice = (int)(seed >> 16);
        many[k] = dice % 50 == 0 ? dice % (3 * CHUNK_SIZE) : dice % 200;
    }
    keeps(0);
    keeps(1);
    keeps(THINGS / 2);
    check(spent_after(0), "not told", 0);
    check(spent_after(1), "not told", 1);
    check(spent_after(40), "not told", 40);
    check(!spent_after(-1), "told", -1);
    puts("done");
    return 0;
}
"""


@pytest.mark.c
def test_things_lie_apart_and_are_put_back_as_they_were(tmp_path: Path) -> None:
    """Sizes as a die has them: of nothing, of a few numbers, of more than a chunk."""
    text = MEMBERS.read_text(encoding="utf-8")
    image = text[text.index("/* What an arena holds") : text.index("typedef struct HybondMembers")]
    kept = text[text.index("static size_t used_by") : text.index("/* Make ready for members")]
    words = "\n".join(c_words(frozenset(), finding=True))
    includes = "\n".join(f"#include <{header}>" for header in HEADERS)
    source = "\n".join([includes, COUNTED, words, image, kept, MAIN])
    program = compile_quickly(source, tmp_path, "arenas")
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "done\n")
