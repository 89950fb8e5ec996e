"""A map drawn from an array."""

from matplotlib.figure import Figure

from erlif.show.plots import example_film


def test_axes_have_the_long_names_and_units_of_a_film_from_a_file(film):
    import erlif

    with erlif.open_film(film) as opened:
        ax = Figure().subplots()
        opened.thickness.isel(trigger=1).erlif.plot(ax=ax, add_colorbar=False)
        angle = float(opened.encoder_angle[1])
        assert ax.get_title() == f"trigger 1, encoder {angle:.4g}°"
        assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (sliding) [mm]", "y [mm]")
        line = Figure().subplots()
        opened.film_min.plot(x="crank_angle", ax=line)
        assert line.get_xlabel() == "crank angle [degree]"
        assert line.get_ylabel() == "minimum film thickness [um]"


def test_a_style_of_the_caller_wins():
    ax = Figure().subplots()
    example_film().thickness.isel(trigger=0).erlif.plot(ax=ax, yincrease=True, vmax=3.0)
    assert not ax.yaxis_inverted()
