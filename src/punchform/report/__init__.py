"""The report of a run: figures and one page that opens offline. Call `punchform.report.page.write_report`."""
