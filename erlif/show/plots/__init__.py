"""Figures of finished products: a film or a calibration and axes in, artists out.

A function that draws one panel takes ``ax``, and makes a figure of one journal column without it.
Functions whose names end in ``_figure`` combine panels. matplotlib is used through its objects
alone: no function opens a window or changes a setting of the caller.
"""

from erlif.show.plots.calibration import (
    calibration_figure,
    fixture_profile,
    ratio_against_thickness,
    ratio_residuals,
    write_calibration_figure,
)
from erlif.show.plots.comparison import (
    comparison_figure,
    control_chart_of,
    difference_map_of_runs,
    film_against_duty,
    write_comparison_figures,
)
from erlif.show.plots.design import (
    design_figure,
    design_margins,
    design_margins_figure,
    design_pressure,
    design_pv,
    design_temperature,
    design_wear,
)
from erlif.show.plots.designs import designs_figure, loads_of_designs, write_designs_figure
from erlif.show.plots.edges import (
    axial_pressure,
    contact_pressure_map,
    joint_figure,
    stress_section,
    undercut_pressure,
)
from erlif.show.plots.endurance import (
    endurance_figure,
    failure_figure,
    friction_over_test,
    load_profile,
    name_figures,
    name_overviews,
    temperature_over_test,
    torque_over_test,
    vibration_over_test,
    write_endurance_figures,
)
from erlif.show.plots.example import (
    example_calibration,
    example_film,
    example_frames,
    example_images,
    example_pressure,
    example_registration,
    write_example,
)
from erlif.show.plots.files import find_fixture, find_run, missing_figures, write_figures
from erlif.show.plots.frames import band_images, band_images_figure, ratio_image
from erlif.show.plots.friction import friction_over_reversals, write_reversal_figure
from erlif.show.plots.kinematics import (
    cycle_figure,
    film_over_cycle,
    speed_against_angle,
    speed_over_cycle,
)
from erlif.show.plots.linkage import (
    example_linkage,
    linkage_figure,
    linkage_movie,
    linkage_positions,
    linkage_view,
    rocker_over_crank,
    transmission_over_crank,
    write_linkage,
)
from erlif.show.plots.maps import (
    map_sheet_figure,
    profile_residual,
    sliding_profile,
    thickness_figure,
    thickness_map,
)
from erlif.show.plots.mechanism import draw_mechanism
from erlif.show.plots.movie import cycle_movie, cycle_view
from erlif.show.plots.orbit import closest_film, gap_curvature, pin_figure, pin_orbit
from erlif.show.plots.plan import (
    example_plan_results,
    plan_figure,
    plan_precision,
    plan_ratio,
    plan_signal,
)
from erlif.show.plots.prediction import (
    film_and_prediction,
    film_over_run,
    predicted_map,
    prediction_figure,
    prediction_map_figure,
)
from erlif.show.plots.pressure import (
    load_balance,
    pressure_figure,
    pressure_map,
    pressure_profile,
    write_pressure_figure,
)
from erlif.show.plots.registration import displacement_map, drift_of_frames, registration_figure
from erlif.show.plots.slider import extrapolation_error, joint_force, joint_wear
from erlif.show.plots.style import save_figure
from erlif.show.plots.trend import film_against_speed, film_and_theory, speed_figure

__all__ = [
    "axial_pressure",
    "band_images",
    "band_images_figure",
    "calibration_figure",
    "closest_film",
    "comparison_figure",
    "contact_pressure_map",
    "control_chart_of",
    "cycle_figure",
    "cycle_movie",
    "cycle_view",
    "design_figure",
    "design_margins",
    "design_margins_figure",
    "design_pressure",
    "design_pv",
    "design_temperature",
    "design_wear",
    "designs_figure",
    "difference_map_of_runs",
    "displacement_map",
    "draw_mechanism",
    "drift_of_frames",
    "endurance_figure",
    "example_calibration",
    "example_film",
    "example_frames",
    "example_images",
    "example_linkage",
    "example_plan_results",
    "example_pressure",
    "example_registration",
    "extrapolation_error",
    "failure_figure",
    "film_against_duty",
    "film_against_speed",
    "film_and_prediction",
    "film_and_theory",
    "film_over_cycle",
    "film_over_run",
    "find_fixture",
    "find_run",
    "fixture_profile",
    "friction_over_reversals",
    "friction_over_test",
    "gap_curvature",
    "joint_figure",
    "joint_force",
    "joint_wear",
    "linkage_figure",
    "linkage_movie",
    "linkage_positions",
    "linkage_view",
    "load_balance",
    "load_profile",
    "loads_of_designs",
    "map_sheet_figure",
    "missing_figures",
    "name_figures",
    "name_overviews",
    "pin_figure",
    "pin_orbit",
    "plan_figure",
    "plan_precision",
    "plan_ratio",
    "plan_signal",
    "predicted_map",
    "prediction_figure",
    "prediction_map_figure",
    "pressure_figure",
    "pressure_map",
    "pressure_profile",
    "profile_residual",
    "ratio_against_thickness",
    "ratio_image",
    "ratio_residuals",
    "registration_figure",
    "rocker_over_crank",
    "save_figure",
    "sliding_profile",
    "speed_against_angle",
    "speed_figure",
    "speed_over_cycle",
    "stress_section",
    "temperature_over_test",
    "thickness_figure",
    "thickness_map",
    "torque_over_test",
    "transmission_over_crank",
    "undercut_pressure",
    "vibration_over_test",
    "write_calibration_figure",
    "write_comparison_figures",
    "write_designs_figure",
    "write_endurance_figures",
    "write_example",
    "write_figures",
    "write_linkage",
    "write_pressure_figure",
    "write_reversal_figure",
]
