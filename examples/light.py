# A rectangle that emits to one side, sampled by area
from math import sqrt

one_sided = True
corner, edge0, edge1 = (-1, 2, -0.5), (2, 0, 0), (0, 0.6, 0.8)
normal, area, emitted = (0, -0.8, 0.6), 2, 3


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def hit(point, wi):
    """Distance, normal, and pdf per area, where a ray meets the rectangle."""
    cos = dot(normal, wi)
    if cos == 0:
        return None
    to = [a - b for a, b in zip(corner, point)]
    distance = dot(normal, to) / cos
    place = [distance * d - t for d, t in zip(wi, to)]
    is_inside = all(0 <= dot(place, e) / dot(e, e) <= 1 for e in (edge0, edge1))
    return (distance, normal, 1 / area) if distance > 0 and is_inside else None


def radiance(point, wi):
    return emitted if dot(normal, wi) < 0 and hit(point, wi) else 0


def pdf(point, wi):
    met = hit(point, wi)
    cos = -dot(normal, wi)
    return met[0] ** 2 / (area * cos) if met and cos > 0 else 0


def sample(point, u0, u1):
    there = [c + u0 * a + u1 * b for c, a, b in zip(corner, edge0, edge1)]
    to = [a - b for a, b in zip(there, point)]
    r2 = dot(to, to)
    wi = [x / sqrt(r2) for x in to]
    cos = -dot(normal, wi)
    if cos <= 0:
        return None
    p = r2 / (area * cos)
    return wi, emitted / p, p, there
