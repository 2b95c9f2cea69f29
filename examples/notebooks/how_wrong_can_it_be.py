# %% [markdown]
# # How wrong can it be?
#
# Estimates come with intervals. Here simulated runs, whose truth is known, say whether these intervals hold what they
# promise: 95 of a hundred should contain the truth.

# %%
import os

import rotorundown as rd

SHORT = "RUNDOWN_SHORT" in os.environ  # as the tests run it
RUNS = 3 if SHORT else 20
pump = rd.read_machine("examples/motor-pump.yaml")

# %%
inside = counted = 0
errors: list[float] = []
for seed in range(1, RUNS + 1):
    run = rd.simulate(pump, run_seed=seed, samples=120)
    result = rd.identify(pump, run)
    for name, true in (run.truth or {}).items():
        if name not in result:
            continue
        one = result[name]
        if one.value is None or one.lower is None or one.upper is None or one.imaginary is not None:
            continue
        counted += 1
        inside += one.lower <= true <= one.upper
        errors.append((one.value - true) / (one.standard_error or 1.0))

print(f"{inside} of {counted} intervals hold the truth: {100 * inside / counted:.0f} %")

# %% [markdown]
# Errors in units of their own standard error: their mean is the bias, their scatter should be one.

# %%
mean = sum(errors) / len(errors)
scatter = (sum((one - mean) ** 2 for one in errors) / len(errors)) ** 0.5
print(f"bias {mean:+.2f}, scatter {scatter:.2f} standard errors")

# %%
import math

import matplotlib.pyplot as plt

drawn, plot = plt.subplots()
plot.hist(errors, bins=[0.25 * one for one in range(-16, 17)], density=True, color="0.45", label=f"{len(errors)} estimates")
promised = [0.05 * one for one in range(-80, 81)]
plot.plot(promised, [math.exp(-one * one / 2) / math.sqrt(2 * math.pi) for one in promised], label="what intervals promise")
plot.set_xlabel("error over stated standard error")
plotted = plot.legend()
# %% [markdown]
# The same with a model that is wrong: the probes of the driven shaft are said to sit 20° elsewhere. A fit that is off is
# refused, which is what the verdict is for; what it cannot notice no interval can contain.

# %%
driven = pump.couplings[0].driven
wrong = rd.Machine.model_validate(
    pump.model_dump()
    | {"probes": [one.model_dump() | {"angle_deg": one.angle_deg + 20.0 * (one.shaft == driven)} for one in pump.probes]}
)
if not SHORT:  # many starts are tried before a fit is given up: a minute
    print(rd.identify(wrong, rd.simulate(pump, samples=120)).verdict)
