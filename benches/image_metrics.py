"""Checks `etalon compare` against public implementations of its metrics: MSE, relative MSE and both without the worst
0.1 % against SimpleImageIO, HDR-FLIP against FLIP's authors, PSNR and SSIM against scikit-image, each to a relative error of 1e-6 (MAPE and SMAPE against NumPy).

    pip install numpy simpleimageio flip-evaluator scikit-image
    python benches/image_metrics.py [path of etalon]

SimpleImageIO divides (a - b)^2 by b^2 + epsilon in each channel. Without outliers it leaves out floor(n p) of the n channel
values (not of the pixels), those of the largest error by the same formula, and divides by the number of the others.
"""
import json
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import simpleimageio as sio
    import flip_evaluator as flip
    from skimage.metrics import peak_signal_noise_ratio, structural_similarity
except ImportError as error:
    sys.exit(print(f"skipped: {error}"))

PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "etalon"


def write_pfm(path, image):
    with open(path, "wb") as file:
        file.write(f"PF\n{image.shape[1]} {image.shape[0]}\n-1\n".encode())
        file.write(image[::-1].astype("<f4").tobytes())


def shown(image):
    """Values on a display: clipped to 0..1, encoded by the sRGB curve."""
    linear = np.clip(image.astype(float), 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def measure(folder, a, b):
    write_pfm(f"{folder}/a.pfm", a)
    write_pfm(f"{folder}/b.pfm", b)
    command = [PROGRAM, "compare", f"{folder}/a.pfm", f"{folder}/b.pfm", "--json", "-o", folder]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def main():
    worst = 0.0
    rng = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as folder:
        for width, height, shape in [(50, 20, 1.0), (64, 48, 4.0), (31, 67, 0.3)]:
            # A smooth image with noise of a gamma distribution, which has outliers for small shapes
            y, x = np.mgrid[0:height, 0:width]
            base = np.stack([1 + np.sin(x / 7), 0.5 + y / height, 0.2 + 0.1 * np.cos(x * y / 99)], axis=-1)
            b = base.astype(np.float32)
            a = (base * rng.gamma(shape, 1 / shape, base.shape)).astype(np.float32)
            ours = measure(folder, a, b)
            x, y = a.astype(float), b.astype(float)
            theirs = {
                "mse": sio.mse(a, b),
                "rel_mse": sio.relative_mse(a, b, 0.01),
                "mse_trimmed": sio.mse_outlier_rejection(a, b, 0.1),
                "rel_mse_trimmed": sio.relative_mse_outlier_rejection(a, b, 0.1, 0.01),
                "mape": np.mean(abs(x - y) / (abs(y) + 0.01)),
                "smape": np.mean(abs(x - y) / ((abs(x) + abs(y)) / 2 + 0.01)),
                "psnr": peak_signal_noise_ratio(shown(b), shown(a), data_range=1.0),
                "ssim": structural_similarity(
                    shown(a), shown(b), channel_axis=-1, data_range=1.0, gaussian_weights=True, sigma=1.5, use_sample_covariance=False
                ),
                "hdr_flip": flip.evaluate(b, a, "HDR", applyMagma=False)[1],
            }
            for name, value in theirs.items():
                off = abs(ours[name] / value - 1)
                worst = max(worst, off)
                print(f"{width}x{height} {name:<16} {ours[name]:.9e} {value:.9e} {off:.1e}{'' if off < 1e-6 else '  <--'}")
    print(f"largest relative difference {worst:.1e}")
    return worst >= 1e-6


sys.exit(main())
