#!/usr/bin/env python3
"""CPU time x MSE of `etalon` and of Mitsuba 3 on the scenes of `benches/scenes`, by `etalon converge --runs`.

    python3 -m venv venv && venv/bin/pip install mitsuba numpy     # its LLVM variant also wants libLLVM
    venv/bin/python benches/against_mitsuba.py target/release/etalon --quick
    venv/bin/python benches/against_mitsuba.py target/release/etalon --csv ratios.csv

Mitsuba (LLVM variant, multijitter sampler) renders each .pbrt file, which `pbrt_to_mitsuba.py` translates, by several seeds in one
process. Its images and CPU times, without loading and compiling, go to a folder that `etalon converge` reads beside its own
renders by the strategy that `etalon render` has by default, at the same resolution, depth and threads. The errors are
against two long renders by etalon, whose own noise cancels; `converge` says if a program has another expectation.

The ratio is etalon's CPU time x MSE over Mitsuba's at the last number of samples, below 1 where etalon reaches the same error
sooner, with its 90 % interval (bootstrap over the seeds).
"""
import argparse, csv, json, os, shutil, subprocess, tempfile, time
import drjit as dr, mitsuba as mi, numpy as np
mi.set_variant("llvm_ad_rgb")
import pbrt_to_mitsuba, scene_assets

SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes")
KNOWN = "spheres-5 spheres-100 alpha-0.005 alpha-0.05 alpha-0.25 alpha-0.5 mesh sphere-env".split()
# Nobody tunes the renderer on these.
HELD_OUT = "light-behind-baffle spheres-sky-sun nested-glass lights-occluded ring-caustic door-ajar".split()
NEW = sorted({name[:-5] for name in os.listdir(SCENES) if name.endswith(".pbrt")} - {*KNOWN, *HELD_OUT})
SETS = {"known": KNOWN, "new": NEW, "held-out": HELD_OUT}


def render_by_mitsuba(path, folder, options):
    """Writes Mitsuba's images and their CPU times as `etalon converge --runs` reads them."""
    os.makedirs(folder)
    scene, levels = pbrt_to_mitsuba.load(path, *options.resolution), [options.spp >> 4, options.spp >> 2, options.spp]
    dr.set_thread_count(options.threads)
    for spp in levels:
        mi.render(scene, spp=spp, seed=0).numpy()  # Compiles the kernel.
    rows, images = [], []
    for seed in range(1, options.seeds + 1):
        for spp in levels:
            wall, cpu = time.perf_counter(), time.process_time()
            image = mi.render(scene, spp=spp, seed=seed).numpy()
            rows.append([spp, seed, time.perf_counter() - wall, time.process_time() - cpu])
            images.append(image[:, :, :3])
    # The writer of OpenEXR files waits for a second thread.
    dr.set_thread_count(max(2, options.threads))
    for (spp, seed, *_), image in zip(rows, images):
        mi.Bitmap(image).write(os.path.join(folder, f"spp-{spp}_seed-{seed}.exr"))
    with open(os.path.join(folder, "times.csv"), "w", newline="") as f:
        csv.writer(f).writerows([["spp", "seed", "wall_seconds", "cpu_seconds"], *rows])


def ratio(ours, theirs):
    """The ratio of CPU time x MSE and its 90 % interval; the rows of both are (CPU time, MSE) of one seed."""
    cost, random = lambda rows: rows.mean(-2).prod(-1), np.random.default_rng(1)
    a, b = (rows[random.integers(len(rows), size=(2000, len(rows)))] for rows in (ours, theirs))
    return cost(ours) / cost(theirs), *np.quantile(cost(a) / cost(b), [.05, .95])


def measure(label, options):
    """One row of the results."""
    path, runs = (os.path.join(options.work, name) for name in (f"{label}.pbrt", f"{label}-runs"))
    render_by_mitsuba(path, os.path.join(runs, "mitsuba"), options)
    strategy = "default"
    results = os.path.join(options.work, f"{label}.csv")
    done = subprocess.run(
        [options.program, "converge", path, "-r", *map(str, options.resolution), "-t", str(options.threads), "--runs", runs,
         "--strategies", strategy, "--max-spp", str(options.spp), "--replicates", str(options.seeds), "--budget",
         str(options.budget), "--json", "--quiet", "-o", results], check=True, stdout=subprocess.PIPE)
    curves = {curve["strategy"]: curve for curve in json.loads(done.stdout)["curves"]}
    with open(results.replace(".csv", "-replicates.csv"), newline="") as f:
        rows = [row for row in csv.DictReader(f) if int(row["spp"]) == options.spp]
    side = {name: np.array([[float(row["cpu_seconds"]), float(row["mse"])] for row in rows if row["strategy"] == name])
            for name in curves}
    row = {"scene": label, "set": next(name for name in SETS if label in SETS[name])}
    for name, key in [("mitsuba", "mitsuba"), ("etalon", strategy)]:
        row |= zip([f"{name}_seeds", f"{name}_cpu_seconds", f"{name}_mse"], [len(side[key]), *side[key].mean(0)])
        row[f"{name}_verdict"], row[f"{name}_mean_bias"] = curves[key]["verdict"], curves[key]["mean_bias"]["value"]
    return row | dict(zip(["ratio", "ratio_low", "ratio_high"], ratio(side[strategy], side["mitsuba"])))


def show(row):
    """Prints the row in Markdown."""
    cells = [f"{row[f'{name}_cpu_seconds']:.2f} | {row[f'{name}_mse']:.2e}" for name in ("mitsuba", "etalon")]
    cells.append("{:.2f} ({:.2f} to {:.2f})".format(*(row["ratio" + end] for end in ("", "_low", "_high"))))
    biased = [name for name in ("mitsuba", "etalon") if row[f"{name}_verdict"] == "biased"]
    print(f"| {' | '.join([row['scene'], row['set'], *cells, ', '.join(biased)])} |", flush=True)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    option = parser.add_argument
    option("program", help="the program etalon")
    option("--quick", action="store_true", help="a first look: 4 seeds, 48 x 36 pixels")
    option("--scenes", default="known,new,held-out", help="names of scenes or sets, with commas (default: %(default)s)")
    option("--spp", type=int, default=64, help="samples per pixel, a power of 4 from 16 (default: 64)")
    option("--seeds", type=int, help="renders of each program (default: 16)")
    option("--resolution", type=int, nargs=2, metavar=("W", "H"), help="pixels (default: 80 60)")
    option("--threads", type=int, default=1, help="threads of each program (default: 1)")
    option("--budget", type=float, default=1000, help="most seconds of etalon for each scene (default: %(default)s)")
    option("--csv", metavar="FILE", help="also write the results as CSV")
    options = parser.parse_args()
    seeds, size = (4, [48, 36]) if options.quick else (16, [80, 60])
    options.seeds, options.resolution = options.seeds or seeds, options.resolution or size
    options.scenes = [name for word in options.scenes.split(",") for name in SETS.get(word, [word])]
    if unknown := set(options.scenes) - {*KNOWN, *NEW, *HELD_OUT}:
        parser.error(f"no such scene: {', '.join(unknown)}")
    return options


def run(options):
    """Measures all scenes in the folder `options.work`."""
    rows = []
    shutil.copytree(SCENES, options.work, dirs_exist_ok=True)
    scene_assets.write_assets(os.path.join(options.work, "assets"))
    print("Quick look, not for publication: " * options.quick + f"{options.resolution} pixels, {options.spp} spp, "
          f"{options.seeds} seeds, threads: {options.threads}\n")
    print("| scene | set | Mitsuba, CPU s | MSE | etalon, CPU s | MSE | ratio (90 %) | biased |\n|---|---|---|---|---|---|---|---|")
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
