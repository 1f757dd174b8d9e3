"""PyTorch 2.15.0: what findings/torch.toml says, without the bench. Run it with catalogue/.env/torch/bin/python."""

import mpmath
import torch
from torch import distributions as D

print("VonMises, 20000: the sum of exp(log_prob) over 2·10⁶ equal steps within 0.05 of the mean")
x = torch.linspace(0.45, 0.55, 2_000_001, dtype=torch.float64)
for kind in (torch.float32, torch.float64):
    law = D.VonMises(torch.tensor(0.5, dtype=kind), torch.tensor(20000.0, dtype=kind))
    peak = law.log_prob(torch.tensor(0.5, dtype=kind)).double()
    print(f"  {kind}: {float(law.log_prob(x).exp().sum() * 0.1 / 2e6):.6f}; log pdf at the mean {float(peak):.6f}")
print(f"  by mpmath, log pdf at the mean: {float(20000 - mpmath.log(2 * mpmath.pi * mpmath.besseli(0, 20000))):.6f}")

torch.manual_seed(1)
law = D.Kumaraswamy(torch.tensor(0.5), torch.tensor(0.5))
x = law.sample((1_000_000,))
print(f"Kumaraswamy(0.5, 0.5), float32: {int((x == 1).sum())} of 10⁶ samples are 1.0; log_prob(1.0) = {float(law.log_prob(torch.tensor(1.0)))}; the density there is infinite")
print(f"  P(X > 1 - 2⁻²⁵) = {float((1 - (1 - 2**-25) ** 0.5) ** 0.5):.2e}")

x = D.Normal(torch.tensor(1000.0), torch.tensor(0.1)).sample((1_000_000,))
print(f"Normal(1000, 0.1), float32: {len(x.unique())} values in 10⁶ samples; neighbours of 1000 are {float(torch.nextafter(torch.tensor(1000.0), torch.tensor(2000.0)) - 1000):.2e} away")

for parameters in ((0, 1, 0.3), (0, 1, -0.3), (0, 1, 0)):
    law = D.GeneralizedPareto(*(torch.tensor(float(p), dtype=torch.float64) for p in parameters))
    for name, call in (("sample", lambda: law.sample((3,)).dtype), ("log_prob", lambda: law.log_prob(torch.tensor(0.5, dtype=torch.float64)))):
        try:
            print(f"GeneralizedPareto{parameters}, float64: {name}: {call()}")
        except RuntimeError as error:
            print(f"GeneralizedPareto{parameters}, float64: {name}: RuntimeError: {error}")

for kind in (torch.float32, torch.float64):
    law = D.Binomial(1000, torch.tensor(0.7, dtype=kind))
    print(f"Binomial(1000, 0.7), {kind}: the probabilities of 0 to 1000 add up to {float(law.log_prob(torch.arange(1001, dtype=kind)).double().exp().sum()):.6f}")
