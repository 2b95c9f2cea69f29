# %% [markdown]
# # Alignment over a year of run-downs, from a running service
#
# `rundown demo` runs a service with three simulated machines, of which the pump's coupling goes out of alignment, and
# prints its address. Give it here as RUNDOWN_URL. Nothing of the service has to be installed where this runs.

# %%
import os

import rotorundown as rd

service = rd.Service(os.environ.get("RUNDOWN_URL", "http://localhost:8080"))
service.machines().to_frame()

# %% [markdown]
# The coupling's stiffness over all run-downs. Values of fits that were not accepted are left out.

# %%
points = service.trend("motor-pump", "coupling.C1.kxx", "bearing.B2.kxx").to_frame()
accepted = points[points["quality"] == "accepted"]
for name, history in accepted.groupby("parameter"):
    first, last = history["value"].iloc[0], history["value"].iloc[-1]
    print(f"{name}: {first:.3g} to {last:.3g} N/m, {100 * (last / first - 1):+.1f} % in {len(history)} runs")

# %%
curves = accepted.pivot(index="measured_at", columns="parameter", values="value").plot(
    subplots=True, style="o", ylabel="N/m", xlabel=""
)

# %% [markdown]
# What the service made of it:

# %%
for alert in service.alerts("motor-pump", only_open=True):
    print(alert.severity, alert.element, alert.message, sep=": ")

# %% [markdown]
# Any recorded run can be taken home and fitted here, for a second opinion.

# %%
runs = service.runs("motor-pump")
if len(runs):
    print(rd.identify(service.machine("motor-pump"), service.run(runs[0].id)))
