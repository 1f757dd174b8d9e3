# Resampled importance sampling: a point of the square by a reservoir of eight, with its weight in place of a pdf

dimension = 3 * 8  # a candidate and the choice of the reservoir
domain = "square"


def importance(x, y):
    return 0.1 + x * y


def sample(u):
    chosen, total = None, 0.0
    for x, y, choice in zip(u[0::3], u[1::3], u[2::3]):
        weight = importance(x, y)  # over the pdf of candidates, 1
        total += weight
        if choice * total < weight:
            chosen = x, y
    return chosen, total / (8 * importance(*chosen))
