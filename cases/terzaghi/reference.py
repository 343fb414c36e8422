#!/usr/bin/env python3
"""Writes reference.csv beside it: excess pressure at the base by Terzaghi's series, from T = 0.05 on (before, the
load's wave crosses the column), with c_v = k/γw / (1/Ec + n/Kw); the terms of tests/verification/terzaghi_test.cpp."""
import math
import pathlib

LOAD, HEIGHT, YOUNG, POISSON, PERMEABILITY, POROSITY, WATER = 1e3, 1, 1e7, 0.3, 1e-3, 0.4, 2.2e9
MODULUS = YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))
UNIT = HEIGHT**2 * 9810 * (1 / MODULUS + POROSITY / WATER) / PERMEABILITY  # s, T = 1


def pressure(t):
    terms = ((2 * m + 1) * math.pi / 2 for m in range(200))
    return sum(2 / a * math.sin(a) * math.exp(-a * a * t) for a in terms)


rows = [f"{UNIT * t / 200:.6g},{LOAD * pressure(t / 200):.8g}" for t in range(10, 201)]
pathlib.Path(__file__).with_name("reference.csv").write_text("time,probe.base\n" + "\n".join(rows) + "\n")
