"""Closed surfaces, handles and constraints: from triangles to the seamless map."""
import pytest
from maps import expect_valid_map, mapped
from shapes import CLOSED


@pytest.mark.parametrize("name", CLOSED)
def test_it_is_mapped(name, table):
    mesh, options = CLOSED[name]
    result = mapped(name, mesh, options, table)
    for item in result.regions:
        expect_valid_map(item)
