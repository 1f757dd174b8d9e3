"""Makes the meshes and environment maps of `benches/scenes`, the same bytes each time."""
import os
import mitsuba as mi, numpy as np


def write_ply(path, points, faces, normals=None, uv=None):
    """A binary PLY file of triangles, with normals and texture coordinates of its vertices or without."""
    columns = [(points, "x y z"), (normals, "nx ny nz"), (uv, "u v")]
    columns = [(values, names) for values, names in columns if values is not None]
    names = " ".join(names for _, names in columns).split()
    records = np.zeros(len(faces), dtype=[("n", "u1"), ("i", "<i4", (3,))])
    records["n"], records["i"] = 3, faces
    properties = "".join(f"property float {name}\n" for name in names)
    with open(path, "wb") as f:
        f.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{properties}"
                 f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n").encode())
        f.write(np.hstack([values for values, _ in columns]).astype("<f4").tobytes())
        f.write(records.tobytes())


def knot(around, across):
    """A torus knot of 2 * around * across triangles in a box of about 1.5 x 0.7 x 1.5: points, triangles, normals, and
    texture coordinates, u along the knot and v across, whose last column of triangles goes back to 0."""
    radius = lambda t: 1 + np.cos(3 * t) / 2
    line = lambda t: np.hstack([radius(t) * np.cos(2 * t), np.sin(3 * t) / 2, radius(t) * np.sin(2 * t)])
    unit = lambda v: v / np.linalg.norm(v, axis=1, keepdims=True)
    t = np.linspace(0, 2 * np.pi, around, endpoint=False)[:, None]
    tangent = unit(line(t + 1e-4) - line(t - 1e-4))
    side = unit(np.cross(tangent, line(t) + [0, 3, 0]))
    angle = np.linspace(0, 2 * np.pi, across, endpoint=False)[None, :, None]
    normals = np.cos(angle) * np.cross(side, tangent)[:, None] + np.sin(angle) * side[:, None]
    points = .25 * (line(t)[:, None] + .28 * normals) + [0, .55, 0]
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    at = lambda di, dj: ((i + di) % around * across + (j + dj) % across).ravel()
    a, b, c, d = at(0, 0), at(1, 0), at(1, 1), at(0, 1)
    faces = np.vstack([np.stack([a, c, b], 1), np.stack([a, d, c], 1)])
    uv = np.stack([i / around, j / across], -1).reshape(-1, 2)
    return points.reshape(-1, 3), faces, normals.reshape(-1, 3), uv


def ceiling_lights(across, along):
    """One mesh of small squares of random sizes, in a grid over 2 x 2 at y = 0, that face downwards."""
    x, z = np.meshgrid((np.arange(across) + .5) / across * 2 - 1, (np.arange(along) + .5) / along * 2 - 1)
    centres = np.stack([x.ravel(), 0 * x.ravel(), z.ravel()], 1)
    half = np.random.default_rng(1).uniform(.05, .35, len(centres))[:, None] * 2 / across
    corners = [centres + half * [a, 0, b] for a, b in [(-1, -1), (1, -1), (1, 1), (-1, 1)]]
    i = np.arange(len(centres))[:, None] * 4
    return np.stack(corners, 1).reshape(-1, 3), np.concatenate([i + [0, 1, 2], i + [0, 2, 3]])


def windows():
    """A dim map with four windows and a sun of nine texels."""
    image = np.full((512, 1024, 3), .1) * [.85, .95, 1.1]
    image[190:230, 120:138], image[200:230, 420:434], image[180:216, 640:660], image[300:312, 880:890] = 25, 40, 20, 30
    image[100:103, 250:253] = 12000
    return image


def sky(sun):
    """A smooth sky above brown ground, row 0 at the zenith; with a sun of radiance `sun`, 40 degrees high."""
    elevation, azimuth = np.pi * (.5 - (np.arange(256)[:, None] + .5) / 256), 2 * np.pi * (np.arange(512) + .5) / 512
    up = np.clip(np.sin(elevation), 0, 1)[..., None]
    to_sun = (np.sin(elevation) * np.sin(.7) + np.cos(elevation) * np.cos(.7) * np.cos(azimuth - 1))[..., None]
    air = [1, 1, 1] + (np.array([.2, .4, .9]) - 1) * np.sqrt(up) + np.exp(8 * (to_sun - 1)) * [1, .8, .5]
    return np.where(up > 0, air, [.12, .1, .08]) + (to_sun > np.cos(.02)) * np.array([1, .9, .7]) * sun


def write_assets(folder):
    """Writes all meshes and maps into `folder`."""
    os.makedirs(folder, exist_ok=True)
    write_ply(os.path.join(folder, "knot.ply"), *knot(1000, 50)[:3])
    write_ply(os.path.join(folder, "knot-uv.ply"), *knot(240, 20))
    write_ply(os.path.join(folder, "knot-facets.ply"), *knot(240, 20)[:2])
    write_ply(os.path.join(folder, "ceiling-lights.ply"), *ceiling_lights(40, 25))
    for name, image in [("windows", windows()), ("sky", sky(0)), ("sky-sun", sky(20000))]:
        mi.Bitmap(image.astype(np.float32)).write(os.path.join(folder, f"{name}.pfm"))
