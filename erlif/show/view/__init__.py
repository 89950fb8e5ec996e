"""The viewer in the browser: maps, profiles and statistics of films of any length."""

from erlif.show.view.films import FilmReader, open_films
from erlif.show.view.levels import reduce_map
from erlif.show.view.serving import serve_films

__all__ = ["FilmReader", "open_films", "reduce_map", "serve_films"]
