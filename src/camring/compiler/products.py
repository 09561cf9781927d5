"""Products of known matrices with rows, and counts of numbers."""

import numpy as np

from camring.compiler.graph import Counted, Product
from camring.compiler.memory import Buffer
from camring.compiler.numbers import WIDTH, element, literal, row
from camring.compiler.rows import LoopOver, Rows, Variable, flat_rows

TILE = 8
"""Rows of a product that are added up side by side, in as many registers."""

NUMBER = np.dtype(float)


def write_product(rows: Rows, node: Product, target: Buffer) -> None:
    """Row by row of the matrix, `TILE` at a time; the last ones may be there twice."""
    code, (count, terms) = rows.code, node.matrix.shape
    rest = node.rows // count
    given = rows.shifted(rows.located(node.given.node), int(node.given.rows.flat[0]))
    tiles = -(-count // TILE)
    # The last tile begins early enough to be a whole one, if there are so many rows.
    begins = np.minimum(np.arange(tiles) * TILE, max(count - TILE, 0))
    wanted = np.minimum(begins[:, None] + np.arange(TILE), count - 1)
    matrix = rows.table(node.matrix[wanted].transpose(0, 2, 1))
    places = rows.table(wanted.astype(np.int64))
    typed = row(NUMBER)
    with LoopOver(code, tiles) as tile, LoopOver(code, rest) as across:
        totals = [Variable(code, NUMBER) for _ in range(TILE)]
        for each in totals:
            each.set(literal(0.0, NUMBER, True))
        first = code.new(f"mul i64 {tile.index}, {terms * TILE}")
        with LoopOver(code, terms) as term:
            at = code.new(f"mul i64 {term.index}, {rest}")
            at = code.new(f"add i64 {at}, {across.index}")
            value = rows.load(given, NUMBER, at)
            column = code.new(f"mul i64 {term.index}, {TILE}")
            column = code.new(f"add i64 {column}, {first}")
            for number, each in enumerate(totals):
                place = code.new(f"add i64 {column}, {number}")
                pointer = code.new(f"getelementptr double, ptr {matrix}, i64 {place}")
                factor = rows.splat(code.new(f"load double, ptr {pointer}"), "double")
                part = code.new(f"fmul contract {typed} {factor}, {value}")
                each.set(code.new(f"fadd contract {typed} {each.get()}, {part}"))
        for number, each in enumerate(totals):
            place = code.new(f"mul i64 {tile.index}, {TILE}")
            place = code.new(f"add i64 {place}, {number}")
            pointer = code.new(f"getelementptr i64, ptr {places}, i64 {place}")
            at = code.new(f"load i64, ptr {pointer}")
            at = code.new(f"mul i64 {at}, {rest}")
            at = code.new(f"add i64 {at}, {across.index}")
            rows.store(each.get(), NUMBER, target, at)


def write_count(rows: Rows, node: Counted, counts: Buffer) -> None:
    """Lane by lane, for each has another place to count at."""
    code, kind, size = rows.code, element(node.dtype), node.dtype.itemsize
    with LoopOver(code, node.rows) as here:
        assert here.index is not None
        rows.store(literal(0, node.dtype, True), node.dtype, counts, here.index)
    numbers = flat_rows(node.given)
    short = element(numbers.dtype)
    with LoopOver(code, numbers.lead[0]) as here:
        value = rows.read(numbers, here)
        for lane in range(WIDTH):
            number = code.new(f"extractelement {row(numbers.dtype)} {value}, i64 {lane}")
            if numbers.dtype.itemsize < 8:
                number = code.new(f"sext {short} {number} to i64")
            offset = code.new(f"mul i64 {number}, {counts.stride}")
            offset = code.new(f"add i64 {offset}, {lane * size}")
            pointer = code.new(f"getelementptr i8, ptr {counts.pointer}, i64 {offset}")
            before = code.new(f"load {kind}, ptr {pointer}")
            code.do(f"store {kind} {code.new(f'add {kind} {before}, 1')}, ptr {pointer}")
