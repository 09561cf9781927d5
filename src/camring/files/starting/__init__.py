"""Motor files to begin with: from a small library, or from a catalogue's data."""
