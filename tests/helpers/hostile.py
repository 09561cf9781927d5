"""Names that a stranger may write into a motor file, or give to the file itself."""

import csv
import io
import re
import unicodedata

# What a motor may be called: one line of signs that can be printed.
NAME = (
    '</title><script>alert(1)</script>[red]x[/nope] %%c,=HYPERLINK("http://e.example";"x");'
    "@SUM(1+1)*cmd|' /C calc'!A0\\"
)
# What a file may be called on this disk: anything without a slash.
FILE_NAME = "=1+1 mo\x1b[2J\x1b]0;title\x07tor\u202etml [bold]<i>'\"&\n--.toml"
_NUMBER = re.compile(r"[+-]?[\d.,]+([eE][+-]?\d+)?( .*)?")


def leads_a_terminal(text):
    """Signs in a text that a terminal would obey or not show."""
    return {
        each
        for each in text
        if not each.isprintable() and each != "\n" and unicodedata.category(each) != "Zs"
    }


def formulae(text):
    """Cells of a CSV file that a spreadsheet computes, whatever it takes for its separator."""
    cells = [
        cell.strip(" \"'" if cell.startswith('"') else ' "')
        for separator in ",;\t"
        for row in csv.reader(io.StringIO(text), delimiter=separator)
        for cell in row
    ]
    return [
        cell
        for cell in cells
        if cell[:1] in tuple("=+-@") and len(cell) > 1 and not _NUMBER.fullmatch(cell)
    ]
