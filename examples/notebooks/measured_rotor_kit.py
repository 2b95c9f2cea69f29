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
# How the kit should respond from now on, by its calibrated document:

# %%
speeds = [600.0, 1000.0, 1200.0]
response = rd.model(calibrated.machine).response(speeds)
for speed, amplitude in zip(speeds, response.amplitude, strict=True):
    print(f"{speed:.0f} r/min:", ", ".join(f"{2e6 * one:.1f} µm pp" for one in amplitude))
