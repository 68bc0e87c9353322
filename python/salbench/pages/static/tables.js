// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";
// Tables that sort and filter. Without this script they stand as they are written, in a sensible order.

const salbench = {};

// Compares cells: numbers as numbers, names with numbers in them naturally; what is undefined ("") goes last either way.
salbench.compare = function (a, b, direction) {
  if (a === "" || b === "" || a === null || b === null) return (a === "" || a === null) - (b === "" || b === null);
  const x = Number(a), y = Number(b);
  const order = Number.isNaN(x) || Number.isNaN(y) ? String(a).localeCompare(String(b), "en", {numeric: true}) : x - y;
  return direction * order;
};

// Of numbers, null where one is undefined: their mean, and how pages show one.
salbench.mean = function (values) {
  const known = values.filter((value) => value !== null);
  return known.length ? known.reduce((a, b) => a + b, 0) / known.length : null;
};
salbench.format = (value) => value === null ? "–" : value.toFixed(3).replace("-", "−");

// Marks the column that a table is sorted by, and returns the direction: numbers start with the largest, or the
// smallest where that is better.
salbench.turn = function (header, row, smallestFirst = false) {
  const numeric = header.classList.contains("number");
  const before = header.getAttribute("aria-sort");
  const ascending = before ? before === "descending" : !numeric || smallestFirst;
  for (const other of row.cells) other.removeAttribute("aria-sort");
  header.setAttribute("aria-sort", ascending ? "ascending" : "descending");
  return ascending ? 1 : -1;
};

salbench.sortable = function (table) {
  const head = table.tHead.rows[0], body = table.tBodies[0];
  const key = (row, column) => {
    const cell = row.cells[column];
    return cell.dataset.key !== undefined ? cell.dataset.key : cell.textContent.trim();
  };
  for (const header of head.cells) {
    header.querySelector("button").addEventListener("click", () => {
      const direction = salbench.turn(header, head, header.dataset.better === "lower");
      const rows = Array.from(body.rows);
      rows.sort((a, b) => salbench.compare(key(a, header.cellIndex), key(b, header.cellIndex), direction));
      body.append(...rows);
    });
  }
};

// A menu without "all" chooses what its column holds in every row: the column then need not be seen.
salbench.filterable = function (form) {
  const table = document.getElementById(form.dataset.for), menus = Array.from(form.querySelectorAll("select[data-column]"));
  const text = (cell) => cell.dataset.is || cell.textContent.trim(); // where more stands in the cell than it is chosen by
  table.classList.add("chosen");
  const apply = () => {
    let shown = 0;
    for (const row of table.tBodies[0].rows) {
      row.hidden = !menus.every((menu) => menu.value === "" ? menu.options[0].value === "" : text(row.cells[menu.dataset.column]) === menu.value);
      shown += row.hidden ? 0 : 1;
    }
    form.querySelector("output").textContent = shown + " of " + table.tBodies[0].rows.length + " rows";
  };
  form.addEventListener("change", apply);
  apply();
};

// Of a table in groups of rows, those that the menu names.
salbench.groups = function (form) {
  const menu = form.querySelector("select");
  form.addEventListener("change", () => {
    for (const body of document.getElementById(form.dataset.groups).tBodies) body.hidden = menu.value !== "" && body.dataset.is !== menu.value;
  });
};

// One menu that sets those of all tables below it; it starts with its first metric.
salbench.choose = function (chooser) {
  const menu = chooser.querySelector("select");
  const apply = () => {
    for (const other of document.querySelectorAll("form.filters[data-for] select[data-label=Metric]")) {
      other.value = Array.from(other.options).some((option) => option.value === menu.value) ? menu.value : "";
      other.form.dispatchEvent(new Event("change"));
    }
  };
  chooser.addEventListener("change", apply);
  apply();
  document.documentElement.classList.remove("choosing");  // until here the page has thousands of rows to lay out
};

// What does not fit says that it scrolls.
salbench.scrolling = new ResizeObserver((entries) => {
  for (const {target} of entries) {
    const box = target.closest(".scroll");
    box.toggleAttribute("data-scrolls", box.scrollWidth > box.clientWidth + 1);
  }
});

addEventListener("submit", (event) => event.preventDefault()); // forms hold menus alone
addEventListener("DOMContentLoaded", () => {
  document.querySelectorAll(".scroll, .scroll > *").forEach((part) => salbench.scrolling.observe(part));
  document.querySelectorAll("table.sortable").forEach(salbench.sortable);
  document.querySelectorAll("form.filters[data-for]").forEach(salbench.filterable);
  document.querySelectorAll("form.filters[data-groups]").forEach(salbench.groups);
  document.querySelectorAll("#chooser").forEach(salbench.choose);
});
