"""The report of a run: reads what salbench documents (tables, run.yaml, exports) and draws it. See cli.py."""
