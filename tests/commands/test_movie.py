"""``erlif movie``."""


def test_the_movie_lies_beside_the_film(command, own):
    result = command("movie", own, "--fps", "5")
    movie = own.parent / "cycle.gif"
    assert result.stdout == f"written: {movie}\n"
    assert movie.read_bytes()[:6] == b"GIF89a"
