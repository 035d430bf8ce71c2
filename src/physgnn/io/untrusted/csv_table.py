"""The rows of a table that a person wrote, by the number of their line."""

import csv
import re

from physgnn.errors import InputError

# Of a row; it becomes a folder or a file, on every system.
SAFE_NAME = re.compile(r"[\w][\w .+-]{0,99}(?<![ .])")


def csv_rows(text: str) -> dict[int, list[str]]:
    """Return the cells of every line that has some; blanks around them are left out.

    Parameters
    ----------
    text : str
        CSV: commas, or semicolons or tabs where the header has no comma.

    Returns
    -------
    dict of int to list of str
        Line, from 1, to its cells; the first is the header.
    """
    header = next((line for line in text.splitlines() if line.strip()), "")
    delimiter = next((mark for mark in ",;\t" if mark in header), ",")
    reader = csv.reader(text.splitlines(keepends=True), delimiter=delimiter)
    found = {}
    for row in reader:
        if any(row):
            found[reader.line_num] = [cell.strip() for cell in row]
    return found


def checked_cells(line: int, row: list[str], names: list[str]) -> dict[str, str]:
    """Return what is written under each column of a line; empty cells are left out.

    Raises
    ------
    InputError
        If there are more cells than columns.
    """
    if len(row) > len(names):
        raise InputError(
            f"line {line}: {len(row)} cells under {len(names)} columns: put a cell "
            "that holds a comma in quotation marks"
        )
    return {name: cell for name, cell in zip(names, row, strict=False) if cell}
