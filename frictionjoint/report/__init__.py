"""The report: report.json, report.html and model.xml in one folder."""
