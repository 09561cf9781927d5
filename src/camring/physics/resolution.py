"""How finely a cycle is looked at: counts that shape arrays, and how far these are filled."""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Resolution:
    """Mesh and spectrum sizes.

    `elements` counts collocation elements between the breakpoints of a lobe
    pitch, beside the one that each breakpoint brings; behind manifolds there are
    twice as many. The default's measured errors stand in docs/notes/verification.md;
    `simulate` reports an estimate with every result. Counts shape arrays: another one
    is another program to compile.

    Examples
    --------
    >>> camring.Resolution()
    Resolution(elements=320, refinements=3, harmonics=600, filled=1.0)
    >>> camring.Resolution.fine().elements
    500
    """

    elements: int = 320
    refinements: int = 3
    harmonics: int = 600
    filled: float = 1.0
    """Share of the elements that divide a lobe pitch; the others have no width."""

    @classmethod
    def coarse(cls) -> "Resolution":
        """For searching: objective terms to about 1e-4."""
        return cls(elements=160, refinements=2)

    @classmethod
    def fine(cls) -> "Resolution":
        """For validation: every result to about 1e-7."""
        return cls(elements=500)

    @classmethod
    def ladder(cls) -> tuple["Resolution", ...]:
        """What `simulate_to` tries in turn; each doubles the elements."""
        return cls(), cls(elements=640), cls(elements=1280)

    def behind_manifolds(self) -> "Resolution":
        """Twice the elements, unless it is for searching.

        Flow turns round in open windows there, where the root bends; the power balance
        closes to 1e-9 with these, to 1e-8 with half of them.
        """
        if self.elements < Resolution.elements:
            return self
        return replace(self, elements=2 * self.elements)

    def second_solution(self, share: float = 0.7) -> "Resolution":
        """A coarser mesh that an error estimate compares with.

        Seven tenths of the elements: at order four its error is four times as
        large. Half of them can be too few for the layers of a slow motor, and then
        the difference says nothing about the finer mesh. The others are left without
        width, so that all resolutions are one program.
        """
        return replace(self, filled=share * self.filled)
