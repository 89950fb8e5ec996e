% A film in MATLAB or GNU Octave:  erlif export film.nc --to mat
film = load('film.mat');               % into a variable, with all that the file holds

if ~exist('trigger', 'var')
  trigger = 13;                        % counts from 0, indices from 1
end
map = film.thickness(:, :, trigger + 1);     % um; rows are y, columns are x
std = film.thickness_std(:, :, trigger + 1);
flags = film.flags(:, :, trigger + 1);
[rows, columns, triggers] = size(film.thickness);
printf_line = @(varargin) fprintf([varargin{1} '\n'], varargin{2:end});
printf_line('%d rows, %d columns, %d triggers', rows, columns, triggers);
printf_line('valid %.2f %%', 100 * mean(flags(:) == 0));

% the thinnest film of the cycle, and its standard deviation
[thinnest, place] = min(film.film_min);
printf_line('thinnest %.3f +- %.3f %s at trigger %d', thinnest, film.film_min_std(place), ...
            film.units.film_min, film.trigger(place));

% the mean of a column of the map, weighted by its noise
use = flags == 0;
weight = double(use) ./ double(std) .^ 2;
weight(~use) = 0;
map(~use) = 0;
profile = sum(weight .* double(map), 1) ./ sum(weight, 1);
printf_line('profile along x: %.3f to %.3f um', min(profile), max(profile));

if ~exist('OCTAVE_VERSION', 'builtin') || ~isempty(getenv('DISPLAY'))
  map(~use) = NaN;
  imagesc(film.x, film.y, map);        % y points down, as in the camera
  axis image; colorbar;
  xlabel('x [mm]'); ylabel('y [mm]');
  title(sprintf('film thickness [um], trigger %d', trigger));
end
