# %% [markdown]
# # Which measurement would help?
#
# What a run does not determine has no value, but a reason. Before a probe is bought or another run is asked for, the
# information of the run that there is says what each would bring.

# %%
import os

import rotorundown as rd

SHORT = "RUNDOWN_SHORT" in os.environ  # as the tests run it
pump = rd.read_machine("examples/motor-pump.yaml")
few = pump.probes[:6]  # none at the last bearing
thin = rd.Machine.model_validate(pump.model_dump() | {"probes": [one.model_dump() for one in few]})
run = rd.simulate(thin, samples=60)
result = rd.identify(thin, run)
print([f"{name}: {result[name].reason}" for name in result if not result[name].estimable][:5])

# %% [markdown]
# By how much the standard errors would shrink together with one more sample at a speed, or one more probe:

# %%
speeds = result.helpful_speeds(count=1 if SHORT else 3)
for speed in speeds:
    print(f"{speed.what}: by {100 * (1 - speed.shrinkage):.1f} %")

# %%
probes = result.helpful_probes(count=1 if SHORT else 3)
for probe in probes:
    print(f"{probe.what}: by {100 * (1 - probe.shrinkage):.1f} %")

# %%
import matplotlib.pyplot as plt

drawn, plot = plt.subplots(figsize=(8.0, 3.0), layout="constrained")
helps = [*speeds, *probes]
plot.barh([one.what for one in helps], [100 * (1 - one.shrinkage) for one in helps])
plot.invert_yaxis()
plotted = plot.set_xlabel("standard errors shrink together by [%]")
# %% [markdown]
# Tried: the same run with all probes of the machine.

# %%
if not SHORT:
    whole = rd.identify(pump, rd.simulate(pump, samples=60))
    name = "coupling.C1.kxx"
    for fitted, probed in ((result, "without probes at the last bearing"), (whole, "with all probes")):
        print(f"standard error of {name} {probed}: {fitted[name].standard_error:.3g} N/m")
