"""camring's searches and others', on the same problems from the same first points.

    python -m benchmarks.search [--problems ...] [--methods ...] [--seeds 15] [--minutes 45]
    python -m benchmarks.search.report
    python -m benchmarks.search.fronts

docs/notes/proof.md reads what they print.
"""
