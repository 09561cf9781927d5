"""Shapes that come as points, drawings or angles: rings of others, relief grooves."""
