# %% [markdown]
# # A train on fluid films
#
# A motor and a compressor on four plain journal bearings, described by geometry and oil. Stiffness and damping then
# follow from each journal's load and place in its clearance; what is identified are clearances, viscosities and how
# high the bearings stand.

# %%
import os

import rotorundown as rd

SHORT = "RUNDOWN_SHORT" in os.environ  # as the tests run it
train = rd.read_machine("examples/motor-compressor.yaml")

# %% [markdown]
# A run-down, simulated here, and what it says of the films.

# %%
run = rd.simulate(train, samples=80 if SHORT else 200)
result = rd.identify(train, run)
print(result)

# %% [markdown]
# The shaft's centreline: where each journal stands in its clearance over the speed range. A bearing that is lowered
# gives up load, its journal moves towards the centre, and its film becomes softer: that is how alignment shows in run-
# downs.

# %%
centreline = result.plot_centreline()

# %%
orbits = result.plot_orbit(3000.0)

# %%
frame = result.to_frame()
frame[frame["quantity"].isin({"clearance", "viscosity", "elevation"})]
