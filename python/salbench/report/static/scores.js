// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";
// The table of all shapes: sorts and filters thousands of rows in memory, and shows a page of them.

salbench.ROWS = 100; // per page

salbench.scoreTable = function (root, data) {
  const form = root.querySelector("form"), table = root.querySelector("table");
  const part = (name) => form.querySelector(`[data-part=${name}]`);
  const state = {metric: part("metric").value, column: 0, direction: 1, page: 0, rows: []};

  const models = () => Array.from(form.querySelectorAll("input[name=model]:checked"), (box) => Number(box.value));

  // Columns: a head, the key that a row is sorted by, and what fills its cell.
  const columns = () => {
    const scores = data.scores[state.metric], shown = models();
    const mean = (row) => salbench.mean(shown.map((model) => scores[row][model]));
    const text = (field) => ({head: ["Data set", "Mesh", "Class", "Scan"][field], key: (row) => data.shapes[row][field]});
    const number = (head, key) => ({head, key, numeric: true});
    return [text(1), text(0), text(2), text(3),
      ...shown.map((model) => number(data.models[model], (row) => scores[row][model])), number("Mean", mean)];
  };

  const cell = (column, row, first) => {
    const made = document.createElement(first ? "th" : "td");
    if (first) made.scope = "row";
    if (column.numeric) made.className = "number";
    const text = column.numeric ? salbench.format(column.key(row)) : column.key(row);
    if (first && data.shapes[row][4]) {
      const link = document.createElement("a");
      link.href = data.shapes[row][4];
      link.textContent = text;
      made.append(link);
    } else {
      made.textContent = text;
    }
    return made;
  };

  const render = () => {
    const shown = columns();
    const from = state.page * salbench.ROWS, rows = state.rows.slice(from, from + salbench.ROWS);
    table.tBodies[0].replaceChildren(...rows.map((row) => {
      const line = document.createElement("tr");
      line.append(...shown.map((column, index) => cell(column, row, index === 0)));
      return line;
    }));
    form.querySelector("output").textContent = state.rows.length
      ? `rows ${from + 1} to ${from + rows.length} of ${state.rows.length}` : "no row";
    for (const button of root.querySelectorAll(".pager button")) {
      const page = state.page + Number(button.dataset.step);
      button.disabled = page < 0 || page * salbench.ROWS >= state.rows.length;
    }
  };

  const arrange = () => {
    const wanted = part("class").value, set = part("set").value, shown = columns();
    const words = part("search").value.toLowerCase().split(/\s+/);
    const column = shown[Math.min(state.column, shown.length - 1)];
    const keyed = [];
    data.shapes.forEach((shape, row) => {
      const text = `${shape[1]} ${shape[2]}`.toLowerCase();
      if ((wanted === "" || wanted === "=" + shape[2]) && (set === "" || set === shape[0]) && words.every((word) => text.includes(word)))
        keyed.push([column.key(row), row]);
    });
    keyed.sort((a, b) => salbench.compare(a[0], b[0], state.direction) || a[1] - b[1]);
    state.rows = keyed.map((pair) => pair[1]);
    state.page = 0;
    render();
  };

  const heads = () => {
    const line = table.tHead.rows[0];
    line.replaceChildren(...columns().map((column, index) => {
      const head = document.createElement("th"), button = document.createElement("button");
      head.scope = "col";
      if (column.numeric) head.className = "number";
      if (index === state.column) head.setAttribute("aria-sort", state.direction > 0 ? "ascending" : "descending");
      button.type = "button";
      const text = document.createElement("span");
      text.className = "column";
      text.textContent = column.head;
      if (data.titles[column.head]) text.title = data.titles[column.head];
      button.append(text);
      button.addEventListener("click", () => {
        state.direction = salbench.turn(head, line, data.lower.includes(state.metric));
        state.column = index;
        arrange();
      });
      head.append(button);
      return head;
    }));
  };

  // Scores of a metric that the page's own script leaves out come from another one.
  const show = (metric) => {
    if (data.scores[metric]) {
      state.metric = metric;
      heads();
      arrange();
      return;
    }
    const script = document.createElement("script");
    script.src = data.files[metric];
    script.addEventListener("load", () => { if (part("metric").value === metric) show(metric); });
    document.head.append(script);
  };

  form.addEventListener("change", (event) => {
    if (event.target.name === "model") { state.column = 0; state.direction = 1; }
    show(part("metric").value);
  });
  part("search").addEventListener("input", arrange);
  for (const button of root.querySelectorAll(".pager button")) {
    button.addEventListener("click", () => { state.page += Number(button.dataset.step); render(); });
  }
  show(state.metric);
  root.hidden = false;
};

addEventListener("DOMContentLoaded", () => salbench.scoreTable(document.getElementById("scores"), salbench.scores));
