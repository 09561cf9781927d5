"""What the second road says when it finds no way."""


class OrbitError(RuntimeError):
    """No periodic pressure was found; the message says why."""
