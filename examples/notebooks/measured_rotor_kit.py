# %% [markdown]
# # Calibration on a measured rotor kit
#
# A Bently Nevada RK-4 rotor kit was measured with known unbalances in its two discs (data and licence:
# tests/data/README.md). Of the kit only the nameplate is known: no gain, phase or stiffness. Runs with known unbalances
# give all that the numbers of later runs rest on.

# %%

import rotorundown as rd

kit = rd.read_machine("examples/rk4-rotor-kit-four-probes.yaml")
calibrated = rd.calibrate(kit, ["examples/recordings/rk4_unbalance_1x.csv"])
print(calibrated)

# %% [markdown]
# The calibrated document holds values and their joint covariance; later fits start from it.
# `calibrated.write("kit.yaml")` keeps it.

# %%
found = calibrated.machine.calibration
assert found is not None
print(len(found.parameters), "parameters from", found.runs[0].samples, "samples")

# %% [markdown]
# How the kit's shaft should move from now on with its own unbalance, by its calibrated document:

# %%
updated = rd.model(calibrated.machine)
print(updated.response([600, 1000, 1200]))

# %%
import matplotlib.pyplot as plt

response = updated.response(range(600, 1205, 5))
drawn, plot = plt.subplots()
plot.plot(response.speed_rpm, response.amplitude_um_pp, label=response.channels)
plot.set_xlabel("r/min")
plot.set_ylabel("1× of the shaft [µm pp]")
plotted = plot.legend()
