"""The formula of known_frames.hpp."""
import numpy as np

POINTS = [1000, 1200, 0, 900, 70001]
COMPONENTS = {"displacement": 3, "pore_pressure": 1, "effective_stress": 4, "strain": 6}


def values(frame, components):
    """Shape (points,) or (points, components)."""
    i = np.arange(POINTS[frame])
    table = (16 * (i % 4096) + 4 * frame)[:, None] + 0.25 * np.arange(components)
    return table[:, 0] if components == 1 else table


def position(frame):
    return 1e-3 * (values(frame, 3) + 1 / 3)
