"""Trust, measured: kills, Ctrl-C, hostile and accepted files, in counts that no check has time for.

The short versions are `tests/trust`; what was found stands in docs/trust.md.
"""
