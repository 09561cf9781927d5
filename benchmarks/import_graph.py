"""How the program's files import each other: levels, cycles, the largest folder.

    python benchmarks/import_graph.py                       # of this checkout
    python benchmarks/import_graph.py SOURCE/camring        # of any other source tree

Imports inside functions count like all others; those for type checkers alone do not, and
neither does a file's own package, which Python imports with it. Standard library only.
"""

import ast
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

Graph = Mapping[str, set[str]]


def name_of(path: Path, root: Path) -> str:
    parts = path.relative_to(root.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def statements(node: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """Imports of a file, wherever they stand but below `if TYPE_CHECKING`."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            continue
        if isinstance(child, ast.Import | ast.ImportFrom):
            yield child
        yield from statements(child)


def graph_of(root: Path) -> dict[str, set[str]]:
    """The files that each file imports."""
    paths = {name_of(path, root): path for path in sorted(root.rglob("*.py"))}
    graph: dict[str, set[str]] = {}
    for name, path in paths.items():
        found = set()
        for each in statements(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(each, ast.Import):
                found |= {alias.name for alias in each.names}
                continue
            for alias in each.names:
                within = f"{each.module}.{alias.name}"
                found.add(within if within in paths else each.module or "")
        graph[name] = {other for other in found if other in paths and other != name}
    return graph


def of_packages(graph: Graph) -> dict[str, set[str]]:
    """The same between packages, the folders right below the root."""
    found: dict[str, set[str]] = {}
    for name, others in graph.items():
        here = package(name)
        found.setdefault(here, set()).update(package(each) for each in others)
    return {name: {each for each in others if each != name} for name, others in found.items()}


def package(name: str) -> str:
    return ".".join(name.split(".")[:2])


def components(graph: Graph) -> list[set[str]]:
    """Sets of files that all reach each other, importers after what they import (Tarjan 1972)."""
    order: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[set[str]] = []

    def visit(name: str) -> None:
        order[name] = low[name] = len(order)
        stack.append(name)
        for other in sorted(graph[name]):
            if other not in order:
                visit(other)
                low[name] = min(low[name], low[other])
            elif other in stack:
                low[name] = min(low[name], order[other])
        if low[name] == order[name]:
            found.append(set())
            while name not in found[-1]:
                found[-1].add(stack.pop())

    for name in sorted(graph):
        if name not in order:
            visit(name)
    return found


def levels(graph: Graph) -> int:
    """Files on the longest way down, a cycle taken as one."""
    level: dict[str, int] = {}
    deepest = 0
    for group in components(graph):
        below = [level[each] for name in group for each in graph[name] if each not in group]
        here = 1 + max(below, default=0)
        level |= dict.fromkeys(group, here)
        deepest = max(deepest, here)
    return deepest


def cycles(graph: Graph) -> list[int]:
    return sorted((len(each) for each in components(graph) if len(each) > 1), reverse=True)


def main(root: Path) -> None:
    graph = graph_of(root)
    packages = of_packages(graph)
    folders = Counter(path.parent for path in root.rglob("*.py"))
    largest, count = folders.most_common(1)[0]
    for what, each in (("files", graph), ("packages", packages)):
        arrows = sum(map(len, each.values()))
        sizes = cycles(each)
        said = f"cycles of {', '.join(map(str, sizes))}" if sizes else "no cycle"
        print(f"{len(each)} {what}, {arrows} imports between them, {levels(each)} levels, {said}")
    print(f"{count} files in the largest folder, {largest.relative_to(root.parent)}")


if __name__ == "__main__":
    sys.setrecursionlimit(10_000)
    here = Path(__file__).parent.parent / "src" / "camring"
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else here)
