# SPDX-License-Identifier: GPL-3.0-or-later
# ---
# jupyter: {kernelspec: {name: python3}}
# ---
# %% [markdown]
# # The table of the paper
# Mean scores of the models on the meshes of SHREC'07, beside your model. The unit is the mesh: intervals are over
# meshes.

# %%
import salbench

# %% [markdown]
# A model is a function of a shape that returns a value per point: here the distance from the centroid.


# %%
def centre(shape):
    from_centroid = shape.points - shape.points.mean(axis=0)
    return (from_centroid**2).sum(axis=1) ** 0.5


# %% [markdown]
# The first run computes everything that is not in the cache; the next one, nothing.

# %%
models = {"CENTRE": centre, "LS": {}, "CS": {}, "PS": {}, "MS": {}, "RS": {}}
results = salbench.run("shrec07_meshes", data="SchellingData", items="scored", models=models, cache="salbench-cache",
                       out="salbench-out/table")
results

# %% [markdown]
# Means of the paper's metrics with their 95 % intervals, and the groups of models that do not differ significantly.

# %%
table = results.summary.pivot(index="model", columns="metric", values="mean")
table[["auc", "nss", "lcc"]].round(3)

# %%
results.ranking
