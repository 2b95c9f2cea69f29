# %% [markdown]
# # A first rotor, from a CSV file
#
# A motor and a pump, each on two bearings, with a coupling between them. The machine is a document, the run a table:
# speed, and amplitude and phase of each probe. Run this from the project's folder; `rundown init` writes a document of
# your own to begin with.

# %%
from pathlib import Path
from tempfile import mkdtemp

import rotorundown as rd

pump = rd.read_machine("examples/motor-pump.yaml")

# %% [markdown]
# Your run would be a CSV file already. Here one is simulated and written, as an instrument's export might look.

# %%
file = Path(mkdtemp()) / "run.csv"
rd.simulate(pump).to_frame().to_csv(file, index=False)
print("\n".join(file.read_text().splitlines()[:3]))

# %% [markdown]
# Speeds are r/min, amplitudes µm peak-to-peak, phases lag in degrees, unless `read_run` is told otherwise; it says how
# it has read.

# %%
run = rd.read_run(file, machine=pump)
print(run)

# %% [markdown]
# **Look at the verdict first**: estimates of a fit that is not accepted are not to be used.

# %%
result = rd.identify(pump, run)
print(result)

# %%
result["coupling.C1.kxx"]

# %%
result.to_frame()[["value", "lower", "upper", "unit"]]

# %% [markdown]
# Points are measured, lines are the model with the values found, bands its 95 % interval.

# %%
bode = result.plot_bode()

# %%
polar = result.plot_polar(["B1L"])

# %% [markdown]
# What follows from the values: critical speeds, and the unbalances to add for least vibration at working speed.

# %%
updated = rd.model(result)
print(updated.critical_speeds())

# %%
correction = updated.balance(2980)
print(correction)

# %%
train = result.plot_train()
