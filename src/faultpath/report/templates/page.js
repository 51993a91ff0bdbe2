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
  }

  const choice = document.querySelector("[data-struck-choice]");
  const drawing = document.querySelector("[data-interface]");
  choice?.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    for (const other of choice.querySelectorAll("button")) {
      other.setAttribute("aria-pressed", String(other === button));
    }
    const show = button.dataset.show;
    for (const part of drawing.querySelectorAll("[data-hit]")) {
      const hit = show === "all" || part.dataset.hit.split(" ").includes(show);
      if (part.classList.contains("tag-mark")) part.style.visibility = hit ? "" : "hidden";
      else if (part.classList.contains("wire")) part.classList.toggle("hit", hit);
      else part.querySelector(".tap").classList.toggle("hit", hit);
    }
  });

  // What is folded is printed.
  addEventListener("beforeprint", () => document.querySelectorAll("details.more").forEach((d) => (d.open = true)));
}
