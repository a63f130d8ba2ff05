"""Text for LaTeX: pure ASCII, safe and printable with any engine and encoding."""

from __future__ import annotations

import unicodedata

_SPECIAL = {
    # From the mathematical fonts: those for text do not have them in every family.
    "\\": r"\ensuremath{\backslash}",
    "{": r"\ensuremath{\{}",
    "}": r"\ensuremath{\}}",
    "#": r"\#",
    "$": r"\$",
    "%": r"\%",
    "&": r"\&",
    "_": r"\_",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "`": r"\textasciigrave{}",
    # Ligatures and letters that the old encoding of LaTeX does not have.
    "'": "{'}",
    '"': r"{''}",
    "<": r"\ensuremath{<}",
    ">": r"\ensuremath{>}",
    "|": r"\ensuremath{|}",
    "°": r"\textsuperscript{\ensuremath{\circ}}",
    "′": "{'}",
    "…": r"\ldots{}",
    "–": "{--}",
    "—": "{---}",
    "‘": "{`}",
    "’": "{'}",
    "“": "{``}",
    "”": "{''}",
    "ß": r"\ss{}",
    "ø": r"\o{}",
    "Ø": r"\O{}",
    "æ": r"\ae{}",
    "Æ": r"\AE{}",
    "œ": r"\oe{}",
    "Œ": r"\OE{}",
    "ł": r"\l{}",
    "Ł": r"\L{}",
    "ı": r"\i{}",
    "§": r"\S{}",
    "©": r"\copyright{}",
    "€": "EUR",
}

_MATH = {
    "·": r"\cdot",
    "×": r"\times",
    "÷": r"\div",
    "±": r"\pm",
    "−": "-",
    "≤": r"\leq",
    "≥": r"\geq",
    "≠": r"\neq",
    "≈": r"\approx",
    "→": r"\rightarrow",
    "←": r"\leftarrow",
    "⟂": r"\perp",
    "∂": r"\partial",
    "∞": r"\infty",
    "√": r"\surd",
    "∫": r"\int",
    "Σ": r"\Sigma",
    "∑": r"\Sigma",
    "Δ": r"\Delta",
    "∆": r"\Delta",
    "µ": r"\mu",
    "Ω": r"\Omega",
}

# From alpha on, in the order of Unicode; LaTeX has no omicron of its own.
_GREEK = (
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa"),
    *("lambda", "mu", "nu", "xi", "o", "pi", "rho", "varsigma", "sigma", "tau", "upsilon"),
    *("phi", "chi", "psi", "omega"),
)
_CAPITAL = {
    "Γ": "Gamma",
    "Θ": "Theta",
    "Λ": "Lambda",
    "Ξ": "Xi",
    "Π": "Pi",
    "Υ": "Upsilon",
    "Φ": "Phi",
    "Ψ": "Psi",
}
_LATIN_CAPITALS = dict(zip("ΑΒΕΖΗΙΚΜΝΟΡΤΧ", "ABEZHIKMNOPTX", strict=True))

_ACCENTS = {
    "\u0300": "`",
    "\u0301": "'",
    "\u0302": "^",
    "\u0303": "~",
    "\u0308": '"',
    "\u0304": "=",
    "\u0307": ".",
    "\u0306": "u ",
    "\u030c": "v ",
    "\u030b": "H ",
    "\u030a": "r ",
    "\u0327": "c ",
}
_RAISED = dict(zip("⁻⁺⁰¹²³⁴⁵⁶⁷⁸⁹ⁿ", "-+0123456789n", strict=True))
_LOWERED = dict(zip("₋₊₀₁₂₃₄₅₆₇₈₉", "-+0123456789", strict=True))

_SIZES = (5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 10.95, 12.0, 14.4, 17.28, 20.74)


def escape(text: str) -> str:
    r"""Return `text` as LaTeX that prints it.

    A letter that LaTeX does not have without further packages is printed as its code point.

    Examples
    --------
    >>> escape("50% of k_1 & Ω")
    '50\\% of k\\_1 \\& \\ensuremath{\\Omega}'
    >>> escape("m/(N·s²)"), escape("中")
    ('m/(N\\ensuremath{\\cdot}s\\textsuperscript{2})', '[U+4E2D]')
    """
    found = []
    k = 0
    while k < len(text):
        for table, command in ((_RAISED, "superscript"), (_LOWERED, "subscript")):
            end = k
            while end < len(text) and text[end] in table:
                end += 1
            if end > k:
                inner = "".join(table[c] for c in text[k:end]).replace("-", r"\ensuremath{-}")
                found.append(rf"\text{command}{{{inner}}}")
                break
        else:
            end = k + 1
            found.append(_hyphen(text[:k]) if text[k] == "-" else _letter(text[k]))
        k = end
    return "".join(found)


def font_size(points: float) -> tuple[str, str]:
    """Return the nearest size that the fonts of LaTeX come in, and its line skip, as TeX reads.

    Examples
    --------
    >>> font_size(7.9), font_size(14.2)
    (('8', '9.6'), ('14.4', '17.3'))
    """
    size = min(_SIZES, key=lambda s: abs(s - points))
    return f"{size:g}", f"{1.2 * size:.1f}"


def _hyphen(before: str) -> str:
    """Return a hyphen within a word, else a minus; two of them are no dash."""
    return "{-}" if before[-1:].isalnum() else r"\ensuremath{-}"


def _letter(letter: str) -> str:
    letter = unicodedata.normalize("NFC", letter)  # the sign of the ohm is an omega
    if letter in _SPECIAL:
        return _SPECIAL[letter]
    if letter in _MATH:
        return rf"\ensuremath{{{_MATH[letter]}}}"
    if " " <= letter <= "~":
        return letter
    if letter.isspace():
        return " "
    if "α" <= letter <= "ω":
        name = _GREEK[ord(letter) - ord("α")]
        return r"\ensuremath{o}" if name == "o" else rf"\ensuremath{{\{name}}}"
    if letter in _CAPITAL:
        return rf"\ensuremath{{\{_CAPITAL[letter]}}}"
    if letter in _LATIN_CAPITALS:
        return _LATIN_CAPITALS[letter]
    base, *marks = list(unicodedata.normalize("NFD", letter))
    if len(marks) == 1 and marks[0] in _ACCENTS and base.isascii() and base.isalpha():
        return rf"\{_ACCENTS[marks[0]]}{{{base}}}"
    return f"[U+{ord(letter[0]):04X}]"
