"""What the second solver says when it finds no way."""


class OrbitError(RuntimeError):
    """No periodic pressure was found; the message says why."""


class NoSecondSolver(NotImplementedError):
    """A law of the motor has not been written a second time; the message names it."""

    def __init__(self, law: object) -> None:
        super().__init__(f"no second solver for {type(law).__name__}")
