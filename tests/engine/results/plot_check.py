#!/usr/bin/python3
"""cases/plot.py draws the known frames: plot_check.py PLOT RESULT PICTURE"""
import subprocess
import sys

import matplotlib.image
import numpy as np

plot, result, picture = sys.argv[1:]


def draw(*options):
    return subprocess.run([plot, result, "--out", picture, *options], capture_output=True, text=True)


def has_colour(pixels, name):
    wanted = np.array([int(name[k:k + 2], 16) for k in (1, 3, 5)]) / 255
    return (abs(pixels[..., :3] - wanted).max(axis=2) < 0.01).any()


OPEN, CLOSED = "#2e9e5b", "#c0392b"
for times, gates in (("0", [CLOSED]), ("0.3", [OPEN]), ("0.1,0.3", [OPEN, CLOSED])):
    done = draw("--times", times, "--soil", "effective_stress.yy", "--series", "probe.below")
    assert done.returncode == 0, done.stderr
    pixels = matplotlib.image.imread(picture)
    for colour in (OPEN, CLOSED):
        assert has_colour(pixels, colour) == (colour in gates), f"t = {times}: gate {colour}"
    assert has_colour(pixels, "#3b3b3b"), "the wall is missing"

for options, message in ((["--field", "colour"], "no field 'colour'"),
                         (["--soil", "effective_stress"], "needs a component"),
                         (["--soil", "displacement.q"], "no component 'q'"),
                         (["--series", "probe.above"], "no series 'probe.above'")):
    done = draw(*options)
    assert done.returncode != 0 and message in done.stderr, (options, done.stderr)
