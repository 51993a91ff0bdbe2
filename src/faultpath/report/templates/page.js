"use strict";
{
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

  // What is folded is printed.
  addEventListener("beforeprint", () => document.querySelectorAll("details.more").forEach((d) => (d.open = true)));
}
