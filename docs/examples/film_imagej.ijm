// A film in ImageJ or Fiji:  erlif export film.nc --to tiff
// Run with Plugins > Macros > Run, or: fiji --headless -macro film_imagej.ijm film.tif
path = getArgument();
if (path == "") path = File.openDialog("film.tif of erlif export");
open(path);
title = getTitle();
getDimensions(width, height, channels, slices, frames);
getPixelSize(unit, across, down);
print(title + ": " + frames + " triggers, pixels of " + across + " " + unit);

// channel 1 thickness, 2 and 3 its standard deviations, 4 flags; frame k + 1 is trigger k
for (k = 1; k <= frames; k++) {
  Stack.setPosition(1, 1, k);
  valid = 0;
  sum = 0;
  for (y = 0; y < height; y++) {
    for (x = 0; x < width; x++) {
      film = getPixel(x, y);
      if (!isNaN(film)) {
        valid++;
        sum += film;
      }
    }
  }
  print("trigger " + (k - 1) + ": " + d2s(100 * valid / (width * height), 1) + " % valid, mean " + d2s(sum / valid, 3) + " um");
}
Stack.setPosition(1, 1, 1);
run("mpl-viridis");
run("Calibration Bar...", "location=[Upper Right] fill=White label=Black number=5 decimal=1 font=12 zoom=1 overlay");
