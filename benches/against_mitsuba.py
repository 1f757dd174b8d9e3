#!/usr/bin/env python3
"""CPU time x MSE of `etalon` and of Mitsuba 3 on the scenes of `benches/scenes`, by `etalon converge --runs`.

    python3 -m venv venv && venv/bin/pip install mitsuba numpy     # its LLVM variant also wants libLLVM
    venv/bin/python benches/against_mitsuba.py target/release/etalon --quick
    venv/bin/python benches/against_mitsuba.py target/release/etalon --csv ratios.csv

Mitsuba (LLVM variant, multijitter sampler) renders each .pbrt file, which `pbrt_to_mitsuba.py` translates, by several seeds in one
process. Its images and CPU times, without loading and compiling, go to a folder that `etalon converge` reads beside its own
renders by the strategy that `etalon render` has by default, at the same resolution, depth and threads. The errors are
against two long renders by etalon, whose own noise cancels; `converge` says if a program has another expectation.

Each ratio is etalon's CPU time x MSE over Mitsuba's, below 1 where etalon reaches the same error sooner, with its 90 %
interval (bootstrap over the seeds): at 4, 8, 16 and 64 samples per pixel; without the worst 0.1 % of channel values; and with
what each program needs before the first sample (Mitsuba: reading the scene a second time, which compiles nothing). The last
column is the CPU time of a sample at equal techniques: etalon's `mis` (one camera path a sample, light and BSDF samples, the map by its
radiance) over Mitsuba's, at 64 samples per pixel, as the ratio of the medians over the seeds.
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
# Samples per pixel.
LEVELS = [4, 8, 16, 64]
SETS = {"known": KNOWN, "new": NEW, "held-out": HELD_OUT}


def render_by_mitsuba(path, folder, options):
    """Writes Mitsuba's images and their CPU times as `etalon converge --runs` reads them."""
    os.makedirs(folder)
    dr.set_thread_count(options.threads)
    pbrt_to_mitsuba.load(path, *options.resolution)
    start = time.process_time()
    scene = pbrt_to_mitsuba.load(path, *options.resolution)
    set_up = time.process_time() - start
    for spp in LEVELS:
        mi.render(scene, spp=spp, seed=0).numpy()  # Compiles the kernel.
    rows, images = [], []
    for seed in range(1, options.seeds + 1):
        for spp in LEVELS:
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
    return set_up


def ratio(ours, theirs, set_ups=(0, 0)):
    """The ratio of (set-up + CPU time) x MSE and its 90 % interval; the rows of both are (CPU time, MSE) of one seed."""
    cost, random = lambda rows: rows.mean(-2).prod(-1), np.random.default_rng(1)
    ours, theirs = ours + [set_ups[0], 0], theirs + [set_ups[1], 0]
    a, b = (rows[random.integers(len(rows), size=(2000, len(rows)))] for rows in (ours, theirs))
    return cost(ours) / cost(theirs), *np.quantile(cost(a) / cost(b), [.05, .95])


def time_ratio(ours, theirs):
    """The ratio of the median CPU times and its 90 % interval, from the same rows."""
    random = np.random.default_rng(1)
    a, b = (np.median(rows[random.integers(len(rows), size=(2000, len(rows))), 0], -1) for rows in (ours, theirs))
    return np.median(ours[:, 0]) / np.median(theirs[:, 0]), *np.quantile(a / b, [.05, .95])


def measure(label, options):
    """The results of a scene: a row for each number of samples."""
    path, runs = (os.path.join(options.work, name) for name in (f"{label}.pbrt", f"{label}-runs"))
    set_up = render_by_mitsuba(path, os.path.join(runs, "mitsuba"), options)
    strategy, equal = "default", "mis"
    results = os.path.join(options.work, f"{label}.csv")
    done = subprocess.run(
        [options.program, "converge", path, "-r", *map(str, options.resolution), "-t", str(options.threads), "--runs", runs,
         "--strategies", f"{strategy},{equal}", "--max-spp", str(LEVELS[-1]), "--replicates", str(options.seeds), "--budget",
         str(options.budget), "--json", "--quiet", "-o", results], stdout=subprocess.PIPE)
    if done.returncode not in (0, 1):  # 1 says that a program is biased.
        raise SystemExit(f"{path}: converge ended with exit code {done.returncode}")
    curves = {curve["strategy"]: curve for curve in json.loads(done.stdout)["curves"]}
    with open(results.replace(".csv", "-replicates.csv"), newline="") as f:
        replicates = list(csv.DictReader(f))
    set_ups, results = (curves[strategy]["preparation_seconds"], set_up), []
    for spp in LEVELS:
        of = lambda name, mse: np.array([[float(row["cpu_seconds"]), float(row[mse])] for row in replicates
                                         if int(row["spp"]) == spp and row["strategy"] == name])
        row = {"scene": label, "set": next(name for name in SETS if label in SETS[name]), "spp": spp}
        for name, key, seconds in [("mitsuba", "mitsuba", set_up), ("etalon", strategy, set_ups[0])]:
            side = of(key, "mse")
            row |= zip([f"{name}_seeds", f"{name}_set_up", f"{name}_cpu_seconds", f"{name}_mse"], [len(side), seconds, *side.mean(0)])
            row[f"{name}_verdict"], row[f"{name}_mean_bias"] = curves[key]["verdict"], curves[key]["mean_bias"]["value"]
        for name, mse, both in [("ratio", "mse", (0, 0)), ("trimmed", "mse_trimmed", (0, 0)), ("set_up", "mse", set_ups)]:
            values = ratio(of(strategy, mse), of("mitsuba", mse), both)
            row |= zip([name, f"{name}_low", f"{name}_high"], values)
        row |= zip(["sample_time", "sample_time_low", "sample_time_high"], time_ratio(of(equal, "mse"), of("mitsuba", "mse")))
        results.append(row)
    return results


def show(rows):
    """Prints the rows of a scene in Markdown, as one."""
    last = rows[-1]
    cells = [f"{row['ratio']:.2f} ({row['ratio_low']:.2f} to {row['ratio_high']:.2f})" for row in rows]
    cells += [f"{row[name]:.2f}" for name in ("trimmed", "set_up") for row in rows[-2:]]
    cells.append("{sample_time:.2f} ({sample_time_low:.2f} to {sample_time_high:.2f})".format(**last))
    biased = [name for name in ("mitsuba", "etalon") if last[f"{name}_verdict"] == "biased"]
    print(f"| {' | '.join([last['scene'], last['set'], *cells, ', '.join(biased)])} |", flush=True)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    option = parser.add_argument
    option("program", help="the program etalon")
    option("--quick", action="store_true", help="a first look: 4 seeds, 48 x 36 pixels")
    option("--scenes", default="known,new,held-out", help="names of scenes or sets, with commas (default: %(default)s)")
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
    print("Quick look, not for publication: " * options.quick + f"{options.resolution} pixels, {options.seeds} seeds, "
          f"threads: {options.threads}\n")
    columns = ["scene", "set", *(f"{spp} spp (90 %)" for spp in LEVELS),
               *(f"{spp} spp, {how}" for how in ("trimmed", "with set-up") for spp in LEVELS[-2:]), "time of a sample (90 %)", "biased"]
    print(f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}")
    for label in options.scenes:
        rows += (results := measure(label, options))
        show(results)
        if options.csv:
            with open(options.csv, "w", newline="") as f:
                writer = csv.DictWriter(f, rows[0])
                writer.writeheader(), writer.writerows(rows)
    print(f"\n| geometric mean of | scenes | {' | '.join(columns[2:-1])} |\n|{'---|' * (len(columns) - 1)}")
    for name in [*SETS, "all"]:
        if not (chosen := [row for row in rows if name in (row["set"], "all")]):
            continue
        mean = lambda key, spp: np.exp(np.mean([np.log(row[key]) for row in chosen if row["spp"] == spp and row[key] > 0]))
        means = [mean("ratio", spp) for spp in LEVELS] + [mean(key, spp) for key in ("trimmed", "set_up") for spp in LEVELS[-2:]]
        means.append(mean("sample_time", LEVELS[-1]))
        print(f"| {name} | {len(chosen) // len(LEVELS)} | {' | '.join(f'{value:.2f}' for value in means)} |")


if __name__ == "__main__":
    options = arguments()
    with tempfile.TemporaryDirectory() as options.work:
        run(options)
