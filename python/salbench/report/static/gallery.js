// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";
// The gallery: changes the pictures of its tiles, and sorts and filters them. Without it they show the ground truth, by name.

salbench.showGallery = function (root, data) {
  const form = root.querySelector("form"), list = root.querySelector("ul");
  const tiles = Array.from(list.children, (element, i) => ({element, shape: data.shapes[i], place: i}));
  const part = (name) => form.querySelector(`[data-part=${name}]`);

  const score = (shape, metric, model) => model === "" ? salbench.mean(shape.scores[metric]) : shape.scores[metric][model];
  const disagreement = (shape, metric) => {
    const scores = shape.scores[metric].filter((score) => score !== null);
    return scores.length > 1 ? Math.max(...scores) - Math.min(...scores) : null;
  };

  const keys = {
    name: () => [(tile) => tile.place, 1],
    class: () => [(tile) => tile.shape.class, 1],
    worst: (metric, model) => [(tile) => score(tile.shape, metric, model), data.lower.includes(metric) ? -1 : 1],
    best: (metric, model) => [(tile) => score(tile.shape, metric, model), data.lower.includes(metric) ? 1 : -1],
    disagreement: (metric) => [(tile) => disagreement(tile.shape, metric), -1],
  };

  const apply = () => {
    const [map, group, metric, model, order] = ["map", "class", "metric", "model", "order"].map((name) => part(name).value);
    let shown = 0;
    for (const {element, shape} of tiles) {
      const picture = shape.pictures[map], image = element.querySelector("img");
      element.hidden = !picture || (group !== "" && group !== "=" + shape.class);
      shown += element.hidden ? 0 : 1;
      if (picture && image.getAttribute("src") !== picture) image.src = picture;
      element.querySelector(".scores").textContent = [shape.class, data.metrics[metric] + " " + salbench.format(score(shape, metric, model)),
        "disagreement " + salbench.format(disagreement(shape, metric))].filter(Boolean).join(", ");
    }
    const [key, direction] = keys[order](metric, model);
    tiles.sort((a, b) => salbench.compare(key(a), key(b), direction) || a.place - b.place);
    list.append(...tiles.map((tile) => tile.element));
    const differences = map.endsWith(", difference to the ground truth");
    for (const bar of root.querySelectorAll("[data-bar]")) bar.hidden = (bar.dataset.bar === "diverging") !== differences;
    form.querySelector("output").textContent = shown + " of " + tiles.length + " shapes";
  };
  form.addEventListener("change", apply);
  form.hidden = false;
  apply();
};

addEventListener("DOMContentLoaded", () => salbench.showGallery(document.getElementById("gallery"), salbench.gallery));
