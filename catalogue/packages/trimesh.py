# /// script
# dependencies = ["trimesh==5.2.0", "scipy==1.17.1"]
# ///
"""trimesh: points on surfaces (as triangle and barycentric coordinates), in volumes, and random rotations."""

import numpy as np
import trimesh
from trimesh import sample as sampling
from trimesh.triangles import points_to_barycentric

from entry import run, sampler


def surface(name, mesh, weight=None, claimed=None, **options):
    """Points on a mesh: the triangle by its area, or by `weight`, and barycentric coordinates."""
    share = mesh.area_faces if weight is None else weight
    share = share / share.sum() if claimed is None else claimed

    def sample(n, seed):
        points, faces = sampling.sample_surface(mesh, n, face_weight=weight, seed=seed)[:2]
        return np.column_stack([faces, np.clip(points_to_barycentric(mesh.triangles[faces], points)[:, :2], 0, 1)])

    return sampler(f"sample_surface {name}", sample, lambda x: 2 * share[x[:, 0].astype(int)], f"{len(share)}*triangle", dimension=0, **options)


def seeded(name, draw, pdf, domain, **options):
    """What draws from NumPy's global generator."""
    return sampler(name, lambda n, seed: (np.random.seed(seed), draw(n))[1], pdf, domain, dimension=0, **options)


uniform = lambda w: np.full(len(w), 0.25 / np.pi)  # noqa: E731
ones = lambda x: np.ones(len(x))  # noqa: E731
box, ball, tube = trimesh.creation.box([1, 2, 3]), trimesh.creation.icosphere(subdivisions=1), trimesh.creation.cylinder(0.3, 2.0, sections=9)
sliver = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1e-3]], [[0, 1, 2], [0, 1, 3], [0, 2, 3]], process=False)
ENTRIES = [
    surface("box", box, control="right"),
    surface("box, faces taken for equal", box, claimed=np.full(12, 1 / 12), control="wrong"),
    *(surface(name, mesh) for name, mesh in {"icosphere": ball, "cylinder": tube, "sliver": sliver}.items()),
    surface("icosphere, weights", ball, weight=np.arange(len(ball.faces), dtype=float)),
    seeded("volume_rectangular", lambda n: (sampling.volume_rectangular([1, 2, 3], n) / [1, 2, 3] + 0.5)[:, :2], ones, "square"),
    seeded("volume_rectangular, third axis", lambda n: sampling.volume_rectangular([1, 2, 3], n)[:, 2] / 3 + 0.5, ones, "line"),
    seeded("random_quaternion", lambda n: np.array([trimesh.transformations.quaternion_matrix(trimesh.transformations.random_quaternion())[:3, 1] for _ in range(n)]), uniform, "sphere", detect=0.1),
    seeded("random_rotation_matrix", lambda n: np.array([trimesh.transformations.random_rotation_matrix()[:3, 2] for _ in range(n)]), uniform, "sphere", detect=0.1),
    seeded("unitize of normal", lambda n: trimesh.unitize(np.random.normal(size=(n, 3))), uniform, "sphere"),
]

run(ENTRIES)
