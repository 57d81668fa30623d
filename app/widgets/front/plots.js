/* What a person does on a plot, in the browser.

viser reports no clicks on HTML. So a plot's place under the pointer, in the plot's units, is written
into a text box beside it, hidden, that viser does report. What is under the pointer is told by the
drawing itself. Shift and a drag, or the wheel, zoom; a double click shows the whole again. */
if (!window.bohemiaPlots) {
  const numbers = (text) => text.split(" ").map(Number);
  const within = (w) => Math.min(Math.max(w, 0), 1);
  /* The hidden box stands behind the drawing and what lies over it. */
  const send = (plot, text) =>
    window.bohemiaTell(plot.parentElement.nextElementSibling.nextElementSibling, text);
  const look = (s, e) => {
    const b = numbers(s.dataset.box);
    const p = new DOMPoint(e.clientX, e.clientY).matrixTransform(s.getScreenCTM().inverse());
    const u = (p.x - b[0]) / b[2], v = 1 - (p.y - b[1]) / b[3];
    const at = (u, v) => (b[4] + u * (b[5] - b[4])) + " " + (b[6] + v * (b[7] - b[6]));
    return { b, u, v, at, inside: u >= 0 && u <= 1 && v >= 0 && v <= 1 };
  };
  const tell = (s, { b, u, v, inside }) => {
    const tip = s.querySelector(".tip"), d = s.dataset;
    if (!tip) return;
    if (!inside) { tip.textContent = d.idle; return; }
    const n = numbers(d.grid), f = d.span ? numbers(d.span) : b.slice(4);
    const share = (low, high, w, first, last) => (low + w * (high - low) - first) / (last - first);
    const cell = (w, count) => Math.min(Math.floor(within(w) * count), count - 1);
    const x = cell(share(b[4], b[5], u, f[0], f[1]), n[0]);
    const y = cell(share(b[6], b[7], v, f[2], f[3]), n[1]);
    s.told = s.told || d.tips.split("|");
    tip.textContent = d.columns.split("|")[x] + d.rows.split("|")[y] + (s.told[x * n[1] + y] || "");
  };
  const zoom = (s, x0, x1, y0, y1) => {
    s.shown = [x0, x1, y0, y1];
    send(s.closest(".plot"), "zoom " + s.shown.join(" "));
  };
  /* A band over the width that Shift and a drag choose. */
  const choose = (s, e, { b, u }) => {
    const band = s.querySelector(".band");
    if (e.type === "pointerdown") s.from = within(u);
    const [low, high] = [s.from, within(u)].sort((p, q) => p - q);
    band.setAttribute("x", b[0] + low * b[2]);
    band.setAttribute("width", (high - low) * b[2]);
    if (e.type !== "pointerup" && e.type !== "pointercancel") return;
    s.from = undefined;
    band.setAttribute("width", 0);
    if (e.type === "pointercancel" || high - low < 0.01) return;
    const x = (w) => b[4] + w * (b[5] - b[4]);
    const half = s.dataset.both ? 0.5 * (high - low) : 0.5, middle = 0.5;
    const y = (w) => b[6] + w * (b[7] - b[6]);
    zoom(s, x(low), x(high), y(middle - half), y(middle + half));
  };
  const point = (s, e, { u, v, at, inside }) => {
    if (e.type === "pointerdown") {
      if (!inside || e.button) return;
      s.held = true;
    }
    if (!s.held || (e.type === "pointermove" && e.timeStamp - s.sent < 60)) return;
    s.sent = e.timeStamp;
    send(s.closest(".plot"), at(within(u), within(v)));
    if (e.type === "pointerup" || e.type === "pointercancel") s.held = false;
  };
  /* A stroke is drawn here while the button is held, and sent whole at the end. */
  const draw = (s, e, { b, u, v, at, inside }) => {
    const most = Number(s.dataset.most), line = s.querySelector(".trace");
    const put = () => line.setAttribute(
      "points", s.trace.map((q) => b[0] + q[0] * b[2] + "," + (b[1] + (1 - q[1]) * b[3])).join(" "));
    if (e.type === "pointerdown") {
      if (!inside || e.button) return;
      s.held = true;
      s.trace = [];
    }
    if (!s.held) return;
    const last = s.trace[s.trace.length - 1], w = [within(u), within(v)];
    if (!last || Math.hypot((w[0] - last[0]) * b[2], (w[1] - last[1]) * b[3]) > 1.5) s.trace.push(w);
    put();
    if (e.type !== "pointerup" && e.type !== "pointercancel") return;
    s.held = false;
    const step = Math.ceil(s.trace.length / most), end = s.trace.length - 1;
    const kept = s.trace.filter((q, n) => n % step === 0 || n === end);
    if (end > 0) send(s.closest(".plot"), kept.map((q) => at(q[0], q[1])).join(" "));
    setTimeout(() => { if (!s.held) { s.trace = []; put(); } }, 1500);
  };
  const plotted = (e) => e.target.closest ? e.target.closest(".plot svg[data-box]") : null;
  const pointed = (e) => {
    const s = plotted(e);
    if (!s) return;
    const where = look(s, e);
    tell(s, where);
    if (e.type === "pointerdown" && where.inside) s.setPointerCapture(e.pointerId);
    if (s.from !== undefined || (e.type === "pointerdown" && e.shiftKey && where.inside)) {
      choose(s, e, where);
    } else {
      (s.dataset.act === "draw" ? draw : point)(s, e, where);
    }
  };
  for (const type of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) {
    document.addEventListener(type, pointed, true);
  }
  document.addEventListener("pointerout", (e) => {
    const s = plotted(e);
    if (s && !s.contains(e.relatedTarget)) tell(s, { inside: false });
  }, true);
  document.addEventListener("wheel", (e) => {
    const s = plotted(e);
    if (!s || !(s.dataset.wheel || e.shiftKey || e.ctrlKey)) return;
    const { u, v, b, inside } = look(s, e);
    if (!inside) return;
    e.preventDefault();
    e.stopPropagation();
    const by = Math.exp(Math.min(Math.max((e.deltaY || e.deltaX) * 0.0015, -0.7), 0.7));
    const [x0, x1, y0, y1] = s.shown || b.slice(4);
    const x = x0 + u * (x1 - x0), y = y0 + v * (y1 - y0), up = s.dataset.both ? by : 1;
    zoom(s, x + (x0 - x) * by, x + (x1 - x) * by, y + (y0 - y) * up, y + (y1 - y) * up);
  }, { capture: true, passive: false });
  document.addEventListener("dblclick", (e) => {
    const s = plotted(e);
    if (s) send(s.closest(".plot"), "whole");
  }, true);
  /* A picture of its own: what lies over the drawing is part of it, and its colours are light. */
  const standalone = (plot) => {
    const s = plot.querySelector("svg[data-box]"), made = s.cloneNode(true);
    const over = plot.parentElement.nextElementSibling.querySelector("svg");
    made.querySelectorAll(".tip,.band,.trace").forEach((part) => part.remove());
    for (const name of made.getAttributeNames()) {
      if (name.startsWith("data-")) made.removeAttribute(name);
    }
    if (over) made.append(...[...over.cloneNode(true).childNodes]);
    const [wide, high] = numbers(made.getAttribute("viewBox")).slice(2);
    const look = { width: wide, height: high, color: "#1F2933",
      "font-family": "system-ui, Segoe UI, Helvetica, Arial, sans-serif", "font-size": 11 };
    for (const name of Object.keys(look)) made.setAttribute(name, look[name]);
    const paper = made.querySelector("rect");
    paper.setAttribute("fill", "#FFFFFF");
    const text = new XMLSerializer().serializeToString(made);
    return text.replace(/var\(--[\w-]+,([^()]*)\)/g, "$1");
  };
  const copy = async (plot, button) => {
    const text = standalone(plot), word = button.textContent;
    try {
      await navigator.clipboard.writeText(text);
      button.textContent = "Copied";
    } catch {
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
      link.download = "plot.svg";
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10000);
      button.textContent = "Saved";
    }
    setTimeout(() => { button.textContent = word; }, 1500);
  };
  document.addEventListener("click", (e) => {
    const button = e.target.closest && e.target.closest(".plot [data-do]");
    if (!button) return;
    const plot = button.closest(".plot");
    if (button.dataset.do === "copy") copy(plot, button);
    else send(plot, button.dataset.do);
  }, true);
  /* How large a plot in a window over the scene can be: the server draws it so. Each browser tells
     it once, or two of them would not agree for ever. */
  const told = {};
  const fit = (plot) => {
    const frame = plot.closest("[data-floating-window]");
    if (!frame) return;
    seen.observe(frame);
    const wide = plot.clientWidth - 8, top = plot.getBoundingClientRect().top;
    const high = Math.floor(frame.getBoundingClientRect().bottom - top) - 4;
    const name = plot.dataset.fit, size = wide + " " + high;
    if (wide < 80 || high < 80 || (told[name] === size && plot.dataset.size)) return;
    told[name] = size;
    send(plot, "size " + size);
  };
  const all = () => {
    const panel = document.querySelector('[data-dock-region="right"]');
    const free = window.innerWidth - (panel ? panel.getBoundingClientRect().width : 0);
    document.documentElement.style.setProperty("--bo-free", free + "px");
    if (panel) seen.observe(panel);
    document.querySelectorAll(".plot[data-fit]").forEach(fit);
  };
  const seen = new ResizeObserver(all);
  window.addEventListener("resize", all);
  window.bohemiaPlots = { fit: (plot) => { all(); fit(plot); } };
  all();
}
