"""The benchmark: tasks of fixed name and version, results in files, table and chart."""
