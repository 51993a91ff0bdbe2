"use strict";
// What is folded is printed.
addEventListener("beforeprint", () => document.querySelectorAll("details.more").forEach((d) => (d.open = true)));

// The lines of "why" are drawn anew, in the time that they took.
for (const button of document.querySelectorAll("#why-play")) {
  const strips = [...document.querySelectorAll(".adding .until")], whole = strips.map((strip) => Number(strip.getAttribute("width")));
  let frame = 0;
  const show = (share) => strips.forEach((strip, n) => strip.setAttribute("width", whole[n] * share));
  const stop = () => { cancelAnimationFrame(frame); frame = 0; show(1); button.textContent = "Play"; };
  button.hidden = false;
  button.addEventListener("click", () => {
    if (frame) return stop();
    const began = performance.now();
    const draw = (now) => {
      const share = Math.max(0, now - began) / 1000 / Number(button.dataset.seconds);
      if (share >= 1) return stop();
      show(share);
      frame = requestAnimationFrame(draw);
    };
    button.textContent = "Stop";
    frame = requestAnimationFrame(draw);
  });
}
