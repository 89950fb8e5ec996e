"""Tables beside the modules that read them."""

from erlif.core.tables import read_table


def test_a_table_is_read_once():
    table = read_table("erlif.io.files", "kinds.toml")
    assert table["film"]["words"] == "a film"
    assert read_table("erlif.io.files", "kinds.toml") is table
