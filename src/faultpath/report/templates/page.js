"use strict";
// Pictures that answer to the pointer: the grid of pairs and the interface drawing.
{
  const cells = document.querySelectorAll("[data-pairs] .pair");
  const byScene = new Map();
  for (const cell of cells) {
    const scene = cell.dataset.scene;
    if (!byScene.has(scene)) byScene.set(scene, []);
    byScene.get(scene).push(cell);
  }
  for (const cell of cells) {
    const light = (on) => byScene.get(cell.dataset.scene).forEach((c) => c.classList.toggle("lit", on));
    cell.addEventListener("pointerenter", () => light(true));
    cell.addEventListener("pointerleave", () => light(false));
    cell.addEventListener("focus", () => light(true));
    cell.addEventListener("blur", () => light(false));
  }

  // A grid is one stop of the tab key; arrow keys go from link to link, as they stand.
  for (const grid of document.querySelectorAll("[data-pairs] svg")) {
    const links = [...grid.querySelectorAll("a")];
    links.forEach((link, i) => link.setAttribute("tabindex", i ? "-1" : "0"));
    grid.addEventListener("keydown", (event) => {
      const toward = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      const from = event.target.closest("a");
      if (!toward || !from) return;
      event.preventDefault();
      const middle = (link) => { const r = link.getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]; };
      const [x, y] = middle(from);
      const ahead = links.map((link) => [link, ...middle(link)])
        .map(([link, u, v]) => [link, (u - x) * toward[0] + (v - y) * toward[1], Math.abs((u - x) * toward[1]) + Math.abs((v - y) * toward[0])])
        .filter(([, along]) => along > 2).sort((a, b) => a[1] + 5 * a[2] - b[1] - 5 * b[2]);
      if (!ahead.length) return;
      from.setAttribute("tabindex", "-1");
      ahead[0][0].setAttribute("tabindex", "0");
      ahead[0][0].focus();
    });
  }

  const choice = document.querySelector("[data-struck-choice]");
  choice?.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    for (const other of choice.querySelectorAll("button")) {
      other.setAttribute("aria-pressed", String(other === button));
    }
    const show = button.dataset.show;
    for (const part of document.querySelectorAll("[data-interface] [data-hit]")) {
      const hit = show === "all" || part.dataset.hit.split(" ").includes(show);
      if (part.classList.contains("tag-mark")) part.style.visibility = hit ? "" : "hidden";
      else if (part.classList.contains("wire")) part.classList.toggle("hit", hit);
      else part.querySelector(".tap").classList.toggle("hit", hit);
    }
  });

  // What is folded is printed.
  addEventListener("beforeprint", () => document.querySelectorAll("details.more").forEach((d) => (d.open = true)));
}
