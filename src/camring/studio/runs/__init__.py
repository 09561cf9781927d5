"""Commands that run beside the studio, each a process of its own."""
