"""Surfaces with a boundary that need no irregular vertex: from triangles to quads."""
import pytest
from maps import expect_valid_map, mapped
from shapes import OPEN


@pytest.mark.parametrize("name", OPEN)
def test_it_is_mapped_and_gets_its_quads(name, table):
    mesh, options = OPEN[name]
    result = mapped(name, mesh, options, table)
    for item in result.regions:
        expect_valid_map(item)
        assert item.error is None, str(item.error)
        assert item.quads.statistics["quads"] > 0
