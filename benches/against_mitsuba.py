#!/usr/bin/env python3
"""CPU time x MSE of `etalon render` and of Mitsuba 3 on the scenes of `benches/scenes`.

    python3 -m venv venv && venv/bin/pip install mitsuba numpy     # its LLVM variant also wants libLLVM
    venv/bin/python benches/against_mitsuba.py target/release/etalon --quick
    venv/bin/python benches/against_mitsuba.py target/release/etalon --references target/references --csv ratios.csv

Both programs render the same .pbrt file (`pbrt_to_mitsuba.py` translates it) at the same resolution, depth and samples
per pixel, alternating, with as many threads; Mitsuba with its LLVM variant and multijitter sampler. CPU time (user and
system) is that of a render minus that of a render with one sample, times spp / (spp - 1): without what either prepares.

The MSE of an image a is the mean of (a - b1)(a - b2), where b1 and b2 are references of Mitsuba and of etalon, each the
mean of many renders with seeds of their own: their noise is independent and adds nothing on average. The ratio is
etalon's CPU time x MSE over Mitsuba's, below 1 where etalon reaches the same error sooner, with its 90 % interval
(bootstrap over the seeds), from all pixels and without the worst 0.1 % of each image.

Welch's t-test compares the two programs' means of the image and of 8 x 6 tiles: of the references, and of etalon's
measured images with Mitsuba's reference. p is the smallest, times their number (Bonferroni). Below 0.01 a program is
biased, or reads the scene differently, or has outliers that few seeds miss. Mitsuba's multijitter sampler is itself
biased at 16 samples per pixel, by 1 % in the scene `furnace-knot`, and not measurably at 64. `--agreement` makes this
test alone, with `--seeds` renders of each program:

    venv/bin/python benches/against_mitsuba.py target/release/etalon --agreement --scenes rough-glass-mesh --seeds 32
"""
import argparse, csv, math, os, resource, shlex, shutil, subprocess, tempfile, time
import drjit as dr, mitsuba as mi, numpy as np
mi.set_variant("llvm_ad_rgb")
import pbrt_to_mitsuba, scene_assets

SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes")
KNOWN = "spheres-5 spheres-100 alpha-0.005 alpha-0.05 alpha-0.25 alpha-0.5 mesh sphere-env".split()
# Nobody tunes the renderer on these.
HELD_OUT = "light-behind-baffle spheres-sky-sun nested-glass lights-occluded ring-caustic door-ajar".split()
NEW = sorted({name[:-5] for name in os.listdir(SCENES) if name.endswith(".pbrt")} - {*KNOWN, *HELD_OUT})
SETS = {"known": KNOWN, "new": NEW, "held-out": HELD_OUT}


def mitsuba(path, options):
    """Renders the scene at `path` with Mitsuba: a function of samples per pixel and seed to image and CPU seconds."""
    scene = pbrt_to_mitsuba.load(path, *options.resolution)

    def render(spp, seed):
        start = time.process_time()
        image = np.array(mi.render(scene, spp=spp, seed=seed), dtype=np.float64)
        return image, time.process_time() - start

    # Compiles the kernels.
    render(1, 0), render(options.spp, 0)
    return render


def etalon(path, options, extra=""):
    """The same with etalon and extra arguments."""
    size, image = map(str, options.resolution), path.removesuffix(".pbrt") + "-etalon.pfm"
    command = [options.program, "render", path, "-r", *size, "-t", str(options.threads), "--quiet", "-o", image,
               *shlex.split(extra)]
    cpu = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])

    def render(spp, seed):
        start = cpu()
        subprocess.run([*command, "-s", str(spp), "--seed", str(seed)], check=True, stdout=subprocess.DEVNULL)
        return np.array(mi.Bitmap(image), dtype=np.float64), cpu() - start

    return render


def means(image):
    """The mean of the image and of 8 x 6 tiles."""
    tiles = [tile for row in np.array_split(image, 6) for tile in np.array_split(row, 8, axis=1)]
    return [x.mean() for x in (image, *tiles)]


def reference(render, path, text, options):
    """The mean of renders with seeds of their own, and `means` of each; from the file at `path` if it fits."""
    if os.path.exists(path):
        kept = np.load(path)
        if kept["text"] == text and kept["spp"] * len(kept["means"]) >= options.spp * options.reference_runs:
            return kept["image"], kept["means"]
    images = [render(options.spp, 1_000_001 + i)[0] for i in range(options.reference_runs)]
    image, rows = np.mean(images, 0), np.array([means(image) for image in images])
    np.savez_compressed(path, image=image, means=rows, spp=options.spp, text=text)
    return image, rows


def two_sided_p(t, freedom):
    """P(|T| >= |t|) of Student's distribution: the pdf of atan(t / sqrt(freedom)) goes with cos^(freedom - 1)."""
    angle = (np.arange(65536) + .5) / 65536 * math.pi / 2
    pdf = np.cos(angle) ** (freedom - 1)
    return pdf[angle >= math.atan(abs(t) / math.sqrt(freedom))].sum() / pdf.sum()


def student(a, b):
    """Welch's t and its degrees of freedom for the columns of a and b, and their relative differences."""
    va, vb = (np.maximum(x.var(0, ddof=1) / len(x), 1e-30) for x in (a, b))
    t = (a.mean(0) - b.mean(0)) / np.sqrt(va + vb)
    freedom = (va + vb) ** 2 / (va**2 / (len(a) - 1) + vb**2 / (len(b) - 1))
    return t, freedom, a.mean(0) / np.maximum(b.mean(0), 1e-30) - 1


def welch(a, b):
    """Of Welch's t-tests of the columns of a and b: Bonferroni's p-value, its column, the relative difference there."""
    t, freedom, difference = student(a, b)
    # The programs interpolate environment maps differently, which shows where there is little noise.
    p = [two_sided_p(*x) if abs(d) > 1e-3 else 1.0 for *x, d in zip(t, freedom, difference)]
    worst = int(np.argmin(p))
    return min(1.0, p[worst] * len(p)), worst, difference[worst]


def errors(image, references):
    """The MSE with all pixels, and without the worst 0.1 % of them."""
    pixels = np.sort(((image - references[0]) * (image - references[1])).mean(-1), axis=None)
    return pixels.mean(), pixels[:-math.ceil(len(pixels) / 1000)].mean()


def ratio(ours, theirs):
    """The ratio of CPU time x MSE and its 90 % interval; the rows of both are (CPU time, MSE) of one seed."""
    cost, random = lambda rows: rows.mean(-2).prod(-1), np.random.default_rng(1)
    a, b = (rows[random.integers(len(rows), size=(2000, len(rows)))] for rows in (ours, theirs))
    return cost(ours) / cost(theirs), *np.quantile(cost(a) / cost(b), [.05, .95])


def measure(label, options):
    """One row of the results."""
    path, (width, height) = os.path.join(options.work, f"{label}.pbrt"), options.resolution
    text, renderers = pbrt_to_mitsuba.source(path), [mitsuba(path, options), etalon(path, options, options.etalon_args)]
    kept = os.path.join(options.references or options.work, f"{label}-{width}x{height}")
    references = [reference(renderers[0], f"{kept}-Mitsuba.npz", text, options),
                  reference(etalon(path, options), f"{kept}-etalon.npz", text, options)]
    start = [np.median([render(1, seed)[1] for seed in range(1, 6)]) for render in renderers]
    runs, ours_means = ([], []), []
    for seed in range(1, options.seeds + 1):
        for side, render in enumerate(renderers):
            image, cpu = render(options.spp, seed)
            cpu = (cpu - start[side]) * options.spp / (options.spp - 1)
            runs[side].append([cpu, *errors(image, [mean for mean, _ in references])])
        ours_means.append(means(image))
    theirs, ours = map(np.array, runs)
    row = {"scene": label, "set": next(name for name in SETS if label in SETS[name])}
    for name, x in [("mitsuba", theirs), ("etalon", ours)]:
        row |= zip([f"{name}_cpu_seconds", f"{name}_mse", f"{name}_mse_trimmed"], x.mean(0))
    for name, columns in [("ratio", [0, 1]), ("ratio_trimmed", [0, 2])]:
        row |= zip([name, f"{name}_low", f"{name}_high"], ratio(ours[:, columns], theirs[:, columns]))
    for name, x in [("references", references[1][1]), ("images", np.array(ours_means))]:
        row |= zip([f"{name}_p", f"{name}_tile", f"{name}_difference"], welch(x, references[0][1]))
    return row


def agreement(label, options):
    """Prints whether the means of both programs agree, by renders with seeds of their own, without timing."""
    path = os.path.join(options.work, f"{label}.pbrt")
    renderers = [mitsuba(path, options), etalon(path, options, options.etalon_args)]
    theirs, ours = (np.array([means(render(options.spp, 10_000 * side + seed)[0]) for seed in range(1, options.seeds + 1)])
                    for side, render in enumerate(renderers))
    t, freedom, difference = student(ours, theirs)
    tile = 1 + int(np.argmax(abs(t[1:])))
    least = min(1.0, min(two_sided_p(*x) for x in zip(t, freedom)) * len(t))
    print(f"| {label} | {t[0]:+.2f} ({difference[0]:+.2%}) | {t[tile]:+.2f} ({difference[tile]:+.2%}, tile {tile}) "
          f"| {least:.2g} |", flush=True)


def show(row):
    """Prints the row in Markdown."""
    cells = [f"{row[f'{name}_cpu_seconds']:.2f} | {row[f'{name}_mse']:.2e}" for name in ("mitsuba", "etalon")]
    cells += ["{:.2f} ({:.2f} to {:.2f})".format(*(row[name + end] for end in ("", "_low", "_high")))
              for name in ("ratio", "ratio_trimmed")]
    for name in ("references", "images"):
        p, tile, difference = (row[f"{name}_{what}"] for what in ("p", "tile", "difference"))
        where = f" ({difference:+.2%} in {f'tile {tile}' if tile else 'the image'})"
        cells.append(f"{p:.2g}{where if p < .01 else ''}")
    print(f"| {' | '.join([row['scene'], row['set'], *cells])} |", flush=True)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    option = parser.add_argument
    option("program", help="the program etalon")
    option("--quick", action="store_true", help="a first look: 4 seeds, 6 reference runs, 48 x 36 pixels")
    option("--scenes", default="known,new,held-out", help="names of scenes or sets, with commas (default: %(default)s)")
    option("--spp", type=int, default=64, help="samples per pixel, a square number (default: 64)")
    option("--seeds", type=int, help="measured renders of each program (default: 16)")
    option("--reference-runs", type=int, help="renders of each reference (default: 64)")
    option("--resolution", type=int, nargs=2, metavar=("W", "H"), help="pixels (default: 160 120)")
    option("--threads", type=int, default=1, help="threads of each program (default: 1)")
    option("--etalon-args", default="", help='more arguments of the measured renders, like "--sampling light"')
    option("--agreement", action="store_true", help="only compare the means of both programs")
    option("--references", metavar="FOLDER", help="keeps the references between runs")
    option("--csv", metavar="FILE", help="also write the results as CSV")
    options = parser.parse_args()
    seeds, runs, size = (4, 6, [48, 36]) if options.quick else (16, 64, [160, 120])
    options.seeds, options.reference_runs = options.seeds or seeds, options.reference_runs or runs
    options.resolution = options.resolution or size
    options.scenes = [name for word in options.scenes.split(",") for name in SETS.get(word, [word])]
    if unknown := set(options.scenes) - {*KNOWN, *NEW, *HELD_OUT}:
        parser.error(f"no such scene: {', '.join(unknown)}")
    return options


def run(options):
    """Measures all scenes in the folder `options.work`."""
    rows = []
    shutil.copytree(SCENES, options.work, dirs_exist_ok=True)
    scene_assets.write_assets(os.path.join(options.work, "assets"))
    os.makedirs(options.references or options.work, exist_ok=True)
    dr.set_thread_count(options.threads)
    if options.agreement:
        print(f"{options.resolution} pixels, {options.spp} spp, {options.seeds} seeds of each program\n\n"
              "| scene | t of the image | largest t of 48 tiles | smallest p (Bonferroni) |\n|---|---|---|---|")
        for label in options.scenes:
            agreement(label, options)
        return
    print("Quick look, not for publication: " * options.quick + f"{options.resolution} pixels, {options.spp} spp, "
          f"{options.seeds} seeds, threads: {options.threads}, etalon arguments: {options.etalon_args or 'none'}\n")
    print("| scene | set | Mitsuba, CPU s | MSE | etalon, CPU s | MSE | ratio (90 %) | without the worst 0.1 % "
          "| references: p | images: p |\n|---|---|---|---|---|---|---|---|---|---|")
    for label in options.scenes:
        rows.append(measure(label, options))
        show(rows[-1])
        if options.csv:
            with open(options.csv, "w", newline="") as f:
                writer = csv.DictWriter(f, rows[0])
                writer.writeheader(), writer.writerows(rows)
    for name in SETS:
        if ratios := [row["ratio"] for row in rows if row["set"] == name and row["ratio"] > 0]:
            print(f"\nGeometric mean of {len(ratios)} ratios, {name}: {np.exp(np.mean(np.log(ratios))):.2f}")


if __name__ == "__main__":
    options = arguments()
    with tempfile.TemporaryDirectory() as options.work:
        run(options)
