"""Where rows lie: working memory given out and taken back while code is written."""

from dataclasses import dataclass

CACHE_LINE = 64


@dataclass(frozen=True)
class Buffer:
    """A node's rows: row `r` lies at `pointer + r * stride` bytes."""

    pointer: str
    stride: str
    alignment: int


@dataclass(frozen=True)
class Span:
    """A piece of working memory, in bytes."""

    first: int
    size: int


class Memory:
    """Spans that nobody needs any more are given out again."""

    def __init__(self) -> None:
        self.size = 0
        self._free: list[Span] = []

    def take(self, size: int) -> Span:
        size = -(-size // CACHE_LINE) * CACHE_LINE
        fitting = [each for each in self._free if size <= each.size <= 2 * size]
        if fitting:
            best = min(fitting, key=lambda each: each.size)
            self._free.remove(best)
            return best
        span = Span(self.size, size)
        self.size += size
        return span

    def give_back(self, spans: list[Span]) -> None:
        self._free.extend(spans)
