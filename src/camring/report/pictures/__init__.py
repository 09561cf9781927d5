"""The report's pictures, one file for each thing that is looked at."""
