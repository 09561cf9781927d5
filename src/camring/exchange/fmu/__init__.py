"""A motor for other programs' system models: tables of its quasi-steady cycle in C."""
