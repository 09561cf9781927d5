"""Several counts of pistons and lobes in one study: derived motors, searches, a ranking."""
