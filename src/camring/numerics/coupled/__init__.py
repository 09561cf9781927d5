"""Many orbits that share a state, such as all pistons behind one manifold."""
