"""Serves the sampler, BSDF, phase function or light of a Python file by the protocol for external programs.

Arguments: the file, and the domain of its samples if that is given. NumPy is used if the file has imported it.
"""

import inspect
import os
import sys
import traceback
from itertools import accumulate, islice
from math import isfinite
from types import ModuleType

ROWS = 11  # of a first call that shows how a function is written: no point and no spectrum has so many coordinates
WIDTHS = {}  # of points of the domains, by name: `etalon` fills it in
CHART = ("to_cube", "from_cube", "jacobian")
DECLARED = ("mass", "table", "precision", "dimension", "stochastic")
DECLARED_BY_KIND = {
    "bsdf": ("scatters", "eta", "reciprocal", "energy", "map", "precision", "dimension"),
    "phase": ("wo", "reciprocal", "energy", "map", "precision", "dimension"),
    "light": ("one_sided", "reference_points", "reference_box", "delta", "map", "precision", "dimension"),
}
VALUES = {"value": "bsdf", "phase": "phase", "radiance": "light"}  # the functions that say what a file has


class Refused(Exception):
    """What is wrong with the file, in words for its author. Of several attempts the one of the highest rank tells."""

    def __init__(self, message, rank=0):
        super().__init__(message)
        self.rank = rank


def numpy():
    return sys.modules.get("numpy")


def shape_of(width, n="n"):
    return f"({n},)" if width == 1 else f"({n}, {width})"


def array_rows(value, name, n, widths):
    """An array of `n` rows with as many numbers as one of `widths`."""
    np = numpy()
    try:
        array = np.asarray(value)
    except ValueError:
        raise Refused(f"{name} returned {type(value).__name__} of rows of different lengths") from None
    shape, kind = array.shape, array.dtype.kind
    if shape[:1] == (n,) and kind not in "fiu":
        raise Refused(f"{name} returned an array of dtype {array.dtype}; wanted real numbers", 2)
    if shape == (n,) and 1 in widths:
        return array.astype(float)[:, None]
    if len(shape) == 2 and shape[0] == n and shape[1] in widths and (shape[1] > 1 or name == "sample"):
        return array.astype(float)
    wanted = " or ".join(shape_of(width, n) for width in widths)
    if shape == ():
        raise Refused(f"{name} returned one number for {n} samples; wanted an array of shape {wanted}", 1)
    given = f"a {type(value).__name__} of {len(value)} arrays" if isinstance(value, (tuple, list)) else "an array"
    remedy = ""
    if len(shape) == 2 and shape[1] == n:
        remedy = f": a row for each sample, as by np.stack([{', '.join('xyz'[:shape[0]])}], axis=1)"
    elif shape == (n, 1):
        remedy = ": take its column [:, 0]"
    elif shape == (n,):
        remedy = ": a row for each sample, as by np.stack([x, y, z], axis=1)"
    found = f"{name} returned {given} of shape {shape} for {n} samples; wanted {wanted}{remedy}"
    raise Refused(found, 2 if n in shape else 0)


def one_row(value, name, widths):
    """What a call for one sample returned, as a list of as many numbers as one of `widths`."""
    wanted = " or ".join("a number" if width == 1 else f"{width} numbers" for width in widths)
    is_number = isinstance(value, (int, float)) or getattr(value, "shape", None) == ()
    try:
        row = [value] if is_number else list(value)
        is_row = len(row) in widths and (len(row) > 1 or is_number) and not any(isinstance(x, (str, complex)) for x in row)
        if is_row:
            return [float(x) for x in row]
    except (TypeError, ValueError):
        pass
    raise Refused(f"{name} returned {repr(value)[:100]} for one sample; wanted {wanted}", 1)


class Call:
    """A function of the file, written for arrays, for arrays and one `wo`, or for one sample.

    Its arguments have as many coordinates as `widths` says. In the file each is one parameter, or all or the last are spread over
    parameters: pdf(w) or pdf(x, y, z), sample(wo, u) or sample(wo, u0, u1). `read` takes what it returns to rows of numbers.
    """

    def __init__(self, function, name, widths, by_arrays, of_one_wo, as_numbers, read):
        self.function, self.name, self.by_arrays, self.read = function, name, by_arrays, read
        self.wo = widths[0] if of_one_wo else 0
        count, total = parameters(function, name), sum(widths)
        blocks = [slice(end - width, end) for end, width in zip(accumulate(widths), widths)]
        if count is None or count == len(blocks):
            self.cuts = blocks
        elif count == total:
            self.cuts = list(range(total))
        elif count == len(blocks) - 1 + widths[-1]:
            self.cuts = blocks[:-1] + list(range(total - widths[-1], total))
        else:
            raise Refused(f"{name} takes {count} arguments; wanted {len(blocks)}, or one for each of {total} coordinates", 3)
        if as_numbers:
            self.cuts = [cut.start if isinstance(cut, slice) and cut.stop - cut.start == 1 else cut for cut in self.cuts]

    def __call__(self, rows):
        """Its rows of numbers, None for "no sample", of rows of numbers."""
        if self.by_arrays:
            return listed(self.table(numpy().array(rows, dtype=float)))
        block = numpy().array if numpy() else list
        return [self.one(row, [row[cut] if isinstance(cut, int) else block(row[cut]) for cut in self.cuts]) for row in rows]

    def table(self, table):
        """What `read` makes of the results for the rows of a table: of one call for all, or for the rows of each `wo`."""
        np, wos = numpy(), table[:, : self.wo]
        if (wos != wos[0]).any():
            order = np.lexsort(wos.T)
            is_next = (wos[order[1:]] != wos[order[:-1]]).any(axis=1)
            groups = np.split(order, np.flatnonzero(is_next) + 1)
            found = {i: row for group in groups for i, row in zip(group.tolist(), listed(self.table(table[group])))}
            return [found[i] for i in range(len(table))]
        arguments = [np.ascontiguousarray(table[:, cut]) for cut in self.cuts]
        if self.wo:
            ends = [cut.stop if isinstance(cut, slice) else cut + 1 for cut in self.cuts]
            arguments = [a[0] if end <= self.wo else a for a, end in zip(arguments, ends)]
        try:
            value = self.function(*arguments)
        except Exception as error:
            error.given = f", for {' and '.join(f'an array of shape {a.shape}' for a in arguments)}"
            raise
        return self.read(value, True, len(table))

    def one(self, row, arguments):
        try:
            value = self.function(*arguments)
        except Exception as error:
            is_at_zero = self.name == "sample" and isinstance(error, ArithmeticError | ValueError) and 0 in row
            single = lambda cut: repr(row[cut]) if isinstance(cut, int) else f"({', '.join(map(repr, row[cut]))})"
            given = ", ".join(map(single, self.cuts))
            error.given = f", for {given}" if any(isinstance(cut, slice) for cut in self.cuts) else f", for ({given})"
            error.given += "; random numbers are from 0 to below 1, with 0: use 1 - u where 0 is not allowed" if is_at_zero else ""
            raise
        return self.read(value, False, 1)


def listed(found):
    """Rows of numbers as a list."""
    return found if isinstance(found, list) else found.tolist()


def parameters(function, name):
    """The number of parameters that a caller must give; None if that is not known."""
    if not callable(function):
        raise Refused(f"{name} is {repr(function)[:40]}; wanted a function", 3)
    try:
        known = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return None
    if any(p.kind is p.VAR_POSITIONAL for p in known):
        return None
    return sum(p.default is p.empty and p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD) for p in known)


def first(attempts):
    """The result of the first attempt that works; else the error of the one that came furthest."""
    errors = []
    for attempt in attempts:
        try:
            return attempt()
        except Exception as error:
            errors.append(error)
    raise max(errors, key=lambda error: (getattr(error, "rank", 0), line_of(error)))


def forms(function, name, widths, read, rows):
    """Attempts to call a function: for arrays, for arrays and one `wo`, and for one sample; with numbers and with rows of one number."""

    def attempt(by_arrays, of_one_wo, as_numbers):
        call = Call(function, name, widths, by_arrays, of_one_wo, as_numbers, read)
        # The same wo, so that a call has as many rows
        return call, call([rows[0][: call.wo] + row[call.wo :] for row in rows])

    def of_arrays(as_numbers):
        """For arrays, unless a call with one `wo` gives other results: then `wo[2]` is a coordinate, and of arrays it is the third row."""
        call, found = attempt(True, False, as_numbers)
        try:
            of_one, _ = attempt(True, True, as_numbers)
        except Exception:
            return call, found
        for start in range(len(rows)):
            turned = rows[start:] + rows[:start]
            several, single = (flat([row or [] for row in form(turned)]) for form in (call, of_one))
            if len(several) != len(single) or not numpy().allclose(several, single, equal_nan=True):
                raise Refused(f"{name} takes one wo: for arrays of them it returns other numbers")
        return call, found

    of_one_wo = lambda as_numbers: attempt(True, True, as_numbers)
    one_by_one = lambda as_numbers: attempt(False, False, as_numbers)
    several = [of_arrays, of_one_wo] if len(widths) > 1 else [lambda as_numbers: attempt(True, False, as_numbers)]
    numbers = (True, False) if 1 in widths else (False,)
    return [lambda f=f, n=n: f(n) for n in numbers for f in [*(several if numpy() else []), one_by_one]]


def expected_width(function, name, width):
    """How many coordinates a function of one point works with, if it does not with `width`; else None."""
    points = {3: [0.36, 0.48, 0.8], 2: [0.3, 0.6], 1: [0.3]}
    for other in points:
        try:
            if other != width:
                first(forms(function, name, [other], numbers_of(name, [1]), [points[other]] * ROWS))
                return other
        except Exception:
            pass
    return None


def numbers_of(name, widths):
    """Reads what a function returns that has as many numbers for each sample as one of `widths`."""

    def read(value, by_arrays, n):
        return array_rows(value, name, n, widths) if by_arrays else one_row(value, name, widths)

    return read


def maybe(read):
    """Reads None as "no sample"."""
    return lambda value, by_arrays, n: None if value is None and not by_arrays else read(value, by_arrays, n)


def uniform(n, dimension):
    """Points of the unit cube, by the golden ratio's generalization (Roberts 2018)."""
    ratio = 2.0
    for _ in range(60):
        ratio = (1 + ratio) ** (1 / (dimension + 1))
    return [[(0.5 + (i + 1) * ratio ** -(j + 1)) % 1 for j in range(dimension)] for i in range(n)]


def declaration(module, names):
    """The file's variables of these names, as words of the greeting."""
    words = []
    for name in names:
        value = getattr(module, name, None)
        if value is not None:
            text = {True: "yes", False: "no"}[value] if isinstance(value, bool) else value
            separator = "x" if name == "table" else ","
            words.append(f"{name}={separator.join(map(str, flat(text))) if isinstance(text, (tuple, list)) else text}")
    return words


def weighted(read, of_weights):
    """Reads pairs of points and weights as rows that end with the weight."""

    def read_pair(value, by_arrays, n):
        if value is None and not by_arrays:
            return None
        if not isinstance(value, tuple) or len(value) != 2:
            wanted = "wanted sample(u) and pdf(w), or a sample that returns (point, weight)"
            raise Refused(f"it has no function pdf; {wanted}, and it returned {repr(value)[:100]}", 2)
        points, weights = read(value[0], by_arrays, n), of_weights(value[1], by_arrays, n)
        return numpy().concatenate([points, weights], axis=1) if by_arrays else [*points, *weights]

    return read_pair


def ranges_of(module):
    """The file's parameters: of each, its value, which is that of the variable unless it is said, and the ends of its range."""
    declared = getattr(module, "parameters", {})
    return {name: ends if len(ends) == 3 else (getattr(module, name), *ends) for name, ends in declared.items()}


def declared_ranges(parameters):
    return "".join(f"\n{name} {value!r} {low!r} {high!r}" for name, (value, low, high) in parameters.items())


def set_values(module, parameters, values):
    for name, value in zip(parameters, values):
        setattr(module, name, value)


class SamplerFile:
    def __init__(self, module, domain):
        self.module, self.parameters = module, ranges_of(module)
        set_values(module, self.parameters, [value for value, *_ in self.parameters.values()])
        has_pdf, target = hasattr(module, "pdf"), getattr(module, "target", None)
        density, name = (module.pdf, "pdf") if has_pdf else (target, "target")
        count = parameters(module.sample, "sample")
        own = getattr(module, "dimension", None)
        if count == 0 or own == 0:
            found = "sample takes no argument" if count == 0 else "dimension is 0"
            raise Refused(f"{found}; wanted sample(u) or sample(u0, u1), with random numbers from 0 to 1")
        self.domain = getattr(module, "domain", domain)
        of_one = widths_of(self.domain) == [1]
        dimensions = [own] if own else [count] if count and count > 1 else [1, 2] if of_one else [2, 1, 3, 4, 5, 6, 7, 8]

        def attempt(dimension, form):
            sample, points = form()
            try:
                points = [point for point in points if point is not None]
                if not points:
                    raise Refused("sample returned None for all of the first samples: is a return missing?")
                width = len(points[0]) - (not has_pdf)
                points = [point[:width] for point in points]
                pdf = None
                try:
                    if density is not None:
                        pdf, _ = first(forms(density, name, [width], numbers_of(name, [1]), points))
                except Exception:
                    self.compare(width, expected_width(density, name, width), points[0], sample.by_arrays)
                    raise
            except Exception as error:
                # Further than any attempt whose samples make no sense
                error.rank = getattr(error, "rank", 0) + 4
                raise
            return dimension, sample, pdf

        read = maybe(numbers_of("sample", [3, 2, 1, 4, 5, 6, 7, 8]))
        if not has_pdf:
            read = weighted(numbers_of("sample", [4, 3, 2, 1, 5, 6, 7, 8]), numbers_of("the weight of sample", [1]))
        attempts = (
            lambda d=d, form=form: attempt(d, form)
            for d in dimensions
            for form in forms(module.sample, "sample", [d], read, uniform(ROWS, d))
        )
        dimension, sample, pdf = first(attempts)
        self.functions = {"sample": sample, "pdf": pdf}
        found = sample(uniform(1024, dimension))
        points = [point if has_pdf else point[:-1] for point in found if point is not None]
        own = self.chart(module, points)
        if self.domain is None and not own:
            self.domain = guessed(points)
        widths = widths_of(self.domain)
        if widths and len(points[0]) not in widths:
            wanted = " or ".join(map(str, widths))
            raise Refused(f"sample returns {len(points[0])} coordinates; a point of the domain {self.domain} has {wanted}")
        words = declaration(module, DECLARED)
        if not has_pdf:
            words.append("weights=yes" if target is None else "weights=target")
        narrow = getattr(module, "narrow", None)
        if narrow:
            words.append("narrow=" + ";".join(",".join(map(str, place)) for place in narrow))
        if has_pdf and len(points) < len(found) and not hasattr(module, "mass"):
            words.append("mass=at-most-1")
        if not hasattr(module, "dimension"):
            words.append(f"dimension={dimension}")
        self.greeting = " ".join([own or f"domain={str(self.domain).replace(' ', '')}", *words]) + declared_ranges(self.parameters)

    def chart(self, module, points):
        """The chart of the file's own, declared for the greeting; None if it has none."""
        missing = [name for name in CHART if not hasattr(module, name)]
        if len(missing) == len(CHART):
            return None
        if missing or self.domain is not None:
            also = f"no function {' and no function '.join(missing)}" if missing else f"a domain, {self.domain}"
            raise Refused(f"it has functions of a chart and {also}; wanted to_cube, from_cube and jacobian, and no other domain")
        width, points = len(points[0]), points[:ROWS]
        to_cube, cube = first(forms(module.to_cube, "to_cube", [width], maybe(numbers_of("to_cube", [2, 1, 3, 4, 5, 6])), points))
        cube = [place for place in cube if place is not None]
        if not cube:
            raise Refused("to_cube returned None for all of the first samples: is a return missing?")
        dimension = len(cube[0])
        from_cube, _ = first(forms(module.from_cube, "from_cube", [dimension], numbers_of("from_cube", [width]), cube))
        jacobian, _ = first(forms(module.jacobian, "jacobian", [dimension], numbers_of("jacobian", [1]), cube))
        self.functions.update(to_cube=to_cube, from_cube=from_cube, jacobian=jacobian)
        return f"chart={dimension}"

    def compare(self, sampled, taken, point, by_arrays):
        """Refuses a file whose `sample` returns another number of coordinates than its `pdf` takes."""
        if taken is None:
            return
        width = WIDTHS.get(self.domain, max(sampled, taken))
        wanted = f"an array of shape {shape_of(width)}" if by_arrays else "a number" if width == 1 else f"{width} coordinates"
        wanted += ", the x, y and z of a unit vector" if width == 3 else ""
        found = f"({', '.join(f'{x:.4g}' for x in point)})"
        if sampled != width:
            raise Refused(f"sample returns {sampled} coordinates, such as {found}, and pdf takes {taken}; sample should return {wanted}")
        raise Refused(f"pdf takes {taken} coordinates, and sample returns {sampled}, such as {found}; pdf should take {wanted}")

    def answer(self, verb, rows):
        return self.functions[verb](rows)

    def set(self, values):
        set_values(self.module, self.parameters, values)
        return []


def widths_of(domain):
    """How many coordinates points of a domain may have; none if it is not known here."""
    *indices, domain = str(domain).split("*")
    return [width + len(indices) for width in WIDTHS.get(domain.split(":")[0], [])]


def guessed(points):
    """The domain of samples, by the number of coordinates and the side of directions."""
    width = len(points[0])
    if width == 3:
        return "sphere" if any(z < 0 for _, _, z in points) else "hemisphere"
    outside = [point for point in points if any(isfinite(x) and not 0 <= x <= 1 for x in point)]
    if 10 * len(outside) > len(points):
        declared, others = ('"real"', '"half-line", "interval:-1,1", "discrete:6" …') if width == 1 else ('"plane"', '"disk", "triangle" …')
        raise Refused(
            f"sample returns points such as ({', '.join(f'{x:.4g}' for x in outside[0])}), and coordinates are from 0 to 1 unless the file "
            f"declares a domain: write domain = {declared} into it, or {others}"
        )
    return {2: "square", 1: "line"}[width]


def flat(value):
    """The numbers of a nested list."""
    return [x for part in value for x in flat(part)] if hasattr(value, "__len__") else [value]


class BsdfFile:
    """A BSDF, or what is tested like one: a phase function, or a light, whose `wo` is a reference point."""

    def __init__(self, module):
        name = next((name for name in VALUES if hasattr(module, name)), "radiance" if is_delta_light(module) else "eval")
        self.kind = VALUES.get(name, "bsdf")
        self.is_delta = self.kind == "light" and is_delta_light(module)
        count = parameters(module.sample, "sample")
        if count is not None and count < 2:
            raise Refused(f"sample takes {count} arguments; wanted sample({'point' if self.kind == 'light' else 'wo'}, u)")
        self.module, self.parameters = module, ranges_of(module)
        # Signs of x and y differ, so that wo[2], a coordinate, differs from wo[2], the third row
        sides = [[1.2 * x - 0.6, 1.2 * y - 0.6] for x, y in uniform(ROWS, 2)]
        wos = [[x, y, (1 - x * x - y * y) ** 0.5] for x, y in sides]
        pairs = [[*wo, *wi] for wo, wi in zip(wos, reversed(wos))]
        self.channels = getattr(module, "channels", 1)
        if self.is_delta:
            self.value, self.pdf = lambda rows: [[0.0] * self.channels] * len(rows), lambda rows: [[0.0]] * len(rows)
        else:
            self.value, values = first(forms(getattr(module, name), name, [3, 3], numbers_of(name, [1, 3]), pairs))
            self.pdf, _ = first(forms(module.pdf, "pdf", [3, 3], numbers_of("pdf", [1]), pairs))
            self.channels = len(values[0])
        self.hits = None
        if self.kind == "light" and hasattr(module, "hit"):
            self.hits, _ = first(forms(module.hit, "hit", [3, 3], met, pairs))
        own = getattr(module, "dimension", None)
        dimensions = [own] if own else [count - 1] if count and count > 2 else [3, 2, 1]
        attempts = (
            lambda d=d, form=form: (d, form())
            for d in dimensions
            for form in forms(
                module.sample, "sample", [3, d], self.scattered, [wo + u for wo, u in zip(wos, uniform(ROWS, d))]
            )
        )
        self.dimension, (self.sample, _) = first(attempts)
        self.functions = {"eval": self.value, "pdf": self.pdf, "hits": self.hits}
        words = declaration(module, DECLARED_BY_KIND[self.kind]) + self.cosine() + (["hits=yes"] if self.hits else [])
        if own is None:
            words.insert(0, f"dimension={self.dimension}")
        self.greeting = " ".join([f"kind={self.kind}", f"channels={self.channels}", *words]) + declared_ranges(self.parameters)

    def scattered(self, value, by_arrays, n):
        """What `sample` returned as rows of wi, the weight or [], the pdf or []; None where there is no sample."""
        if value is None and not by_arrays:
            return None
        most = 4 if self.kind == "light" else 3
        is_wi = not isinstance(value, tuple) or not hasattr(value[0], "__len__")
        if is_wi or (by_arrays and getattr(value[0], "ndim", 2) == 1):
            value = (value,)
        if not 1 <= len(value) <= most:
            also = " or (wi, weight, pdf, point)" if most == 4 else ""
            raise Refused(f"sample returned {len(value)} values; wanted wi, (wi, weight) or (wi, weight, pdf){also}", 2)
        widths = ([3], [self.channels], [1], [3])
        names = ("sample", "the weight of sample", "the pdf of sample", "the point of sample")
        if by_arrays:
            parts = [
                [[]] * n if part is None else array_rows(part, name, n, width).tolist()
                for part, name, width in zip(value, names, widths)
            ]
            return [list(row) + [[]] * (4 - len(row)) for row in zip(*parts)]
        parts = [[] if part is None else one_row(part, name, width) for part, name, width in zip(value, names, widths)]
        return parts + [[]] * (4 - len(parts))

    def answer(self, verb, rows):
        if verb in self.functions:
            return self.functions[verb](rows)
        if verb == "lobes":
            found = self.sample([row + [0.5] * self.dimension for row in rows])
            return [s and [*s[0], (s[2] or [1.0])[0], *(w * (s[2] or [1.0])[0] for w in s[1])] for s in found]
        found = self.sample(rows)
        if self.is_delta:
            return [s and [*s[0], *s[1], *(s[2] or [1.0]), *s[3]] for s in found]
        pairs = [row[:3] + sample[0] for row, sample in zip(rows, found) if sample is not None]
        # What `sample` leaves out follows from the other functions
        pdfs = iter(self.pdf(pairs) if any(sample and not sample[2] for sample in found) else ())
        values = iter(self.value(pairs) if any(sample and not sample[1] for sample in found) else ())
        return [sample and self.completed(*sample, next(pdfs, None), next(values, None)) for sample in found]

    def completed(self, wi, weight, own, point, pdf, value):
        """A sample with all of its numbers; None, "no sample", where the pdf is 0."""
        (p,) = own or pdf
        cos = abs(wi[2]) if self.kind == "bsdf" else 1
        return [*wi, *(weight or [f * cos / p for f in value]), p, *point] if p != 0 else None

    def cosine(self):
        """The mean cosine that the file declares, as words of the greeting."""
        g = getattr(self.module, "mean_cosine", None) if self.kind == "phase" else None
        return [] if g is None else [f"mean_cosine={float(g() if callable(g) else g)!r}"]

    def set(self, values):
        set_values(self.module, self.parameters, values)
        return [" ".join(self.cosine())] if self.cosine() else []


def is_delta_light(module):
    return getattr(module, "delta", False) is True and hasattr(module, "sample") and not hasattr(module, "pdf")


def met(value, by_arrays, n):
    """Reads where rays meet a light: rows of the distance, the normal and maybe the pdf per area; None where they do not."""
    if value is None and not by_arrays:
        return None
    if not isinstance(value, tuple) or len(value) not in (2, 3):
        raise Refused(f"hit returned {repr(value)[:100]}; wanted (distance, normal) or (distance, normal, pdf per area)", 2)
    names, widths = ("the distance of hit", "the normal of hit", "the pdf of hit"), ([1], [3], [1])
    if not by_arrays:
        row = sum((one_row(part, name, width) for part, name, width in zip(value, names, widths)), [])
        return row if isfinite(row[0]) else None
    parts = [array_rows(part, name, n, width).tolist() for part, name, width in zip(value, names, widths)]
    return [sum(row, []) if isfinite(row[0][0]) else None for row in zip(*parts)]


def loaded(path, domain):
    """The sampler or BSDF of the file."""
    sys.path[0], sys.argv = os.path.dirname(os.path.abspath(path)), [path]
    module = ModuleType("etalon_file")
    module.__file__ = path
    sys.modules[module.__name__] = module
    with open(path, "rb") as file:
        exec(compile(file.read(), path, "exec"), module.__dict__)
    missing = [name for name in ("sample", "pdf") if not hasattr(module, name)]
    if is_delta_light(module):
        return BsdfFile(module)
    is_bsdf = any(callable(getattr(module, name, None)) for name in VALUES) or module.__dict__.get("eval")
    if missing and (is_bsdf or missing != ["pdf"]):
        raise Refused(
            f"it has no function {' and no function '.join(missing)}; wanted sample(u) and pdf(w) for a sampler, "
            "sample(wo, u), pdf(wo, wi) and value(wo, wi) for a BSDF, phase(wo, wi) for a phase function, "
            "or sample(point, u), pdf(point, wi) and radiance(point, wi) for a light"
        )
    if is_bsdf:
        return BsdfFile(module)
    if next(iter(getattr(getattr(module.sample, "__code__", None), "co_varnames", ())), "") == "wo":
        raise Refused("it has sample(wo, …) and no function value; wanted value(wo, wi), the BSDF without the cosine, or phase(wo, wi)")
    return SamplerFile(module, domain)


def line_of(error):
    """The last line of the file that an exception went through, 0 if none."""
    frames = traceback.extract_tb(error.__traceback__)
    return max([frame.lineno for frame in frames if frame.filename == PATH][-1:], default=0)


def told(error):
    """An exception in one line."""
    if isinstance(error, Refused):
        return str(error)
    what = traceback.format_exception_only(type(error), error)[-1].strip()
    if isinstance(error, SyntaxError) and error.filename == PATH:
        return f"line {error.lineno}: {what}"
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename == PATH]
    if not frames:
        return what
    place = f"line {frames[-1].lineno}" + (f", in {frames[-1].name}" if frames[-1].name != "<module>" else "")
    return f"{place}: {what} ({frames[-1].line}){getattr(error, 'given', '')}"


def answers_to(served, verb, n, text):
    """The lines of the answer to a request of `n` lines, which are millions together: all at once, by functions that Python does not interpret."""
    function = served.functions.get(verb)
    if isinstance(function, Call) and function.by_arrays:
        found = function.table(numpy().fromstring(text, sep=" ").reshape(n, -1))
        if not isinstance(found, list):
            return map(" ".join, zip(*(map(float.hex, column) for column in found.T.tolist())))
    else:
        numbers = list(map(float, text.split()))
        width = len(numbers) // n
        found = served.answer(verb, [numbers[i : i + width] for i in range(0, len(numbers), width)])
    prefix = "delta " if verb == "sample" and getattr(served, "is_delta", False) else ""
    return ["none" if row is None else prefix + " ".join(map(float.hex, row)) for row in found]


def serve(requests, answers):
    served = None
    for request in requests:
        verb, *words = request.split()
        if verb == "quit":
            return
        lines = []
        if verb == "etalon":
            served = loaded(PATH, DOMAIN)
            name = "-".join(os.path.splitext(os.path.basename(PATH))[0].split())
            lines = [f"etalon 1 name={name} {served.greeting}"]
        elif verb == "set":
            lines = served.set(map(float, words))
        else:
            lines = answers_to(served, verb, int(words[0]), "".join(islice(requests, int(words[0]))))
        answers.write("".join(f"{line}\n" for line in [*lines, "end"]))
        answers.flush()


PATH, DOMAIN = sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None
# What the file prints goes to standard error, and it reads nothing: the pipes belong to the protocol
requests, answers = os.fdopen(os.dup(0)), os.fdopen(os.dup(1), "w", encoding="utf-8", errors="replace")
os.dup2(2, 1)
os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
try:
    serve(requests, answers)
except BaseException as error:
    text = " ".join(told(error).split())
    answers.write(f"error {text[:900]}\nend\n")
    answers.flush()
    sys.exit(2)
