"""The film on the surface of the pin, as a picture or an animation of the cycle.

erlif export film.nc --to vtk
pvpython film_paraview.py film_vtk/film.pvd film.png     (one trigger)
pvpython film_paraview.py film_vtk/film.pvd film.avi     (all triggers)
"""

import sys

from paraview import simple

source, output = sys.argv[1:3]
film = simple.PVDReader(FileName=source)
simple.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()

# pixels without a thickness have flags; they are left out
valid = simple.Threshold(Input=film, Scalars=["POINTS", "flags"])
valid.LowerThreshold, valid.UpperThreshold = 0, 0

view = simple.GetActiveViewOrCreate("RenderView")
view.ViewSize = [1200, 900]
shown = simple.Show(valid, view)
simple.ColorBy(shown, ("POINTS", "thickness [um]"))
shown.RescaleTransferFunctionToDataRangeOverTime()
shown.SetScalarBarVisibility(view, True)
simple.ResetCamera(view)

if output.endswith((".avi", ".ogv")):
    simple.SaveAnimation(output, view, FrameRate=10)
else:
    simple.SaveScreenshot(output, view)
