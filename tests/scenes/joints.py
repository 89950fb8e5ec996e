"""Random pin joints, sound and absurd."""

import math
import tomllib
from dataclasses import replace

from erlif.joint.settings import DesignSettings
from erlif.joint.sizing import Joint, Lock, Material, assess_joint, read_materials
from erlif.joint.sizing.design import design, example_joint, example_joint_file

TABLE = list(read_materials().values())


def power(rng, low, high):
    """A number whose logarithm is uniform."""
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def maybe(rng, value, share=0.5):
    return value if rng.random() < share else None


def altered(joint=None, /, **changes):
    """A joint, by default that of the examples; a dict of changes is for a part of it."""
    joint = example_joint() if joint is None else joint
    parts = {
        name: altered(getattr(joint, name), **value) if isinstance(value, dict) else value
        for name, value in changes.items()
    }
    return replace(joint, **parts)


def assessed(joint=None, /, **changes):
    """All steps of such a joint."""
    return assess_joint(altered(joint, **changes))


def designed(*changes):
    """Design of the example file with pieces of its text replaced."""
    text = example_joint_file()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return design(DesignSettings.model_validate(tomllib.loads(text)))


def designed_without_motion():
    text = example_joint_file()
    return designed((text[text.index("[motion]") : text.index("[life]")], ""))


def random_material(rng):
    """A material of the table, sometimes without some of its values, sometimes invented."""
    if rng.random() < 0.3:
        low = power(rng, 5, 900)
        return Material(
            "invented",
            yield_stress=maybe(rng, power(rng, 1e6, 2e9), 0.8),
            ultimate_stress=maybe(rng, power(rng, 1e6, 2e9), 0.8),
            hardness_low=maybe(rng, low, 0.7),
            hardness_high=low * rng.uniform(1, 1.5),
            youngs_modulus=maybe(rng, power(rng, 1e8, 4e11), 0.9),
            poissons_ratio=maybe(rng, rng.uniform(0, 0.5), 0.9),
            expansion=maybe(rng, rng.uniform(0, 2e-4), 0.9),
            conductivity=maybe(rng, power(rng, 0.1, 400), 0.9),
            temperature=maybe(rng, rng.uniform(0, 300)),
            pressure=maybe(rng, power(rng, 1e5, 5e8)),
            speed=maybe(rng, power(rng, 1e-3, 10)),
            pv=maybe(rng, power(rng, 1e3, 1e8)),
            wear=maybe(rng, power(rng, 1e-18, 1e-12)),
        )
    chosen = TABLE[rng.integers(len(TABLE))]
    return replace(chosen, wear=maybe(rng, power(rng, 1e-18, 1e-12)))


def random_lock(rng, d):
    return Lock(
        kind=("open", "closed")[rng.integers(2)],
        plate=random_material(rng),
        lever=d * rng.uniform(0.2, 3),
        length=d * rng.uniform(0.1, 2),
        thickness=power(rng, 1e-3, 30e-3),
        throat=maybe(rng, power(rng, 0.5e-3, 20e-3)),
        weld=(None, "internal", "external")[rng.integers(3)],
        friction_bushing=rng.uniform(0, 1.5),
        friction_seat=rng.uniform(0, 0.5),
        height=maybe(rng, d * rng.uniform(0.05, 2)),
        end_width=maybe(rng, d * rng.uniform(0.01, 0.5)),
        weld_diameter=maybe(rng, d * rng.uniform(0.1, 1)),
        screw_diameter=maybe(rng, d * rng.uniform(0.05, 1)),
        screw_yield=maybe(rng, power(rng, 1e8, 1.2e9)),
    )


def random_joint(rng, *, sized=0.5):
    """A joint in which each dimension is left out with the probability `sized`."""
    d = power(rng, 5e-3, 0.5)
    pin = random_material(rng)
    left_out = [rng.random() < sized for _ in range(6)]
    if pin.yield_stress is None:
        left_out[0] = False
    known = [
        d,
        d * rng.uniform(0.2, 3),
        d * rng.uniform(0.01, 0.4),
        d * rng.uniform(0.05, 2),
        d * rng.uniform(0.8, 6),  # smaller than its own bore too
        d * rng.choice([0.0, rng.uniform(-5e-3, 0), rng.uniform(0, 2e-3), rng.uniform(0, 0.05)]),
    ]
    dims = [None if out else value for out, value in zip(left_out, known, strict=True)]
    force = power(rng, 10, 1e7)
    moves = rng.random() < 0.8
    return Joint(
        force=force,
        safety=rng.uniform(1, 6),
        pin=pin,
        bushing=random_material(rng),
        seat=random_material(rng),
        housing=random_material(rng),
        mean_force=maybe(rng, force * rng.uniform(0, 1)),
        half_swing=rng.choice([0.0, rng.uniform(0, math.pi)]) if moves else None,
        period=power(rng, 0.01, 1e4) if moves else None,
        life=maybe(rng, power(rng, 1, 1e9)),
        largest_wear=maybe(rng, power(rng, 1e-6, 1e-2)),
        friction=rng.uniform(0, 1),
        outside_temperature=rng.uniform(-40, 200),
        assembly_temperature=rng.uniform(0, 30),
        grease_temperature=rng.uniform(60, 200),
        pin_roughness=maybe(rng, power(rng, 1e-8, 1e-5)),
        bushing_roughness=maybe(rng, power(rng, 1e-8, 1e-5)),
        pin_diameter=dims[0],
        hole_diameter=rng.choice([0.0, d * rng.uniform(0, 0.2), d * rng.uniform(0, 0.9)]),
        bushing_width=dims[1],
        wall=dims[2],
        seat_width=dims[3],
        housing_diameter=dims[4],
        play=dims[5],
        interference=rng.choice([0.0, d * rng.uniform(0, 3e-3)]),
        lateral_play=d * rng.uniform(0, 0.2),
        lock=maybe(rng, random_lock(rng, d), 0.7),
    )
