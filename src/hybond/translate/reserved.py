"""Names that belong to the languages that portable modules are printed in."""

from __future__ import annotations


def _names(text: str) -> frozenset[str]:
    return frozenset(text.split())


C_WORDS = _names(
    """
    auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while bool true false NULL INFINITY NAN
    """
)
JAVA_WORDS = _names(
    """
    abstract assert boolean break byte case catch char class const continue default do double
    else enum extends final finally float for goto if implements import instanceof int interface
    long native new null package private protected public return short static strictfp super
    switch synchronized this throw throws transient try var void volatile while yield record
    sealed permits true false
    """
)
TYPES = _names(
    """
    String Math StrictMath System Double Integer Boolean Object Character Arrays Locale List
    BigDecimal MathContext FILE Arena Taken Chunk CHUNK_SIZE CHUNK_PART
    """
)
C_LIBRARY = _names(
    """
    abort abs acos acosh asctime asin asinh assert atan atan2 atanh atexit atof atoi atol
    bsearch calloc cbrt ceil clearerr clock copysign cos cosh ctime difftime div erf erfc errno
    exit exp exp2 expm1 fabs fclose fdim feof ferror fflush fgetc fgets floor fma fmax fmin fmod
    fopen fpclassify fprintf fputc fputs fread free freopen frexp fscanf fseek ftell fwrite getc
    getchar getenv gets gmtime hypot ilogb index isfinite isinf isnan isnormal isalpha isdigit
    isspace j0 j1 jn jmp_buf labs ldexp ldiv lgamma llabs llrint llround localtime log log10
    log1p log2 logb longjmp lrint lround main malloc max memchr memcmp memcpy memmove memset min
    mktime modf nan nearbyint nextafter nexttoward perror pow printf putc putchar puts qsort
    rand realloc remove remainder remquo rename rewind rindex rint round scalbln scalbn scanf
    setbuf setjmp setvbuf signal signbit sin sinh sprintf sqrt srand sscanf stderr stdin stdout
    strcat strchr strcmp strcpy strlen strncmp strstr strtod strtol strtoul strftime system tan
    tanh tgamma time tmpfile tolower toupper trunc ungetc vprintf y0 y1 yn
    """
)
"""Functions of the headers that the printed C includes, and their neighbours."""

LOCALS = C_WORDS | JAVA_WORDS | {"arena"}
"""What no variable or field is called in print."""
GLOBALS = LOCALS | TYPES | C_LIBRARY
"""What no constant, record or function is called in print."""


def permitted(name: str) -> str:
    """Return what a variable or field is called in print.

    Examples
    --------
    >>> permitted("new"), permitted("old")
    ('new_', 'old')
    """
    return f"{name}_" if name in LOCALS else name
