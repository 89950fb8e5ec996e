"""Strand (2005), chapter 2, once more: straight from the equations, in N, mm and MPa.

Written from the source and its errata; it shares no code with `erlif`. `margins` returns allowed
over present value less 1 by the name of the step.
"""

import math

import numpy as np
from scipy.optimize import brentq

INF = math.inf
KGF = 9.80665  # N


def below(present, allowed):
    if present <= 0:
        return INF if allowed >= present else -1.0
    return -1.0 if present == INF else max(allowed, 0.0) / present - 1


def between(present, low, high):
    return min(present / low - 1, below(present, high))


def persson(E, play, q, d):
    """Half contact angle and largest pressure, eq. 9, by the equation of the appendix."""
    group = E * play / (2 * q)
    if group <= -2 / math.pi:  # pressed all around: uniform pressure and a cosine
        return math.pi, -E * play / (2 * d) + 2 * q / (math.pi * d)

    def f(log_b):
        b2 = math.exp(2 * log_b)
        return (2 - math.log(1 + b2) - 2 * b2**2) / (math.pi * b2 * (1 + b2)) - group

    b = math.exp(brentq(f, -18, 9, xtol=1e-14))
    first = math.log(math.sqrt(b**2 + 1) + b) / (math.pi * b**2 * (1 + b**2))
    return 2 * math.atan(b), 2 * q / d * (first + 2 * b / (math.pi * math.sqrt(1 + b**2)))


def press_fit(j, d, t, Dh):
    """Radial displacement of the bore, Lame's rings with their pressure."""
    D, i = d + 2 * t, j.interference * 1e3
    if i <= 0 or Dh <= D:
        return 0.0
    Eb, Eh = j.bushing.youngs_modulus, j.housing.youngs_modulus
    nb, nh = j.bushing.poissons_ratio, j.housing.poissons_ratio
    if None in (Eb, Eh, nb, nh):
        return 0.0
    Eb, Eh = Eb / 1e6, Eh / 1e6
    soft_housing = D / 2 / Eh * ((Dh**2 + D**2) / (Dh**2 - D**2) + nh)
    soft_bushing = D / 2 / Eb * ((D**2 + d**2) / (D**2 - d**2) - nb)
    p = i / 2 / (soft_housing + soft_bushing)
    return -p / Eb * 2 * (d / 2) * D**2 / (D**2 - d**2)


def pressed_rings(j, d, t, Dh):
    """Von Mises stress at the bores of bushing and housing by Lame's constants.

    s_r = A - B/r^2, s_t = A + B/r^2 and u = r (s_t - nu s_r)/E in each ring. The four constants
    follow from both free surfaces, one pressure in the fit, and displacements that differ by half
    of the interference.
    """
    a, b, c = d / 2, d / 2 + t, Dh / 2
    Eb, Eh = j.bushing.youngs_modulus / 1e6, j.housing.youngs_modulus / 1e6
    nb, nh = j.bushing.poissons_ratio, j.housing.poissons_ratio
    # r^2 = b^2 rho; unknowns A, B/b^2 of the bushing and of the housing
    x, y = (b / a) ** 2, (b / c) ** 2
    system = [
        [1, -x, 0, 0],
        [0, 0, 1, -y],
        [1, -1, -1, 1],
        [-(1 - nb) / Eb, -(1 + nb) / Eb, (1 - nh) / Eh, (1 + nh) / Eh],
    ]
    A1, B1, A2, B2 = np.linalg.solve(system, [0, 0, 0, j.interference * 1e3 / 2 / b])

    def mises(A, B):
        radial, hoop = A - B, A + B
        return math.sqrt((radial**2 + hoop**2 + (radial - hoop) ** 2) / 2)

    return mises(A1, B1 * x), mises(A2, B2)


def margins(j):
    F, eta, Fm = j.force, j.safety, j.force if j.mean_force is None else j.mean_force
    d, w, t, s, Dh = (
        1e3 * length
        for length in (j.pin_diameter, j.bushing_width, j.wall, j.seat_width, j.housing_diameter)
    )
    D, out = d + 2 * t, {}
    sy_pin, sy_ring, sy_eye = (
        None if part.yield_stress is None else part.yield_stress / 1e6
        for part in (j.pin, j.bushing, j.housing)
    )
    H = None if j.bushing.hardness_low is None else j.bushing.hardness_low * KGF
    if H is None and j.bushing.ultimate_stress is not None:
        H = 0.3 * j.bushing.ultimate_stress / 1e6 * KGF
    H_seat = j.seat.hardness_low
    if H_seat is None and j.seat.ultimate_stress is not None:
        H_seat = 0.3 * j.seat.ultimate_stress / 1e6

    # eqs. 1, 2 and 4
    L = w + 1e3 * j.lateral_play
    if sy_pin is not None:
        out["pin_shear"] = below(math.sqrt(3) * (F / 2) / (math.pi * d**2 / 4), sy_pin / eta)
        stress = F * L / 8 / (math.pi * d**3 / 32)
        x = 1e3 * j.hole_diameter / d
        if x > 0:
            Kt = 3 - 11.3 * x + 51.6 * x**2 - 114.6 * x**3 + 76.4 * x**4 if x <= 0.2 else 3.0
            left = math.pi * d**3 / 32 - x * d**3 / 6
            stress = Kt * F * L / 8 / left if left > 0 else INF
        out["pin_bending"] = below(stress, sy_pin / eta)

    # eqs. 5 to 11
    p, q = F / (d * w), F / w
    if sy_ring is not None:
        out["seizure"] = below(p, min(sy_ring, sy_pin or INF) / 2)
    if H is not None:
        out["pressure_projected"] = below(q / d, H / eta)
        out["pressure_cosine"] = below(4 * q / (math.pi * d), H / eta)
        out["bushing_edge"] = below(8 * F / (math.pi * d * w), H / eta)
    play = 1e3 * j.play + 2 * press_fit(j, d, t, Dh)
    E1, E2 = j.pin.youngs_modulus, j.bushing.youngs_modulus
    if H is not None and E1 is not None and E2 is not None:
        E1, E2 = E1 / 1e6, E2 / 1e6
        out["pressure_peak"] = below(persson(2 / (1 / E1 + 1 / E2), play, q, d)[1], H / eta)
        n1, n2 = j.pin.poissons_ratio, j.bushing.poissons_ratio
        if play > 0 and n1 is not None and n2 is not None:
            E = 1 / ((1 - n1**2) / E1 + (1 - n2**2) / E2)
            R = 1 / (2 / d - 2 / (d + play))
            out["pressure_hertz"] = below(math.sqrt(q * E / (math.pi * R)), H / eta)
    out["width_ratio"] = between(w / d, 0.5, 1.5)
    if j.bushing.pressure is not None:
        out["pressure_limit"] = below(p, j.bushing.pressure / 1e6)

    # eqs. 12 to 14
    if H_seat is not None:
        out["seat_edge"] = below(4 * F / (math.pi * d * s), H_seat * KGF / eta)
    if sy_eye is not None:
        stress = F / (w * (Dh - D)) * (D / Dh + Dh / D) if Dh > D else INF
        out["housing_eye"] = below(stress, sy_eye / eta)
    out["housing_ratio"] = between(Dh / D, 2, 4)

    # eqs. 15 to 21
    if j.lock is not None:
        k = j.lock
        S = None if k.plate.yield_stress is None else k.plate.yield_stress / 1e6 / eta
        R, Lp, tp = 1e3 * k.lever, 1e3 * k.length, 1e3 * k.thickness
        force = abs(F * d / 2 * (k.friction_bushing - k.friction_seat)) / R
        if k.screw_yield is not None:
            area = math.pi / 4 * (1e3 * k.screw_diameter) ** 2
            out["lock_screw"] = below(math.sqrt(3) * force / area, k.screw_yield / 1e6 / eta)
        if S is not None:
            a, Di = 1e3 * k.throat, 1e3 * k.weld_diameter
            # a fillet of throat a has legs of sqrt(2) a; its force acts at its mean radius
            leg = math.hypot(a, a)
            radius = (Di / 2 + (Di / 2 + leg)) / 2
            out["weld"] = below(math.sqrt(3) * (F * d / 2 / radius) / (2 * math.pi * radius * a), S)
            if k.weld == "internal":
                out["weld_room"] = between(Di, 20, d - 2 * a * (1 + math.sqrt(2)))
            h = 1e3 * k.height
            end = 5 / 32 * force if k.kind == "closed" else 0.0
            moment, shear = force * Lp - end * 2 * Lp, force - end
            bending = moment / (tp * h**2 / 6)
            out["prong"] = below(math.hypot(bending, math.sqrt(3) * shear / (tp * h)), S)
            if k.kind == "closed":
                out["lock_end"] = below(end / (1e3 * k.end_width * tp), S)
        out["plate"] = between(tp, 5, 15)

    # section 2.1.10: the slope of the straight halves; eqs. 23 to 25
    out["slenderness"] = below((2 * s + w) / d, 3)
    if j.pin.youngs_modulus is not None:
        length = 2 * s + w
        sag = F * length**3 / (48 * j.pin.youngs_modulus / 1e6 * math.pi * d**4 / 64)
        out["lateral_force"] = below(sag / (length / 2), 1.0)
    out["relative_play"] = between(1e3 * play / d, 0.3, 5.0)

    # stresses of the press fit, against the yield stresses themselves
    elastic = [(p.youngs_modulus, p.poissons_ratio) for p in (j.bushing, j.housing)]
    if j.interference > 0 and Dh > D and not any(None in pair for pair in elastic):
        ring, eye = pressed_rings(j, d, t, Dh)
        if sy_ring is not None:
            out["press_bushing"] = below(ring, sy_ring)
        if sy_eye is not None:
            out["press_housing"] = below(eye, sy_eye)

    # a joint that moves and is tight when cold seizes, whatever growth takes
    moving = j.half_swing is not None and j.period is not None and j.half_swing > 0
    if moving and play < 0:
        out["warm_play"] = play / (0.3e-3 * d)

    # eqs. 26 to 32
    if j.half_swing is not None and j.period is not None:
        v = 2 * d / 1e3 * j.half_swing / j.period  # m/s
        if j.bushing.speed is not None:
            out["speed"] = below(v, j.bushing.speed)
        if j.bushing.pv is not None:
            out["pv"] = below(Fm / (d * w) * v, j.bushing.pv / 1e6)
        lp, lb, T = j.pin.conductivity, j.bushing.conductivity, j.outside_temperature
        if lp is not None and lb is not None:
            heat = Fm * j.friction * v / (1 + lp / lb)
            rise = heat * math.log((d + 2 * t) / d) / (math.pi * w / 1e3 * lb)
            ring = j.bushing.temperature
            limit = j.grease_temperature if ring is None else min(j.grease_temperature, ring)
            out["temperature"] = -1.0 if limit < T else below(rise, limit - T)
            ap, ab, ah = j.pin.expansion, j.bushing.expansion, j.housing.expansion
            if None not in (ap, ab, ah):
                T0 = j.assembly_temperature
                wall = T + rise / 2 - T0
                bore = min(d * ab * wall, D * ah * (T - T0) - 2 * t * ab * wall)
                warm = play + bore - d * ap * (T + rise - T0)
                out["warm_play"] = warm / (0.3e-3 * d)
        if None not in (j.life, j.largest_wear, j.bushing.wear):
            k = j.bushing.wear * 1e6  # 1/MPa
            depth = k * 4 * Fm / (math.pi * d * w) * v * j.life * 1e3
            out["wear"] = below(depth, 1e3 * j.largest_wear)
    rough = [ra for ra in (j.pin_roughness, j.bushing_roughness) if ra is not None]
    if rough:
        out["roughness"] = below(1e6 * max(rough), 1.0)
    if j.pin.hardness_low is not None and j.bushing.hardness_high is not None:
        out["hardness_difference"] = (j.pin.hardness_low - j.bushing.hardness_high) / 100 - 1
    return out
