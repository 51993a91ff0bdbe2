// A reader moves the share of episodes with the fault: what to expect of both arms, and who is decided to be ahead.
for (const host of document.querySelectorAll("[data-shares]")) {
  const data = JSON.parse(host.dataset.shares), [path, share] = host.querySelectorAll("select, input");
  data.paths.forEach((each, i) => path.append(new Option(each.title, i, each.primary, each.primary)));
  path.parentElement.hidden = data.paths.length < 2;
  const show = () => {
    const { baseline, repair, decided } = data.paths[path.value], p = Number(share.value);
    const expected = (ends) => ((100 - p) * ends[0] + p * ends[1]) / 100;
    const sign = decided.find(([low, high]) => low <= p && p <= high)?.[2] ?? 0;
    for (const [arm, ends] of [["baseline", baseline], ["repair", repair]]) {
      const row = host.querySelector(`.arm.${arm}`), value = expected(ends);
      row.querySelector(".level").style.width = `${value}%`;
      row.querySelector("output").textContent = `${value.toFixed(1)} %`;
    }
    const ahead = sign ? `${sign > 0 ? data.repair : data.baseline} is ahead.` : "Who is ahead is not decided.";
    host.querySelector(".share").textContent = `${p} %`;
    share.setAttribute("aria-valuetext", `${p} % of the episodes: ${ahead}`);
    const said = host.querySelector(".said");
    said.textContent = ahead;
    said.className = `said ${sign > 0 ? "repair" : sign < 0 ? "baseline" : ""}`;
    const strip = host.querySelector(".strip");
    strip.replaceChildren(...decided.map(([low, high, side]) => {
      const part = document.createElement("span");
      part.className = side > 0 ? "repair" : "baseline";
      part.title = `${side > 0 ? data.repair : data.baseline} ahead, ${low} to ${high} %`;
      [part.style.left, part.style.width] = [`${low}%`, `${Math.max(high - low, 0.5)}%`];
      return part;
    }));
  };
  host.addEventListener("input", show);
  host.hidden = false;
  show();
}
