"""A layout: so many pistons on so many lobes, and what follows from the counts alone."""

from dataclasses import dataclass
from math import gcd, lcm

from camring.files.errors import InputError, quote

FEWEST, MOST = 2, 60
MOST_LAYOUTS = 60


@dataclass(frozen=True, order=True)
class Layout:
    """Counts of pistons and of lobes."""

    pistons: int
    lobes: int

    def __str__(self) -> str:
        return f"{self.pistons}x{self.lobes}"

    @property
    def words(self) -> str:
        return f"{self.pistons} pistons on {self.lobes} lobes"

    @property
    def surviving_order(self) -> int:
        """Torque of identical lobes and pistons holds multiples of this order only."""
        return lcm(self.pistons, self.lobes)

    @property
    def phases(self) -> int:
        """Distinct piston phases, `Np / gcd(Np, NL)`."""
        return self.pistons // gcd(self.pistons, self.lobes)

    @property
    def balanced(self) -> bool:
        """Whether the radial load on the shaft vanishes: pistons push in opposed sets."""
        return gcd(self.pistons, self.lobes) > 1


def layouts_of(pistons: str, lobes: str) -> list[Layout]:
    """Every combination of counts such as `5,7..9`.

    Raises
    ------
    InputError
        For text that is no list of counts, and for more layouts than anyone waits for.
    """
    found = [
        Layout(each, other)
        for each in _counts("--pistons", pistons)
        for other in _counts("--lobes", lobes)
    ]
    if len(found) > MOST_LAYOUTS:
        raise InputError(
            "--pistons and --lobes",
            f"make {len(found)} layouts, more than the {MOST_LAYOUTS} of one study",
            "leave some counts out",
        )
    return found


def _counts(option: str, text: str) -> list[int]:
    found = list[int]()
    for part in text.split(","):
        low, dots, high = part.strip().partition("..")
        try:
            ends = int(low), int(high if dots else low)
        except ValueError:
            raise InputError(
                option, f"is {quote(text)} but must be whole numbers", "write 5,7,8 or 5..9"
            ) from None
        if not FEWEST <= ends[0] <= ends[1] <= MOST:
            raise InputError(
                option,
                f"has {part.strip()}, but counts lie between {FEWEST} and {MOST} and ascend",
                "write 5,7,8 or 5..9",
            )
        found += range(ends[0], ends[1] + 1)
    return sorted(set(found))
