"""Text of others as a terminal may show it: names of files and motors lead no terminal.

An escape sequence can clear the screen, colour it, or type for the user; a mark that turns
the direction of writing shows `gpj.exe` for `exe.jpg`. Both are shown as what they are, `\\x1b`
and `\\u202e`.
"""

import unicodedata

import typer

_BLANKS = "Zs"  # blanks of other widths, which numbers and French have


def visible(text: object) -> str:
    """The text on one line, each sign that is no letter, mark or blank as its number.

    Examples
    --------
    >>> from camring.files.visible import visible
    >>> print(visible("a\\x1b[2Jb"))
    a\\x1b[2Jb
    """
    given = str(text).encode("utf-8", "backslashreplace").decode()
    if given.isprintable():
        return given
    return "".join(each if _harmless(each) else _number(each) for each in given)


def _harmless(sign: str) -> bool:
    return sign.isprintable() or unicodedata.category(sign) == _BLANKS


def _number(sign: str) -> str:
    return sign.encode("unicode_escape").decode()


def say(sentence: object, *, err: bool = False) -> None:
    """Prints one line; documents, which have several, are printed as they are."""
    typer.echo(visible(sentence), err=err)
