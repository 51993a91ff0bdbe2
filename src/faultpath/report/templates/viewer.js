// The controls of the flights: scene, path and time; every change redraws the three views.
if (document.getElementById("viewer-data")) {
  const data = JSON.parse(document.getElementById("viewer-data").textContent);
  const get = (id) => document.getElementById(`viewer-${id}`);
  const view = new Scene3D(get("3d"));
  const state = { scene: 0, path: data.paths[data.paths.length - 1].name, step: 0, playing: null };
  const current = () => data.scenes[state.scene];
  const pair = () => current().pairs.find((p) => p.path === state.path) ?? current().pairs[0];
  const last = () => Math.max(...Flight.arms.map((arm) => Flight.steps(pair()[arm].track_cm))) - 1;
  const number = (value, digits, unit) => (value === null ? "" : `${value.toFixed(digits)} ${unit}`);
  const words = {
    both: "On the path shown both succeed.", "repair-only": "On the path shown only the repair succeeds.",
    "baseline-only": "On the path shown only the baseline succeeds.", neither: "On the path shown neither succeeds.",
  };

  const redraw = () => {
    const scene = current(), shown = pair();
    drawPlan(get("plan"), scene, shown, state.step, data);
    drawHeight(get("height"), scene, shown, state.step, data);
    view.show({ scene, pair: shown, step: state.step, data });
    get("clock").textContent = `${(state.step * data.dt_s).toFixed(2)} s`;
  };

  const term = (name, value, cls = "") => {
    const [box, dt, dd] = ["div", "dt", "dd"].map((tag) => document.createElement(tag));
    dt.textContent = name; dt.className = cls; dd.textContent = value;
    box.append(dt, dd);
    return box;
  };

  const reset = () => {
    const shown = pair();
    state.step = last();
    get("time").max = String(last());
    get("time").value = String(state.step);
    get("name").textContent = `${current().scene}, ${data.paths.find((p) => p.name === shown.path).title}`;
    get("why").textContent = `${current().why} ${words[shown.kind] ?? ""}`;
    for (const button of get("paths").querySelectorAll("button")) {
      button.setAttribute("aria-pressed", String(button.dataset.path === shown.path));
      button.disabled = !current().pairs.some((p) => p.path === button.dataset.path);
    }
    const arms = Flight.arms.map((arm) => {
      const end = shown[arm];
      const sign = { success: "✓", crash: "✕", timeout: "□" }[end.status] ?? "□";
      const line = { baseline: "dashed", repair: "solid" }[arm];
      const parts = [`${sign} ${end.ended}`, number(end.time_s, 2, "s"), end.terminal_distance_m === null ? "" : `${number(end.terminal_distance_m, 2, "m")} from the goal`];
      return term(`${arm}: ${data[arm]} (${line})`, parts.filter(Boolean).join(", "), arm);
    });
    const parting = shown.parting_step === null
      ? `never more than ${data.parting_m} m`
      : `□ more than ${data.parting_m} m from ${(shown.parting_step * data.dt_s).toFixed(2)} s on`;
    get("ends").replaceChildren(...arms, term("apart", parting));
    redraw();
  };

  const stop = () => { clearInterval(state.playing); state.playing = null; get("play").textContent = "Play"; };
  get("scene").addEventListener("change", (e) => { stop(); state.scene = Number(e.target.value); reset(); });
  get("paths").addEventListener("click", (e) => {
    const button = e.target.closest("button");
    if (button) { stop(); state.path = button.dataset.path; reset(); }
  });
  get("time").addEventListener("input", (e) => { stop(); state.step = Number(e.target.value); redraw(); });
  get("play").addEventListener("click", () => {
    if (state.playing) { stop(); return; }
    if (state.step >= last()) state.step = 0;
    get("play").textContent = "Pause";
    state.playing = setInterval(() => {
      if (state.step >= last()) { stop(); return; }
      state.step += 1;
      get("time").value = String(state.step);
      redraw();
    }, 1000 * data.dt_s);
  });
  // A picture that waits for a resize or for a change of colours is drawn in the next frame.
  let waiting = 0;
  const soon = () => { cancelAnimationFrame(waiting); waiting = requestAnimationFrame(redraw); };
  window.addEventListener("resize", soon);
  window.addEventListener("beforeprint", redraw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", soon);
  reset();
}
