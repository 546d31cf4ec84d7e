import os
import sys

import pytest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [os.path.join(ROOT, "TrimQuadWorkbench"), os.path.dirname(__file__)]

ROWS = []


@pytest.fixture
def table():
    """Add a row (name, outcome, numbers) to the table that ends the run."""
    return ROWS.append


def pytest_terminal_summary(terminalreporter):
    if not ROWS:
        return
    terminalreporter.write_line("")
    terminalreporter.write_line(f"{'shape':28s} {'triangles':>9s} {'singular':>8s} {'aligned':>7s} {'field s':>8s} "
                                f"{'map s':>7s}  how the map was found, or what failed")
    for row in ROWS:
        terminalreporter.write_line("{:28s} {:9d} {:8d} {:7d} {:8.2f} {:7.2f}  {}".format(*row))
