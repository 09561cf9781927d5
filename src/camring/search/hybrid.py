"""One strategy after another, each with a budget of its own."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from camring.search.problem import AbstractStrategy, Evaluation, Memory, Proposal, Stop


@dataclass(frozen=True)
class Stage:
    """A strategy, and how many evaluations it may ask for; None is as many as it likes."""

    strategy: AbstractStrategy
    budget: int | None = None


@dataclass(frozen=True)
class Hybrid(AbstractStrategy):
    """Goes to the next stage when the present one stops or has spent its budget.

    Every stage sees the whole history and a memory of its own, which begins
    empty and is kept after the stage has ended.
    """

    stages: tuple[Stage, ...]

    def propose(self, history: Sequence[Evaluation], memory: Memory, seed: int) -> Proposal | Stop:
        """The next point of the stage whose turn it is."""
        begun: int = memory.get("begun", len(history))
        notes: list[str] = list(memory.get("notes", ()))
        memories: list[Memory] = list(memory.get("memories", [{}]))
        while len(memories) <= len(self.stages):
            place = len(memories) - 1
            stage = self.stages[place]
            if stage.budget is not None and len(history) - begun >= stage.budget:
                notes.append(f"Stage {place + 1} spent its budget of {stage.budget} evaluations.")
            else:
                answer = stage.strategy.propose(history, memories[place], seed)
                if isinstance(answer, Proposal):
                    memories[place] = answer.memory
                    kept = {"begun": begun, "notes": notes, "memories": memories}
                    return Proposal(answer.point, answer.phase, kept)
                notes.append(answer.reason)
            begun = len(history)
            memories.append({})
        return Stop(" ".join(notes) or "There is no stage.")

    def ahead(self, trial: int, memory: Memory) -> list[Float[np.ndarray, " dimension"]]:
        """Of the stage whose turn it is, as far as its budget goes."""
        memories: list[Memory] = memory.get("memories", [])
        if not 0 < len(memories) <= len(self.stages):
            return []
        stage = self.stages[len(memories) - 1]
        left = None if stage.budget is None else max(0, memory["begun"] + stage.budget - trial)
        return stage.strategy.ahead(trial, memories[-1])[:left]
