# %% [markdown]
# # The packaged FMUs in FMPy
#
# `videg.fmu` is the path of an FMU (FMI 2.0) that the package brings; `videg.start_values` are the parameters of a case.

# %%
import fmpy
import numpy as np
import videg

values = {name: it.fmi for name, it in videg.start_values("fig14").items()}
result = fmpy.simulate_fmu(
    videg.fmu("VibroImpactHarvester"),
    stop_time=5.0,
    output_interval=1e-3,
    start_values=values,
    output=["left.capacitance", "right.capacitance"],
)
print(f"{len(result)} rows, largest C of the left membrane {1e12 * result['left.capacitance'].max():.2f} pF")

# %% [markdown]
# The package runs the same model without FMPy.

# %%
own = videg.simulate("fig14", until=5.0, sample=1e-3)
difference = np.abs(result["left.capacitance"][: len(own.time)] - own["left.capacitance"]).max()
print(f"largest difference {difference / own['left.capacitance'].max():.1e} of the largest C")
