"""LLVM's text, instruction by instruction; each result has a name of its own."""


class Instructions:
    """The body of one function as it grows."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.reserved: list[str] = []
        """What stands at the function's beginning."""
        self.declared: set[str] = set()
        """Functions that are called."""
        self._count = 0

    def name(self, prefix: str = "v") -> str:
        """One that nothing else has."""
        self._count += 1
        return f"{prefix}{self._count}"

    def new(self, text: str) -> str:
        """An instruction with a result; the result's name."""
        name = f"%{self.name()}"
        self.lines.append(f"  {name} = {text}")
        return name

    def do(self, text: str) -> None:
        """An instruction without one."""
        self.lines.append(f"  {text}")

    def label(self, name: str) -> None:
        self.lines.append(f"{name}:")

    def reserve(self, kind: str) -> str:
        """Room for a variable of some type."""
        name = f"%{self.name('slot')}"
        self.reserved.append(f"  {name} = alloca {kind}")
        return name

    def call(self, name: str, result: str, *arguments: tuple[str, str], flags: str = "") -> str:
        """One of LLVM's own functions of some (type, value) pairs."""
        types = ", ".join(kind for kind, _ in arguments)
        self.declared.add(f"declare {result} {name}({types})")
        given = ", ".join(f"{kind} {value}" for kind, value in arguments)
        return self.new(f"call {flags} {result} {name}({given})")
