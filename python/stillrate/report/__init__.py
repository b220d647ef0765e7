"""A page that shows what a filter did: one HTML file, no network, zoomable to the sample."""

from stillrate.report.page import write_page

__all__ = ["write_page"]
