"""The slider-crank of Mukras et al. (2008) in Exudyn: ``python benchmarks/slider_crank_exudyn.py``.

Exudyn assembles bodies, joints and loads in redundant coordinates with Lagrange
multipliers and integrates them by the generalised alpha method, while erlif uses the fewest
coordinates. The script writes tests/reference/slider_crank_exudyn.csv, to which the tests hold
`erlif.joint.models.slider_dynamics`. It needs the package ``exudyn`` (1.13.6 was used), which is no
dependency of erlif. A run takes half a minute.
"""

import csv
import math
from pathlib import Path

import exudyn
import exudyn.itemInterface
import numpy as np

items = exudyn.itemInterface

CRANK, ROD = 0.0762, 0.2032  # m
CRANK_MASS, CRANK_INERTIA = 0.4045, 204e-6  # kg, kg m2 about the centre of mass
ROD_MASS, ROD_INERTIA, SLIDER_MASS = 0.8175, 5500e-6, 5.5487
STIFFNESS, PRELOAD = 525.4, 20.0  # N/m, N

CLEARANCE, CONTACT = 2e-4, 1e7  # m, N/m^1.5; elastic contact
START, SPEED, DURATION = 0.3, 20.0, 0.12  # rad, rad/s, s
ROWS = 25

TARGET = Path(__file__).parents[1] / "tests" / "reference" / "slider_crank_exudyn.csv"


def torque(time: float) -> float:
    """Torque on the crank. [N m]"""
    return 2.0 * math.cos(30.0 * time)


def contact_force(_mbs, _time, _item, apart, _rates, _k, _d, _offset):
    """Force on the pin side of an elastic contact, by the vector from bushing to pin."""
    reach = math.hypot(apart[0], apart[1])
    if reach <= CLEARANCE:
        return [0.0, 0.0, 0.0]
    size = CONTACT * (reach - CLEARANCE) ** 1.5
    return [size * apart[0] / reach, size * apart[1] / reach, 0.0]


def simulate(general: bool, steps: int) -> np.ndarray:
    """Crank angle, speed, slider position and joint force at `ROWS` times."""
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(items.ObjectGround())
    phi = math.asin(-CRANK * math.sin(START) / ROD)
    phi_rate = -SPEED * CRANK * math.cos(START) / (ROD * math.cos(phi))
    pin = CRANK * np.array([math.cos(START), math.sin(START)])
    pin_speed = SPEED * CRANK * np.array([-math.sin(START), math.cos(START)])

    # a body starts at its initial coordinates, counted from those of the outer dead centre
    def body(mass, inertia, reference, place, rate):
        node = system.AddNode(
            items.NodeRigidBody2D(
                referenceCoordinates=reference,
                initialCoordinates=list(np.subtract(place, reference)),
                initialVelocities=list(rate),
            )
        )
        return node, system.AddObject(
            items.ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=node)
        )

    crank_node, crank = body(
        CRANK_MASS,
        CRANK_INERTIA,
        [CRANK / 2, 0, 0],
        [*(pin / 2), START],
        [*(pin_speed / 2), SPEED],
    )
    along = np.array([math.cos(phi), math.sin(phi)])
    across = np.array([-math.sin(phi), math.cos(phi)])
    eccentricity = CLEARANCE * np.array([-0.5, 0.0]) if general else np.zeros(2)
    bushing = pin - eccentricity
    if general:  # the bushing lies on the line that keeps the slider on its own
        phi = math.asin(-bushing[1] / ROD)
        along = np.array([math.cos(phi), math.sin(phi)])
        across = np.array([-math.sin(phi), math.cos(phi)])
        phi_rate = -pin_speed[1] / (ROD * math.cos(phi))
        for _ in range(50):  # the eccentricity turns with the rod
            turned = phi_rate * np.array([-eccentricity[1], eccentricity[0]])
            phi_rate = -(pin_speed[1] - turned[1]) / (ROD * math.cos(phi))
        bushing_speed = pin_speed - phi_rate * np.array([-eccentricity[1], eccentricity[0]])
    else:
        bushing_speed = pin_speed
    centre = bushing + ROD / 2 * along
    centre_speed = bushing_speed + ROD / 2 * phi_rate * across
    _, rod = body(
        ROD_MASS,
        ROD_INERTIA,
        [CRANK + ROD / 2, 0, 0],
        [*centre, phi],
        [*centre_speed, phi_rate],
    )
    slider = bushing + ROD * along
    slider_speed = bushing_speed + ROD * phi_rate * across
    slider_node = system.AddNode(
        items.NodePoint2D(
            referenceCoordinates=[CRANK + ROD, 0],
            initialCoordinates=[slider[0] - CRANK - ROD, 0],
            initialVelocities=[slider_speed[0], 0],
        )
    )
    block = system.AddObject(items.ObjectMassPoint2D(mass=SLIDER_MASS, nodeNumber=slider_node))

    def marker(number, x):
        return system.AddMarker(
            items.MarkerBodyPosition(bodyNumber=number, localPosition=[x, 0, 0])
        )

    on_rod, on_crank = marker(rod, -ROD / 2), marker(crank, CRANK / 2)
    system.AddObject(
        items.ObjectJointRevolute2D(markerNumbers=[marker(ground, 0), marker(crank, -CRANK / 2)])
    )
    system.AddObject(
        items.ObjectJointRevolute2D(markerNumbers=[marker(rod, ROD / 2), marker(block, 0)])
    )
    if general:
        joint = system.AddObject(
            items.ObjectConnectorCartesianSpringDamper(
                markerNumbers=[on_rod, on_crank], springForceUserFunction=contact_force
            )
        )
    else:
        joint = system.AddObject(items.ObjectJointRevolute2D(markerNumbers=[on_rod, on_crank]))

    # the slider stays on its line; spring and preload act along it
    fixed = system.AddNode(items.NodePointGround())
    zero = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=fixed, coordinate=0))
    line = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=slider_node, coordinate=0))
    side = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=slider_node, coordinate=1))
    system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[zero, side]))
    system.AddObject(
        items.ObjectConnectorCoordinateSpringDamper(markerNumbers=[zero, line], stiffness=STIFFNESS)
    )
    system.AddLoad(items.LoadCoordinate(markerNumber=line, load=PRELOAD))
    system.AddLoad(
        items.LoadTorqueVector(
            markerNumber=system.AddMarker(items.MarkerBodyRigid(bodyNumber=crank)),
            loadVector=[0, 0, 1],
            loadVectorUserFunction=lambda _mbs, time, _load: [0, 0, torque(time)],
        )
    )
    kinds = exudyn.OutputVariableType
    sensors = [
        system.AddSensor(
            items.SensorNode(
                nodeNumber=crank_node, outputVariableType=kinds.Coordinates, storeInternal=True
            )
        ),
        system.AddSensor(
            items.SensorNode(
                nodeNumber=crank_node, outputVariableType=kinds.Coordinates_t, storeInternal=True
            )
        ),
        system.AddSensor(
            items.SensorNode(
                nodeNumber=slider_node, outputVariableType=kinds.Position, storeInternal=True
            )
        ),
        system.AddSensor(
            items.SensorObject(
                objectNumber=joint, outputVariableType=kinds.Force, storeInternal=True
            )
        ),
    ]
    system.Assemble()

    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = DURATION
    settings.timeIntegration.newton.relativeTolerance = 1e-10
    settings.timeIntegration.newton.absoluteTolerance = 1e-10
    settings.timeIntegration.generalizedAlpha.spectralRadius = 1.0 if general else 0.9
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = DURATION / (ROWS - 1)
    settings.timeIntegration.verboseMode = 0
    system.SolveDynamic(settings)

    angle, rate, place, force = (system.GetSensorStoredData(sensor) for sensor in sensors)
    size = np.hypot(force[:, 1], force[:, 2])
    return np.stack([angle[:, 0], angle[:, 3], rate[:, 3], place[:, 1], size], axis=1)


def main() -> None:
    """Write the rows of both joints, extrapolated from two step lengths."""
    with TARGET.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["joint", "time", "crank_angle", "crank_speed", "slider_position", "force"])
        for joint, steps in (("perfect", 24_000), ("general", 192_000)):
            coarse = simulate(joint == "general", steps // 2)
            fine = simulate(joint == "general", steps)
            print(joint, "change by halving:", np.abs(fine - coarse).max(axis=0))
            limit = fine + (fine - coarse) / 3  # the method is of second order
            for row in limit:
                writer.writerow([joint, *(f"{value:.10g}" for value in row)])


if __name__ == "__main__":
    main()
