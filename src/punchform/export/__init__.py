"""Results as files: one format, one file of code."""
