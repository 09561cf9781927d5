"""Cells of tables that benches and spreadsheets wrote: separators, signs, workbooks."""
