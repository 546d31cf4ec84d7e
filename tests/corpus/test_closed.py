"""Closed surfaces, handles and constraints: from triangles to quads."""
from collections import Counter

import pytest
from maps import expect_valid_map, mapped
from shapes import CLOSED


@pytest.mark.parametrize("name", CLOSED)
def test_it_is_mapped_and_gets_its_quads(name, table):
    mesh, options = CLOSED[name]
    result = mapped(name, mesh, options, table)
    for item in result.regions:
        expect_valid_map(item)
        assert item.error is None, str(item.error)
        assert item.quads.euler == item.region.euler
        if item.region.boundary_loops == 0:
            assert item.polygons.trimmed == []
            valence = Counter(v for quad in item.polygons.full for v in quad)
            assert sum(4 - n for n in valence.values()) == 4 * item.region.euler
