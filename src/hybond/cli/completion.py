"""``hybond completion``: what a shell has to know to complete verbs, options and model files."""

from __future__ import annotations

import shlex
from argparse import ArgumentParser, Namespace, _SubParsersAction
from collections.abc import Mapping

from hybond.cli.streams import say
from hybond.errors import UsageError
from hybond.names import did_you_mean

SHELLS = ("bash", "zsh", "fish")

_BASH = """# hybond completion bash > ~/.local/share/bash-completion/completions/hybond
_hybond() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} options=""
    if [ "$COMP_CWORD" -eq 1 ]; then
        COMPREPLY=($(compgen -W "{verbs} --help --version" -- "$word"))
        return
    fi
    case ${{COMP_WORDS[1]}} in
{cases}
    esac
    case $word in
        -*) COMPREPLY=($(compgen -W "$options" -- "$word")) ;;
        *) COMPREPLY=($(compgen -f -- "$word")) ;;
    esac
}}
complete -o filenames -F _hybond hybond
"""

_ZSH = """#compdef hybond
# hybond completion zsh > "${{fpath[1]}}/_hybond"
_hybond() {{
    local -a verbs options
    verbs=(
{verbs}
    )
    if (( CURRENT == 2 )); then
        _describe verb verbs
        return
    fi
    case $words[2] in
{cases}
    esac
    if [[ $PREFIX == -* ]]; then
        compadd -- $options
    else
        _files
    fi
}}
if [ "$funcstack[1]" = "_hybond" ]; then
    _hybond "$@"
else
    compdef _hybond hybond
fi
"""

_FISH = "# hybond completion fish > ~/.config/fish/completions/hybond.fish\n"


def completion(given: Namespace, parser: ArgumentParser) -> int:
    """Print the script of a shell."""
    if given.shell not in SHELLS:
        raise UsageError(
            f"no completion for {given.shell!r}",
            code="HB-X101",
            where="hybond completion",
            hint=did_you_mean(given.shell, SHELLS),
        )
    say(script(given.shell, parser).rstrip("\n"))
    return 0


def script(shell: str, parser: ArgumentParser) -> str:
    """Return the script of a shell, made of the options that the verbs have.

    Examples
    --------
    >>> from argparse import ArgumentParser
    >>> parser = ArgumentParser()
    >>> _ = parser.add_subparsers().add_parser("run", help="simulate").add_argument("--until")
    >>> print(script("fish", parser).splitlines()[-1])
    complete -c hybond -n '__fish_seen_subcommand_from run' -l until
    """
    verbs, options = _words(parser)
    if shell == "bash":
        cases = "\n".join(
            f'        {verb}) options="{" ".join(words)}" ;;' for verb, words in options.items()
        )
        return _BASH.format(verbs=" ".join(verbs), cases=cases)
    if shell == "zsh":
        lines = "\n".join(f"        {shlex.quote(f'{v}:{text}')}" for v, text in verbs.items())
        cases = "\n".join(
            f"        {verb}) options=({' '.join(words)}) ;;" for verb, words in options.items()
        )
        return _ZSH.format(verbs=lines, cases=cases)
    lines_ = [
        f"complete -c hybond -n __fish_use_subcommand -f -a {verb} -d {shlex.quote(text)}"
        for verb, text in verbs.items()
    ]
    for verb, words in options.items():
        seen = f"complete -c hybond -n '__fish_seen_subcommand_from {verb}'"
        lines_ += [f"{seen} -l {word[2:]}" for word in words if word != "--help"]
    return _FISH + "\n".join(lines_) + "\n"


def _words(parser: ArgumentParser) -> tuple[Mapping[str, str], Mapping[str, list[str]]]:
    """Return what each verb does, and its options."""
    action = next(a for a in parser._actions if isinstance(a, _SubParsersAction))
    verbs = {a.dest: (a.help or "") for a in action._choices_actions}
    options = {
        verb: sorted(o for o in own._option_string_actions if o.startswith("--"))
        for verb, own in action.choices.items()
    }
    return verbs, options
