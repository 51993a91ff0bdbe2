"use strict";
// A cell without a replay opens its outcome, and one too small for a finger all that lie around it.
for (const grids of document.querySelectorAll("[data-pairs]")) {
  const dialog = document.getElementById("cells"), finger = 24;
  const make = (tag, text, attributes = {}) => Object.assign(document.createElement(tag), { textContent: text, ...attributes });
  const run = location.protocol === "file:" ? decodeURIComponent(location.pathname).replace(/\/[^/]*$/, "") : "RUN";
  const quoted = (text) => (/^[\w.\/-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
  const entry = (cell, condition) => {
    const item = make("li", cell.querySelector("title").textContent), link = cell.getAttribute("href");
    if (link) item.append(make("a", "See both trials", { href: link }));
    else if ("replay" in grids.dataset) item.append(make("code", `faultpath replay ${quoted(run)} --scene=${quoted(cell.dataset.scene)} --condition=${quoted(condition)}`));
    return item;
  };
  grids.addEventListener("click", (event) => {
    const grid = event.target.closest("figure"), coarse = matchMedia("(max-width: 46rem), (pointer: coarse)").matches;
    const near = [...(grid?.querySelectorAll(".pair") ?? [])].filter((cell) => {
      const box = cell.getBoundingClientRect();
      const away = Math.max(Math.abs(event.clientX - box.x - box.width / 2), Math.abs(event.clientY - box.y - box.height / 2));
      return cell.contains(event.target) || (coarse && box.width < finger && away < finger);
    });
    if (!near.length || (near.length === 1 && near[0].hasAttribute("href"))) return;
    event.preventDefault();
    dialog.querySelector("h3").textContent = grid.dataset.title;
    dialog.querySelector("ul").replaceChildren(...near.map((cell) => entry(cell, grid.dataset.condition)));
    dialog.showModal();
  });
  // Whatever is chosen, or a touch beside it, closes it.
  dialog.addEventListener("click", ({ target }) => { if (target.closest("a, button") || target === dialog) dialog.close(); });
}
